//! depth_slopes: fits a line to the lit smoke over depth around each texel, for its upsampling under `guided`.
//!
//! Reads: lit smoke, reduced depth.
//! Writes: slopes, Rgba16Float; in compute also the cells with slopes.
//! Blend: none.
//! Source: He and Sun, "Fast guided filter", 2015.

use super::depth_downsample::REDUCED_DEPTH;
use super::light_target::{LIT, SMOKE_CELLS};
use super::texel_pass::TexelKey;
use crate::renderer::gpu::binding::LOADED;
use crate::renderer::gpu::pipeline::Constant;
use crate::renderer::targets::{SystemTextures, Target};

/// Change of the lit smoke with depth.
pub(crate) const DEPTH_SLOPES: Target = Target { label: "haze depth slopes", ..LIT };

/// Cells with such a change. mark_cells draws them.
pub(crate) const SLOPE_CELLS: Target = Target { label: "haze slope cells", ..SMOKE_CELLS };

/// Key of the only pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct DepthSlopesKey;

impl TexelKey for DepthSlopesKey {
    const PASS: &'static str = "depth_slopes";
    const READS: &'static [wgpu::BindingType] = &[LOADED, LOADED];
    const COMPUTED: &'static [Target] = &[DEPTH_SLOPES, SLOPE_CELLS];

    fn drawn(self) -> &'static [Target] {
        &[DEPTH_SLOPES]
    }

    fn reads(textures: SystemTextures<'_>) -> Vec<&wgpu::TextureView> {
        let target = textures.accumulation;
        vec![target.get_or_first(&LIT), target.get_or_first(&REDUCED_DEPTH)]
    }

    fn constants(self) -> Vec<Constant> {
        Vec::new()
    }
}
