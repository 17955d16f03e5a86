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

/// Key of a transfer_lit pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct TransferLitKey {
    pub drawn: BoundingBoxKey,
    /// True to draw the tiles that hold smoke: light_target has computed which.
    pub tiles: bool,
    /// True to draw the pixels that upsample_lit has computed.
    pub computed: bool,
    pub pixel: LitPixelKey,
}

/// Returns the pipeline's parts for a key.
pub(crate) fn describe(key: TransferLitKey) -> RenderPipelineDescription {
    let of_pass = [bool_constant("TILES", key.tiles), bool_constant("COMPUTED", key.computed)];
    let description = key.drawn.describe(key.pixel.constants(&of_pass));
    let primitive = if key.tiles { QUAD_STRIP } else { description.primitive };
    RenderPipelineDescription { primitive, ..description }
}
