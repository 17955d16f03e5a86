//! tile_refine: finds the sprites of a bin that may be visible in each of its tiles of a few texels.
//!
//! Reads: sprite lists of the bins, sprites, rectangles, reduced depth or the host's own.
//! Writes: one bit per sprite and tile.

use haze_core::formula::uniforms::TilesUniform;
use haze_core::glam::UVec2;

use super::groups::Groups;
use super::sprite_instances::SpriteKey;
use crate::renderer::gpu::binding::{LOADED, READ_BUFFER, WRITTEN_BUFFER, uniform};
use crate::renderer::gpu::pipeline::{ComputePipelineDescription, bool_constant};
use crate::renderer::layouts::GroupSet;
use crate::renderer::pipeline_variants::PipelineKey;

/// Texels of a tile: `PER_INVOCATION_TILE` in `shaders/lib/tiles.wgsl`.
pub(crate) const PER_INVOCATION_TILE: UVec2 = UVec2::new(8, 4);

/// Key of a pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct TileRefineKey {
    pub sprite: SpriteKey,
    /// True if sprites are compared with the host's own depth instead of the reduced depth.
    pub host_depth: bool,
    /// True if the traversal stops where a texel is opaque.
    pub stops: bool,
}

impl PipelineKey for TileRefineKey {
    const PASS: &'static str = "tile_refine";
    const GROUPS: GroupSet = GroupSet::Sprites;
    type Description = ComputePipelineDescription;

    fn inputs() -> Vec<wgpu::BindingType> {
        vec![uniform(size_of::<TilesUniform>()), READ_BUFFER, READ_BUFFER, READ_BUFFER, LOADED, WRITTEN_BUFFER]
    }

    fn describe(self) -> ComputePipelineDescription {
        let constants =
            self.sprite.constants([bool_constant("HOST_DEPTH", self.host_depth), bool_constant("STOPS", self.stops)]);
        ComputePipelineDescription { entry_point: "refine", constants }
    }
}

/// The pass for one system.
#[derive(Debug)]
pub(crate) struct TileRefine {
    pub pipeline: wgpu::ComputePipeline,
    /// Group 3.
    pub inputs: wgpu::BindGroup,
    pub bins: u32,
}

impl TileRefine {
    pub fn record(&self, pass: &mut wgpu::ComputePass<'_>, groups: &Groups) {
        groups.bind_to_compute(pass);
        pass.set_bind_group(3, &self.inputs, &[]);
        pass.set_pipeline(&self.pipeline);
        pass.dispatch_workgroups(self.bins, 1, 1);
    }
}
