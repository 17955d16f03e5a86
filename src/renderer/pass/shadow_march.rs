//! shadow_march: marches from every cell of the density grid to the lights with shadow, and to sky and ground.
//!
//! Reads: optical depths across the cells.
//! Writes: optical depths towards the lights; openness to sky and ground.

use glam::UVec3;

use crate::renderer::gpu::pipeline::ComputePipelineDescription;
use crate::renderer::gpu::record::begin_compute;
use crate::renderer::gpu::timing::Timing;

/// Cells of a workgroup along each axis: SIDE in `shaders/shadow_march.wgsl`.
const SIDE: u32 = 4;

/// Ends of the marches: the key of a pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum MarchTo {
    Lights,
    Sky,
}

/// Returns the pipeline's parts for a key.
pub(crate) fn describe(key: MarchTo) -> ComputePipelineDescription {
    let entry_point = match key {
        MarchTo::Lights => "march_cells",
        MarchTo::Sky => "march_sky",
    };
    ComputePipelineDescription { entry_point, constants: Vec::new() }
}

/// The pass for one frame.
#[derive(Debug)]
pub(crate) struct ShadowMarch {
    pub to_lights: wgpu::ComputePipeline,
    /// `None` if no system has ambient light that smoke shades.
    pub to_sky: Option<wgpu::ComputePipeline>,
    /// Group 0.
    pub inputs: wgpu::BindGroup,
    /// Number of cells along each axis.
    pub size: UVec3,
    /// Number of blocks of lights.
    pub light_blocks: u32,
}

impl ShadowMarch {
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, timing: Option<&Timing>) {
        let mut pass = begin_compute(encoder, "shadow_march", timing);
        pass.set_bind_group(0, &self.inputs, &[]);
        let workgroups = |cells: u32| cells.div_ceil(SIDE);
        let marches = [(Some(&self.to_lights), self.light_blocks), (self.to_sky.as_ref(), 1)];
        for (pipeline, blocks) in marches.into_iter().filter_map(|(pipeline, blocks)| Some((pipeline?, blocks))) {
            pass.set_pipeline(pipeline);
            let along_z = workgroups(self.size.z) * blocks;
            pass.dispatch_workgroups(workgroups(self.size.x), workgroups(self.size.y), along_z);
        }
    }
}
