//! transfer_lit: draws the output of light_target over the system's bounding box. `Transfer` records it.
//!
//! Reads: lit smoke and its depth slopes, reduced depth, scene depth, coverage ramp.
//! Writes: the host's color target.
//! Blend: ONE, ONE_MINUS_SRC_ALPHA.
//! Source: OTEE "Transfer & lighting".

use super::transfer::BoundingBoxKey;
use crate::renderer::gpu::pipeline::{RenderPipelineDescription, bool_constant, enum_constant};
use crate::settings::{CoverageMode, RampFilter, Upsample};

/// Key of a transfer_lit pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct TransferLitKey {
    pub drawn: BoundingBoxKey,
    pub upsample: Upsample,
    pub coverage: CoverageMode,
    pub ramp_filter: RampFilter,
    pub exact_filtering: bool,
}

/// Returns the pipeline's parts for a key.
pub(crate) fn describe(key: TransferLitKey) -> RenderPipelineDescription {
    key.drawn.describe(vec![
        enum_constant!("UPSAMPLE", key.upsample),
        enum_constant!("COVERAGE_MODE", key.coverage),
        enum_constant!("RAMP_FILTER", key.ramp_filter),
        bool_constant("EXACT_FILTERING", key.exact_filtering),
    ])
}
