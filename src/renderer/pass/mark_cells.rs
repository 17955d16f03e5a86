//! mark_cells: marks the cells of lit smoke by which transfer_lit draws, where light_target and depth_slopes do not compute
//! them.
//!
//! Reads: lit smoke and its depth slopes.
//! Writes: cells with smoke, cells with slopes, R8Unorm.
//! Blend: none.
//! Source: own.

use super::depth_slopes::{DEPTH_SLOPES, SLOPE_CELLS};
use super::light_target::{LIT, SMOKE_CELLS};
use super::texel_pass::TexelKey;
use crate::renderer::gpu::binding::LOADED;
use crate::renderer::gpu::pipeline::{Constant, bool_constant};
use crate::renderer::targets::{SystemTextures, Target};

/// Key of a mark_cells pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct MarkCellsKey {
    /// True if there are slopes.
    pub slopes: bool,
}

impl TexelKey for MarkCellsKey {
    const PASS: &'static str = "mark_cells";
    const READS: &'static [wgpu::BindingType] = &[LOADED, LOADED];
    const COMPUTED: &'static [Target] = &[];

    fn drawn(self) -> &'static [Target] {
        &[SMOKE_CELLS, SLOPE_CELLS]
    }

    fn reads(textures: SystemTextures<'_>) -> Vec<&wgpu::TextureView> {
        let target = textures.accumulation;
        vec![target.get_or_first(&LIT), target.get_or_first(&DEPTH_SLOPES)]
    }

    fn constants(self) -> Vec<Constant> {
        vec![bool_constant("SLOPES", self.slopes)]
    }
}
