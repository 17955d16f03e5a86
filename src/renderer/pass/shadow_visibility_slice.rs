//! shadow_visibility_slice: shadow_visibility on devices without compute shaders. `VolumeSlices` records it.
//!
//! Reads: shadow maps of the lights.
//! Writes: visibility of the lights, in blocks of the volume.
//! Blend: none.

use super::volume_slices::volume_slice;
use crate::renderer::gpu::pipeline::RenderPipelineDescription;
use crate::renderer::layouts::GroupSet;
use crate::renderer::pipeline_variants::PipelineKey;

/// Key of the only pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct ShadowVisibilitySliceKey;

impl PipelineKey for ShadowVisibilitySliceKey {
    const PASS: &'static str = "shadow_visibility_slice";
    const GROUPS: GroupSet = GroupSet::ShadowMaps;
    type Description = RenderPipelineDescription;

    fn describe(self) -> RenderPipelineDescription {
        volume_slice(Vec::new())
    }
}
