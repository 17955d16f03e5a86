//! shadow_march: copies the density grid to a texture, and marches from every cell to the lights with shadow, and to sky and
//! ground.
//!
//! Reads: optical depths across the cells.
//! Writes: texture of the density; optical depths towards the lights; openness to sky and ground.

use haze_core::formula::uniforms::ShadowMarchUniform;
use haze_core::glam::UVec3;

use crate::renderer::gpu::binding::{READ_BUFFER, SAMPLER, texture, uniform, written_texture};
use crate::renderer::gpu::frame_encoder::FrameEncoder;
use crate::renderer::gpu::pipeline::ComputePipelineDescription;
use crate::renderer::layouts::GroupSet;
use crate::renderer::layouts::SHADOW_FORMAT;
use crate::renderer::pipeline_variants::PipelineKey;

/// Cells of a workgroup along each axis: SIDE in `shaders/shadow_march.wgsl`.
const SIDE: u32 = 4;

/// Key of a pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum ShadowMarchKey {
    CopyDensity,
    MarchCells,
    /// To sky and ground, on CPUs.
    MarchSky,
}

impl ShadowMarchKey {
    pub const ALL: [Self; 3] = [Self::CopyDensity, Self::MarchCells, Self::MarchSky];
}

impl PipelineKey for ShadowMarchKey {
    const PASS: &'static str = "shadow_march";
    const GROUPS: GroupSet = GroupSet::None;
    type Description = ComputePipelineDescription;

    fn inputs() -> Vec<wgpu::BindingType> {
        vec![
            uniform(size_of::<ShadowMarchUniform>()),
            READ_BUFFER,
            written_texture(SHADOW_FORMAT, wgpu::TextureViewDimension::D3),
            texture(true, wgpu::TextureViewDimension::D3),
            SAMPLER,
        ]
    }

    fn describe(self) -> ComputePipelineDescription {
        let entry_point = match self {
            ShadowMarchKey::CopyDensity => "copy_density",
            ShadowMarchKey::MarchCells => "march_cells",
            ShadowMarchKey::MarchSky => "march_sky",
        };
        ComputePipelineDescription { entry_point, constants: Vec::new() }
    }
}

/// The pass for one frame.
#[derive(Debug)]
pub(crate) struct ShadowMarch {
    pub copy_density: wgpu::ComputePipeline,
    /// Group 0 of `copy_density`.
    pub copy_inputs: wgpu::BindGroup,
    pub march_cells: wgpu::ComputePipeline,
    /// Marches to sky and ground, if `march_cells` does not.
    pub march_sky: Option<wgpu::ComputePipeline>,
    /// Group 0 of the marches.
    pub march_inputs: wgpu::BindGroup,
    /// Number of cells along each axis.
    pub size: UVec3,
    /// Number of blocks that `march_cells` writes.
    pub blocks: u32,
}

impl ShadowMarch {
    pub fn record(&self, encoder: &mut FrameEncoder<'_>) {
        let pass = encoder.compute("shadow_march");
        let workgroups = |cells: u32| cells.div_ceil(SIDE);
        // With the empty cells around the grid.
        let [x, y, z] = (self.size + 2).to_array().map(workgroups);
        pass.set_pipeline(&self.copy_density);
        pass.set_bind_group(0, &self.copy_inputs, &[]);
        pass.dispatch_workgroups(x, y, z);
        let [x, y, z] = self.size.to_array().map(workgroups);
        pass.set_pipeline(&self.march_cells);
        pass.set_bind_group(0, &self.march_inputs, &[]);
        pass.dispatch_workgroups(x, y, z * self.blocks);
        if let Some(march_sky) = &self.march_sky {
            pass.set_pipeline(march_sky);
            pass.dispatch_workgroups(x, y, z);
        }
    }
}
