//! upsample_lit: computes the pixels that transfer_lit draws, where a GPU draws slowly. `TexelPass` records it.
//!
//! Reads: lit smoke and its depth slopes, reduced depth, scene depth, coverage ramp; cells with smoke and with slopes, glows,
//! specular ramp.
//! Writes: smoke at full resolution, Rgba16Float.
//! Blend: none.
//! Source: OTEE "Transfer & lighting".

use crate::renderer::gpu::pipeline::{ComputePipelineDescription, Constant, bool_constant, enum_constant};
use crate::settings::{CoverageMode, RampFilter, Upsample};

/// Options of `shaders/lib/lit_pixel.wgsl` that select a pipeline, here and in transfer_lit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct LitPixelKey {
    /// True to add the glow of lights, which light_target has computed.
    pub glows: bool,
    pub upsample: Upsample,
    pub coverage: CoverageMode,
    pub ramp_filter: RampFilter,
    pub exact_filtering: bool,
}

impl LitPixelKey {
    /// Returns the override constants of `shaders/lib/lit_pixel.wgsl`, followed by the pass's own.
    pub fn constants(self, of_pass: &[Constant]) -> Vec<Constant> {
        let shared = [
            bool_constant("GLOWS", self.glows),
            enum_constant!("UPSAMPLE", self.upsample),
            enum_constant!("COVERAGE_MODE", self.coverage),
            enum_constant!("RAMP_FILTER", self.ramp_filter),
            bool_constant("EXACT_FILTERING", self.exact_filtering),
        ];
        shared.iter().chain(of_pass).copied().collect()
    }
}

/// Key of an upsample_lit pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct UpsampleLitKey {
    /// True to filter places without slopes by the hardware: depth_slopes has computed which.
    pub slope_cells: bool,
    pub pixel: LitPixelKey,
}

/// Returns the pipeline's parts for a key.
pub(crate) fn describe(key: UpsampleLitKey) -> ComputePipelineDescription {
    let constants = key.pixel.constants(&[bool_constant("SLOPE_CELLS", key.slope_cells)]);
    ComputePipelineDescription { entry_point: "pixels", constants }
}
