//! shadow_visibility_slice: shadow_visibility on devices without compute shaders. `VolumeSlices` records it.
//!
//! Reads: shadow maps of the lights.
//! Writes: visibility of the lights, in blocks of the volume.
//! Blend: none.

use super::volume_slice;
use crate::renderer::gpu::pipeline::RenderPipelineDescription;

/// Returns the pipeline's parts.
pub(crate) fn describe((): ()) -> RenderPipelineDescription {
    volume_slice(Vec::new())
}
