//! Detection of recorded commands that were not submitted yet.

use std::sync::Arc;

/// Tracks commands from their encoder to the queue.
///
/// An encoder maps a buffer on request once it is submitted. The buffer `probe` is already mapped, so wgpu answers the
/// request within the submission. The callback drops a reference to `recorded` when it is called, or when it is dropped
/// together with an encoder that is never submitted.
#[derive(Debug)]
pub(crate) struct SubmissionTracker {
    probe: wgpu::Buffer,
    /// Shared with every encoder that is not yet submitted.
    recorded: Arc<()>,
}

impl SubmissionTracker {
    pub fn new(device: &wgpu::Device) -> Self {
        let probe = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("haze submission"),
            size: wgpu::MAP_ALIGNMENT,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: true,
        });
        Self { probe, recorded: Arc::new(()) }
    }

    /// Returns true if a tracked encoder or pass was neither submitted nor dropped.
    pub fn is_outstanding(&self) -> bool {
        Arc::strong_count(&self.recorded) > 1
    }

    /// Tracks an encoder.
    pub fn track(&self, encoder: &wgpu::CommandEncoder) {
        let recorded = self.recorded.clone();
        encoder.map_buffer_on_submit(&self.probe, wgpu::MapMode::Read, .., move |_| drop(recorded));
    }

    /// Tracks the encoder of a pass.
    pub fn track_pass(&self, pass: &wgpu::RenderPass<'_>) {
        let recorded = self.recorded.clone();
        pass.map_buffer_on_submit(&self.probe, wgpu::MapMode::Read, .., move |_| drop(recorded));
    }
}
