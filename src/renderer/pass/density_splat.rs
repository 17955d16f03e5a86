//! density_splat: adds the sprites of a system to the density grid of the frame.
//!
//! Reads: particles; the system's uniforms.
//! Writes: optical depths across the cells, in fixed-point steps.

use haze_core::formula::uniforms::SplatUniform;
use haze_core::glam::UVec2;

use super::groups::Groups;
use crate::renderer::gpu::binding::{READ_BUFFER, WRITTEN_BUFFER, uniform};
use crate::renderer::gpu::frame_encoder::FrameEncoder;
use crate::renderer::gpu::pipeline::ComputePipelineDescription;
use crate::renderer::layouts::GroupSet;
use crate::renderer::pipeline_variants::PipelineKey;

/// Key of the only pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct DensitySplatKey;

impl PipelineKey for DensitySplatKey {
    const PASS: &'static str = "density_splat";
    const GROUPS: GroupSet = GroupSet::Sprites;
    type Description = ComputePipelineDescription;

    fn inputs() -> Vec<wgpu::BindingType> {
        vec![uniform(size_of::<SplatUniform>()), READ_BUFFER, WRITTEN_BUFFER]
    }

    fn describe(self) -> ComputePipelineDescription {
        ComputePipelineDescription { entry_point: "add_sprite", constants: Vec::new() }
    }
}

/// The pass for one system.
#[derive(Debug)]
pub(crate) struct DensitySplat {
    pub pipeline: wgpu::ComputePipeline,
    pub groups: Groups,
    /// Group 3.
    pub inputs: wgpu::BindGroup,
    /// Workgroups, one per sprite.
    pub workgroups: UVec2,
}

impl DensitySplat {
    pub fn record(&self, encoder: &mut FrameEncoder<'_>) {
        let pass = encoder.compute("density_splat");
        pass.set_pipeline(&self.pipeline);
        self.groups.bind_to_compute(pass);
        pass.set_bind_group(3, &self.inputs, &[]);
        pass.dispatch_workgroups(self.workgroups.x, self.workgroups.y, 1);
    }
}
