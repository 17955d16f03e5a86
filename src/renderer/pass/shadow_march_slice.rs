//! shadow_march_slice: shadow_march on devices without compute shaders. `VolumeSlices` records it.
//!
//! Reads: optical depths across the cells, which the CPU has added up.
//! Writes: optical depths towards the lights; openness to sky and ground.
//! Blend: none.

use super::volume_slice;
use crate::renderer::gpu::pipeline::{RenderPipelineDescription, bool_constant};

/// Ends of the marches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum MarchTo {
    Lights,
    Sky,
}

/// Returns the pipeline's parts for a key.
pub(crate) fn describe(key: MarchTo) -> RenderPipelineDescription {
    volume_slice(vec![bool_constant("TO_SKY", key == MarchTo::Sky)])
}
