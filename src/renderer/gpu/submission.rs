//! Whether what was recorded has been submitted.

use std::sync::Arc;

/// Follows commands from their encoder to the queue.
///
/// wgpu maps a buffer for whoever asked an encoder for it, once that encoder is submitted. This one is mapped from the start, so
/// that the request is answered within the submission: the answer, or the encoder that is dropped with it, lets go of a share of
/// `recorded`.
#[derive(Debug)]
pub(crate) struct Submission {
    probe: wgpu::Buffer,
    /// Shared with every encoder that is still to be submitted.
    recorded: Arc<()>,
}

impl Submission {
    pub fn new(device: &wgpu::Device) -> Self {
        let probe = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("haze submission"),
            size: wgpu::MAP_ALIGNMENT,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: true,
        });
        Self { probe, recorded: Arc::new(()) }
    }

    /// True if an encoder or pass that is followed was neither submitted nor dropped.
    pub fn is_outstanding(&self) -> bool {
        Arc::strong_count(&self.recorded) > 1
    }

    /// Follows an encoder.
    pub fn follow(&self, encoder: &wgpu::CommandEncoder) {
        let recorded = self.recorded.clone();
        encoder.map_buffer_on_submit(&self.probe, wgpu::MapMode::Read, .., move |_| drop(recorded));
    }

    /// Follows the encoder of a pass.
    pub fn follow_pass(&self, pass: &wgpu::RenderPass<'_>) {
        let recorded = self.recorded.clone();
        pass.map_buffer_on_submit(&self.probe, wgpu::MapMode::Read, .., move |_| drop(recorded));
    }
}
