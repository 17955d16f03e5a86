//! shadow_march_slice: shadow_march on devices without compute shaders. `VolumeSlices` records it.
//!
//! Reads: optical depths across the cells, which the CPU has added up.
//! Writes: optical depths towards the lights; openness to sky and ground.
//! Blend: none.

use haze_core::formula::uniforms::ShadowMarchUniform;

use super::volume_slices::volume_slice;
use crate::renderer::gpu::binding::{texture, uniform};
use crate::renderer::gpu::pipeline::{RenderPipelineDescription, bool_constant};
use crate::renderer::layouts::GroupSet;
use crate::renderer::pipeline_variants::PipelineKey;

/// Ends of the marches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum MarchTo {
    Lights,
    Sky,
}

impl PipelineKey for MarchTo {
    const PASS: &'static str = "shadow_march_slice";
    const GROUPS: GroupSet = GroupSet::None;
    type Description = RenderPipelineDescription;

    fn inputs() -> Vec<wgpu::BindingType> {
        vec![uniform(size_of::<ShadowMarchUniform>()), texture(false, wgpu::TextureViewDimension::D3)]
    }

    fn describe(self) -> RenderPipelineDescription {
        volume_slice(vec![bool_constant("TO_SKY", self == MarchTo::Sky)])
    }
}
