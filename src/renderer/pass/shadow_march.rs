//! shadow_march: marches from every cell of the density grid to the lights with shadow.
//!
//! Reads: optical depths across the cells.
//! Writes: optical depths towards the lights.

use glam::UVec3;

use crate::renderer::gpu::pipeline::ComputePipelineDescription;
use crate::renderer::gpu::record::begin_compute;
use crate::renderer::gpu::timing::Timing;

/// Cells of a workgroup along each axis: SIDE in `shaders/shadow_march.wgsl`.
const SIDE: u32 = 4;

/// Returns the pipeline's parts.
pub(crate) fn describe((): ()) -> ComputePipelineDescription {
    ComputePipelineDescription { entry_point: "march_cells", constants: Vec::new() }
}

/// The pass for one frame.
#[derive(Debug)]
pub(crate) struct ShadowMarch {
    pub pipeline: wgpu::ComputePipeline,
    /// Group 0.
    pub inputs: wgpu::BindGroup,
    /// Number of cells along each axis.
    pub size: UVec3,
}

impl ShadowMarch {
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, timing: Option<&Timing>) {
        let mut pass = begin_compute(encoder, "shadow_march", timing);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.inputs, &[]);
        let workgroups = |cells: u32| cells.div_ceil(SIDE);
        pass.dispatch_workgroups(workgroups(self.size.x), workgroups(self.size.y), workgroups(self.size.z));
    }
}
