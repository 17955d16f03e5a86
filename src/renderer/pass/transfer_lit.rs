//! transfer_lit: draws the output of light_target over the system's bounding box, or over the tiles that hold smoke, then
//! with the glow of lights behind it. `Transfer` records it.
//!
//! Reads: lit smoke and its depth slopes, reduced depth, scene depth, coverage ramp; cells with smoke and with slopes, glows,
//! specular ramp.
//! Writes: the host's color target.
//! Blend: ONE, ONE_MINUS_SRC_ALPHA.
//! Source: OTEE "Transfer & lighting".

use super::transfer::BoundingBoxKey;
use crate::renderer::gpu::pipeline::{QUAD_STRIP, RenderPipelineDescription, bool_constant, enum_constant};
use crate::settings::{CoverageMode, RampFilter, Upsample};

/// Key of a transfer_lit pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct TransferLitKey {
    pub drawn: BoundingBoxKey,
    /// True to draw the tiles that hold smoke: light_target has computed which.
    pub tiles: bool,
    /// True to add the glow of lights, which light_target has computed.
    pub glows: bool,
    /// True to filter tiles without slopes by the hardware: depth_slopes has computed which.
    pub slope_cells: bool,
    pub upsample: Upsample,
    pub coverage: CoverageMode,
    pub ramp_filter: RampFilter,
    pub exact_filtering: bool,
}

/// Returns the pipeline's parts for a key.
pub(crate) fn describe(key: TransferLitKey) -> RenderPipelineDescription {
    let description = key.drawn.describe(vec![
        bool_constant("TILES", key.tiles),
        bool_constant("GLOWS", key.glows),
        bool_constant("SLOPE_CELLS", key.slope_cells),
        enum_constant!("UPSAMPLE", key.upsample),
        enum_constant!("COVERAGE_MODE", key.coverage),
        enum_constant!("RAMP_FILTER", key.ramp_filter),
        bool_constant("EXACT_FILTERING", key.exact_filtering),
    ]);
    let primitive = if key.tiles { QUAD_STRIP } else { description.primitive };
    RenderPipelineDescription { primitive, ..description }
}
