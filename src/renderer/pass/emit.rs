//! emit: evaluates the particles of an emitter.
//!
//! Reads: the emitter at a time.
//! Writes: particles.

use haze_core::formula::uniforms::EmitterUniform;

use crate::renderer::gpu::binding::{WRITTEN_BUFFER, uniform};
use crate::renderer::gpu::pipeline::ComputePipelineDescription;
use crate::renderer::layouts::GroupSet;
use crate::renderer::pipeline_variants::PipelineKey;

/// Key of the only pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct EmitKey;

impl PipelineKey for EmitKey {
    const PASS: &'static str = "emit";
    const GROUPS: GroupSet = GroupSet::None;
    type Description = ComputePipelineDescription;

    fn inputs() -> Vec<wgpu::BindingType> {
        vec![uniform(size_of::<EmitterUniform>()), WRITTEN_BUFFER]
    }

    fn describe(self) -> ComputePipelineDescription {
        ComputePipelineDescription { entry_point: "emit", constants: Vec::new() }
    }
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
