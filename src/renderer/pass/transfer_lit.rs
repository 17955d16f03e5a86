//! transfer_lit: draws the output of light_target, or of upsample_lit, over the system's bounding box, or over the tiles that hold smoke, then
//! with the glow of lights behind it. `Transfer` records it.
//!
//! Reads: lit smoke and its depth slopes, reduced depth, scene depth, coverage ramp; cells with smoke and with slopes, glows,
//! specular ramp.
//! Writes: the host's color target.
//! Blend: ONE, ONE_MINUS_SRC_ALPHA.
//! Source: OTEE "Transfer & lighting".

use super::depth_slopes::DEPTH_SLOPES;
use super::light_target::LIT;
use super::transfer::BoundingBoxKey;
use super::upsample_lit::{LIT_TYPES, LitPixelKey, PIXELS, lit_textures};
use crate::renderer::gpu::pipeline::{QUAD_STRIP, RenderPipelineDescription, bool_constant};
use crate::renderer::layouts::GroupSet;
use crate::renderer::pipeline_variants::{PipelineKey, PipelineVariants};
use crate::renderer::targets::{InputGroups, SystemTextures};

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

impl PipelineKey for TransferLitKey {
    const PASS: &'static str = "transfer_lit";
    const GROUPS: GroupSet = GroupSet::Lighting;
    type Description = RenderPipelineDescription;

    fn inputs() -> Vec<wgpu::BindingType> {
        LIT_TYPES.to_vec()
    }

    fn describe(self) -> RenderPipelineDescription {
        let of_pass = [("TILES", f64::from(self.tiles as u32)), bool_constant("COMPUTED", self.computed)];
        let description = self.drawn.describe(self.pixel.constants(&of_pass));
        RenderPipelineDescription { primitive: QUAD_STRIP, ..description }
    }
}

/// Returns group 3: pixels take the place of the lit smoke if they are computed.
pub(crate) fn inputs(
    pipelines: &PipelineVariants<TransferLitKey>,
    textures: SystemTextures<'_>,
    groups: &mut InputGroups,
) -> wgpu::BindGroup {
    let target = textures.accumulation;
    let [lit, slopes] = match target.get(&PIXELS) {
        Some(pixels) => [pixels, pixels],
        None => [LIT, DEPTH_SLOPES].map(|read| target.get_or_first(&read)),
    };
    groups.get("transfer_lit", || pipelines.bind_textures(lit_textures(target, lit, slopes)))
}
