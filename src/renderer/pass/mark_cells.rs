//! mark_cells: marks the cells of lit smoke by which transfer_lit draws, where light_target and depth_slopes do not compute
//! them. `TexelPass` records it.
//!
//! Reads: lit smoke and its depth slopes.
//! Writes: cells with smoke, cells with slopes, R8Unorm.
//! Blend: none.
//! Source: own.

use crate::renderer::gpu::pipeline::{RenderPipelineDescription, bool_constant, color_target};
use crate::renderer::targets::DRAWN_CELLS_FORMAT;

/// Key of a mark_cells pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct MarkCellsKey {
    /// True if there are slopes.
    pub slopes: bool,
}

/// Returns the pipeline's parts for a key.
pub(crate) fn describe(key: MarkCellsKey) -> RenderPipelineDescription {
    RenderPipelineDescription {
        buffers: &[],
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        sample_count: 1,
        targets: vec![color_target(DRAWN_CELLS_FORMAT, None); 2],
        constants: vec![bool_constant("SLOPES", key.slopes)],
    }
}
