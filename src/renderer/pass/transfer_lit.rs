//! transfer_lit: draws the output of light_target, or of upsample_lit, over the system's bounding box, or over the tiles that hold smoke, then
//! with the glow of lights behind it. `Transfer` records it.
//!
//! Reads: lit smoke and its depth slopes, reduced depth, scene depth, coverage ramp; cells with smoke and with slopes, glows,
//! specular ramp.
//! Writes: the host's color target.
//! Blend: ONE, ONE_MINUS_SRC_ALPHA.
//! Source: OTEE "Transfer & lighting".

use super::transfer::BoundingBoxKey;
use super::upsample_lit::LitPixelKey;
use crate::renderer::gpu::pipeline::{QUAD_STRIP, RenderPipelineDescription, bool_constant};

/// Tiles that a pipeline draws: `TILES` in `shaders/transfer_lit.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Tiles {
    All = 0,
    /// Those without slopes over depth.
    Flat = 1,
    Sloped = 2,
}

impl Tiles {
    /// Returns the tiles of a frame's pipelines. `slopes`: true if cells with slopes are marked, so that the other tiles need
    /// no filter by depth.
    pub fn of_frame(slopes: bool) -> [Option<Self>; 2] {
        if slopes { [Some(Self::Flat), Some(Self::Sloped)] } else { [Some(Self::All), None] }
    }
}

/// Key of a transfer_lit pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct TransferLitKey {
    pub drawn: BoundingBoxKey,
    pub tiles: Tiles,
    /// True to draw the pixels that upsample_lit has computed.
    pub computed: bool,
    pub pixel: LitPixelKey,
}

/// Returns the pipeline's parts for a key.
pub(crate) fn describe(key: TransferLitKey) -> RenderPipelineDescription {
    let of_pass = [("TILES", f64::from(key.tiles as u32)), bool_constant("COMPUTED", key.computed)];
    let description = key.drawn.describe(key.pixel.constants(&of_pass));
    RenderPipelineDescription { primitive: QUAD_STRIP, ..description }
}
