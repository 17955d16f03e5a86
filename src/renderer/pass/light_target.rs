//! light_target: lights the accumulated smoke once per texel, if `lighting_resolution` selects it; transfer_lit
//! then upsamples the light. `TexelPass` records it.
//!
//! Reads: accumulation target, lights, ramps.
//! Writes: lit smoke, Rgba16Float.
//! Blend: none.
//! Source: OTEE "Transfer & lighting", at the target's resolution.

use crate::renderer::gpu::pipeline::{
    ComputePipelineDescription, Constant, RenderPipelineDescription, bool_constant, color_target, enum_constant,
};
use crate::renderer::targets::{LIT_FORMAT, attachment_constants};
use crate::settings::{Backlight, DiffuseMode, NormalDecode, NormalEncoding, RampFilter, SoftScatterMode};
use crate::view_setup::{AttachmentRole, AttachmentSet};

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
    pub fn constants<const N: usize>(&self, of_pass: [Constant; N]) -> Vec<Constant> {
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

/// Returns the pipeline's parts for a key.
pub(crate) fn describe(key: LightingKey) -> RenderPipelineDescription {
    RenderPipelineDescription {
        buffers: &[],
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        sample_count: 1,
        targets: vec![color_target(LIT_FORMAT, None)],
        constants: key.constants([]),
    }
}

/// Returns the parts of the compute pipeline for a key.
pub(crate) fn describe_compute(key: LightingKey) -> ComputePipelineDescription {
    ComputePipelineDescription { entry_point: "texels", constants: key.constants([]) }
}
