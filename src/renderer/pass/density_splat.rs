//! density_splat: adds the sprites of a system to the density grid of the frame.
//!
//! Reads: particles; the system's uniforms.
//! Writes: optical depths across the cells, in fixed-point steps.

use glam::UVec2;

use super::Groups;
use crate::renderer::gpu::pipeline::ComputePipelineDescription;
use crate::renderer::gpu::record::begin_compute;
use crate::renderer::gpu::timing::Timing;

/// Returns the pipeline's parts.
pub(crate) fn describe((): ()) -> ComputePipelineDescription {
    ComputePipelineDescription { entry_point: "add_sprite", constants: Vec::new() }
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
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, timing: Option<&Timing>) {
        let mut pass = begin_compute(encoder, "density_splat", timing);
        pass.set_pipeline(&self.pipeline);
        self.groups.bind_to_compute(&mut pass);
        pass.set_bind_group(3, &self.inputs, &[]);
        pass.dispatch_workgroups(self.workgroups.x, self.workgroups.y, 1);
    }
}
