//! emit: evaluates the particles of an emitter.
//!
//! Reads: the emitter at a time.
//! Writes: particles.

use crate::renderer::gpu::pipeline::ComputePipelineDescription;

/// Returns the parts of the only pipeline.
pub(crate) fn describe((): ()) -> ComputePipelineDescription {
    ComputePipelineDescription { entry_point: "emit", constants: Vec::new() }
}

/// The pass for one system.
#[derive(Debug)]
pub(crate) struct Emit {
    pub pipeline: wgpu::ComputePipeline,
    pub inputs: wgpu::BindGroup,
    pub births: u32,
}

impl Emit {
    pub fn record(&self, pass: &mut wgpu::ComputePass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.inputs, &[]);
        pass.dispatch_workgroups(self.births.div_ceil(64), 1, 1);
    }
}
