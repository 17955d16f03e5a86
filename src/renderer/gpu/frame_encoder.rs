//! Encoder of a frame's passes.

use super::record::begin_pass;
use super::timing::Timing;

/// Label of a compute pass that is recorded in one with others, and of their measured interval.
const SHARED_PASS: &str = "compute";

/// Records a frame's passes. Compute passes that follow each other are recorded as one, unless each is measured: a
/// GPU is idle for some microseconds between two passes, longer than some passes take.
#[derive(Debug)]
pub(crate) struct FrameEncoder<'a> {
    encoder: &'a mut wgpu::CommandEncoder,
    timing: Option<Timing>,
    /// True if compute passes share one.
    shares_pass: bool,
    /// Open compute pass. While it shares the pass, a debug group is open in it.
    compute: Option<wgpu::ComputePass<'static>>,
}

impl<'a> FrameEncoder<'a> {
    pub fn new(encoder: &'a mut wgpu::CommandEncoder, timing: Option<Timing>) -> Self {
        let shares_pass = timing.as_ref().is_none_or(|timing| !timing.is_by_pass());
        Self { encoder, timing, shares_pass, compute: None }
    }

    /// Begins a compute pass. It may have bind groups and a pipeline of the pass before.
    pub fn compute(&mut self, name: &'static str) -> &mut wgpu::ComputePass<'static> {
        if !self.shares_pass {
            self.compute = None;
        }
        if let Some(pass) = &mut self.compute {
            pass.pop_debug_group();
        }
        let Self { encoder, timing, .. } = self;
        let label = if self.shares_pass { SHARED_PASS } else { name };
        let pass = self.compute.get_or_insert_with(|| {
            let timestamp_writes = timing.as_ref().and_then(|timing| timing.compute_pass(label));
            // Its lifetime is checked here: everything else that uses the encoder ends the pass before.
            encoder
                .begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some(label), timestamp_writes })
                .forget_lifetime()
        });
        if self.shares_pass {
            pass.push_debug_group(name);
        }
        pass
    }

    /// Begins a render pass.
    pub fn render(
        &mut self,
        name: &'static str,
        color_attachments: &[Option<wgpu::RenderPassColorAttachment<'_>>],
        depth_stencil_attachment: Option<wgpu::RenderPassDepthStencilAttachment<'_>>,
    ) -> wgpu::RenderPass<'_> {
        self.end_compute();
        begin_pass(self.encoder, name, color_attachments, depth_stencil_attachment, self.timing.as_ref())
    }

    /// Returns the encoder, for copies and for passes that are not measured. Ends the compute pass.
    pub fn commands(&mut self) -> &mut wgpu::CommandEncoder {
        self.end_compute();
        self.encoder
    }

    fn end_compute(&mut self) {
        if let Some(mut pass) = self.compute.take().filter(|_| self.shares_pass) {
            pass.pop_debug_group();
        }
    }
}

impl Drop for FrameEncoder<'_> {
    fn drop(&mut self) {
        self.end_compute();
    }
}
