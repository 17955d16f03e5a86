//! light_target: lights the accumulated smoke once per texel, if `lighting_resolution` selects it; transfer_lit
//! then upsamples the light.
//!
//! Reads: accumulation target, lights, ramps.
//! Writes: lit smoke, Rgba16Float; in compute also the cells with smoke, and the glow of lights.
//! Blend: none.
//! Source: OTEE "Transfer & lighting", at the target's resolution.

use haze_core::settings::{Backlight, DiffuseMode, NormalDecode, NormalEncoding, RampFilter, SoftScatterMode};
use haze_core::view_setup::{AttachmentRole, AttachmentSet, MAX_TARGET_ATTACHMENTS};

use super::depth_downsample::REDUCED_DEPTH;
use super::texel_pass::TexelKey;
use crate::renderer::gpu::binding::{LOADED, texture};
use crate::renderer::gpu::pipeline::{Constant, bool_constant, enum_constant};
use crate::renderer::targets::{Extent, SystemTextures, Target, attachment_constants};

/// Light times amount in rgb, amount in a. Light is HDR, whatever the format of the normals.
pub(crate) const LIT: Target = Target {
    label: "haze lit smoke",
    extent: Extent::Texels,
    drawn: wgpu::TextureFormat::Rgba16Float,
    computed: wgpu::TextureFormat::Rgba16Float,
};

/// Cells of the lit smoke that hold some. mark_cells draws them.
pub(crate) const SMOKE_CELLS: Target = Target {
    label: "haze smoke cells",
    extent: Extent::Cells,
    drawn: wgpu::TextureFormat::R8Unorm,
    computed: wgpu::TextureFormat::R32Float,
};

/// Glow of lights, if it is computed.
pub(crate) const GLOWS: Target = Target {
    label: "haze glows",
    extent: Extent::Lights,
    drawn: wgpu::TextureFormat::Rgba32Float,
    computed: wgpu::TextureFormat::Rgba32Float,
};

/// Number of textures that the pass reads: first attachment, reduced depth, baked light, further attachments.
const TEXTURES: usize = 3 + (MAX_TARGET_ATTACHMENTS - 1);

/// Lighting options that select a pipeline, here and in transfer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct LightingKey {
    pub encoding: NormalEncoding,
    pub decode: NormalDecode,
    pub attachments: AttachmentSet,
    pub shadow_blocks: u32,
    pub diffuse_mode: DiffuseMode,
    pub soft_scatter_mode: SoftScatterMode,
    pub backlight: Backlight,
    pub ambient: bool,
    pub ramp_filter: RampFilter,
    pub exact_filtering: bool,
}

impl LightingKey {
    /// Returns the override constants of `shaders/lib/lit_smoke.wgsl`, followed by the pass's own.
    pub fn constants_with<const N: usize>(&self, of_pass: [Constant; N]) -> Vec<Constant> {
        let shared = [
            enum_constant!("DIFFUSE_MODE", self.diffuse_mode),
            enum_constant!("SOFT_SCATTER_MODE", self.soft_scatter_mode),
            enum_constant!("NORMAL_ENCODING", self.encoding),
            enum_constant!("NORMAL_DECODE", self.decode),
            enum_constant!("BACKLIGHT", self.backlight),
            bool_constant("AMBIENT", self.ambient),
            enum_constant!("RAMP_FILTER", self.ramp_filter),
            bool_constant("EXACT_FILTERING", self.exact_filtering),
            bool_constant("SHADOW", self.attachments.contains(AttachmentRole::OpticalDepths)),
            ("SHADOW_BLOCKS", f64::from(self.shadow_blocks)),
        ];
        shared.into_iter().chain(attachment_constants(self.attachments)).chain(of_pass).collect()
    }
}

/// Types of the textures that the pass reads, as does transfer.
pub(crate) const READS: [wgpu::BindingType; TEXTURES] = {
    let mut types = [LOADED; TEXTURES];
    types[2] = texture(true, wgpu::TextureViewDimension::D2Array);
    types
};

impl TexelKey for LightingKey {
    const PASS: &'static str = "light_target";
    const READS: &'static [wgpu::BindingType] = &READS;
    const COMPUTED: &'static [Target] = &[LIT, SMOKE_CELLS, GLOWS];

    fn drawn(self) -> &'static [Target] {
        &[LIT]
    }

    fn reads(textures: SystemTextures<'_>) -> Vec<&wgpu::TextureView> {
        accumulated(textures, &textures.accumulation.attachments[0])
    }

    fn constants(self) -> Vec<Constant> {
        self.constants_with([])
    }
}

/// Returns the textures of `READS`, with `first` instead of the first attachment.
pub(crate) fn accumulated<'a>(
    textures: SystemTextures<'a>,
    first: &'a wgpu::TextureView,
) -> Vec<&'a wgpu::TextureView> {
    let target = textures.accumulation;
    let further = target.attachments[1..].iter();
    // The bindings of attachments that a system does not have are filled, but not read.
    let filled = std::iter::repeat(first);
    [first, target.get_or_first(&REDUCED_DEPTH), &textures.baked_diffuse.array]
        .into_iter()
        .chain(further)
        .chain(filled)
        .take(TEXTURES)
        .collect()
}
