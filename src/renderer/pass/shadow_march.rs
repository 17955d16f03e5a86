//! shadow_march: copies the density grid to a texture, and marches from every cell to the lights with shadow, and to sky and
//! ground.
//!
//! Reads: optical depths across the cells.
//! Writes: texture of the density; optical depths towards the lights; openness to sky and ground.

use glam::UVec3;

use crate::renderer::gpu::pipeline::ComputePipelineDescription;
use crate::renderer::gpu::record::begin_compute;
use crate::renderer::gpu::timing::Timing;

/// Cells of a workgroup along each axis: SIDE in `shaders/shadow_march.wgsl`.
const SIDE: u32 = 4;

/// Ends of the marches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum MarchTo {
    Lights,
    Sky,
}

/// Key of a pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum ShadowMarchKey {
    CopyDensity,
    MarchTo(MarchTo),
}

impl ShadowMarchKey {
    pub const ALL: [Self; 3] = [Self::CopyDensity, Self::MarchTo(MarchTo::Lights), Self::MarchTo(MarchTo::Sky)];
}

/// Returns the pipeline's parts for a key.
pub(crate) fn describe(key: ShadowMarchKey) -> ComputePipelineDescription {
    let entry_point = match key {
        ShadowMarchKey::CopyDensity => "copy_density",
        ShadowMarchKey::MarchTo(MarchTo::Lights) => "march_cells",
        ShadowMarchKey::MarchTo(MarchTo::Sky) => "march_sky",
    };
    ComputePipelineDescription { entry_point, constants: Vec::new() }
}

/// The pass for one frame.
#[derive(Debug)]
pub(crate) struct ShadowMarch {
    pub copy_density: wgpu::ComputePipeline,
    /// Group 0 of `copy_density`.
    pub copy_inputs: wgpu::BindGroup,
    pub to_lights: wgpu::ComputePipeline,
    /// `None` if no system has ambient light that smoke shades.
    pub to_sky: Option<wgpu::ComputePipeline>,
    /// Group 0 of the marches.
    pub inputs: wgpu::BindGroup,
    /// Number of cells along each axis.
    pub size: UVec3,
    /// Number of blocks of lights.
    pub light_blocks: u32,
}

impl ShadowMarch {
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, timing: Option<&Timing>) {
        let mut pass = begin_compute(encoder, "shadow_march", timing);
        let workgroups = |cells: u32| cells.div_ceil(SIDE);
        // With the empty cells around the grid.
        let [x, y, z] = (self.size + 2).to_array().map(workgroups);
        pass.set_pipeline(&self.copy_density);
        pass.set_bind_group(0, &self.copy_inputs, &[]);
        pass.dispatch_workgroups(x, y, z);
        pass.set_bind_group(0, &self.inputs, &[]);
        let marches = [(Some(&self.to_lights), self.light_blocks), (self.to_sky.as_ref(), 1)];
        for (pipeline, blocks) in marches.into_iter().filter_map(|(pipeline, blocks)| Some((pipeline?, blocks))) {
            pass.set_pipeline(pipeline);
            let along_z = workgroups(self.size.z) * blocks;
            pass.dispatch_workgroups(workgroups(self.size.x), workgroups(self.size.y), along_z);
        }
    }
}
