//! upsample_lit: computes the pixels that transfer_lit draws, where a GPU draws slowly.
//!
//! Reads: lit smoke and its depth slopes, reduced depth, scene depth, coverage ramp; cells with smoke and with slopes, glows,
//! specular ramp.
//! Writes: smoke at full resolution, Rgba16Float.
//! Blend: none.
//! Source: OTEE "Transfer & lighting".

use haze_core::settings::{CoverageMode, RampFilter, Upsample};

use super::depth_downsample::REDUCED_DEPTH;
use super::depth_slopes::{DEPTH_SLOPES, SLOPE_CELLS};
use super::light_target::{GLOWS, LIT, SMOKE_CELLS};
use super::texel_pass::TexelKey;
use crate::renderer::gpu::binding::{FILTERED, LOADED};
use crate::renderer::gpu::pipeline::{Constant, bool_constant, enum_constant};
use crate::renderer::targets::{AccumulationTarget, Extent, SystemTextures, Target};

/// Lit smoke at full resolution.
pub(crate) const PIXELS: Target = Target { label: "haze lit pixels", extent: Extent::Pixels, ..LIT };

/// Types of the textures of `lib/lit_target.wgsl` and `lib/lit_pixel.wgsl`, here, in transfer_lit and in specular_scatter.
pub(crate) const LIT_TYPES: [wgpu::BindingType; 6] = [FILTERED, LOADED, FILTERED, LOADED, LOADED, LOADED];

/// Returns the textures of `LIT_TYPES`. `lit`: lit smoke or computed pixels, `slopes`: change of the lit smoke with depth.
pub(crate) fn lit_textures<'a>(
    target: &'a AccumulationTarget,
    lit: &'a wgpu::TextureView,
    slopes: &'a wgpu::TextureView,
) -> Vec<&'a wgpu::TextureView> {
    let [depth, cells, glows, slope_cells] =
        [REDUCED_DEPTH, SMOKE_CELLS, GLOWS, SLOPE_CELLS].map(|read| target.get_or_first(&read));
    vec![lit, depth, slopes, cells, glows, slope_cells]
}

/// Options of `shaders/lib/lit_pixel.wgsl` that select a pipeline, here and in transfer_lit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct LitPixelKey {
    /// True to add the glow of lights, which light_target has computed.
    pub glows: bool,
    /// True if a texel covers several pixels, and the glow is added.
    pub coarse: bool,
    pub upsample: Upsample,
    pub coverage: CoverageMode,
    pub is_additive: bool,
    pub ramp_filter: RampFilter,
    pub exact_filtering: bool,
}

impl LitPixelKey {
    /// Returns the override constants of `shaders/lib/lit_pixel.wgsl`, followed by the pass's own.
    pub fn constants(self, of_pass: &[Constant]) -> Vec<Constant> {
        let shared = [
            bool_constant("GLOWS", self.glows),
            bool_constant("COARSE", self.coarse),
            enum_constant!("UPSAMPLE", self.upsample),
            enum_constant!("COVERAGE_MODE", self.coverage),
            bool_constant("ADDITIVE", self.is_additive),
            enum_constant!("RAMP_FILTER", self.ramp_filter),
            bool_constant("EXACT_FILTERING", self.exact_filtering),
        ];
        shared.iter().chain(of_pass).copied().collect()
    }
}

/// Key of an upsample_lit pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct UpsampleLitKey {
    /// True to filter positions without slopes by the hardware: depth_slopes has computed which.
    pub slope_cells: bool,
    pub pixel: LitPixelKey,
}

impl TexelKey for UpsampleLitKey {
    const PASS: &'static str = "upsample_lit";
    const READS: &'static [wgpu::BindingType] = &LIT_TYPES;
    const COMPUTED: &'static [Target] = &[PIXELS];
    const ENTRY_POINT: &'static str = "pixels";
    const IS_DRAWN: bool = false;

    fn drawn(self) -> &'static [Target] {
        &[]
    }

    fn reads(textures: SystemTextures<'_>) -> Vec<&wgpu::TextureView> {
        let target = textures.accumulation;
        lit_textures(target, target.get_or_first(&LIT), target.get_or_first(&DEPTH_SLOPES))
    }

    fn constants(self) -> Vec<Constant> {
        self.pixel.constants(&[bool_constant("SLOPE_CELLS", self.slope_cells)])
    }
}
