//! depth_slopes: fits a line to the lit smoke over depth around each texel, for its upsampling under `guided`.
//! `TexelPass` records it.
//!
//! Reads: lit smoke, reduced depth.
//! Writes: slopes, Rgba16Float.
//! Blend: none.
//! Source: He and Sun, "Fast guided filter", 2015.

use crate::renderer::gpu::pipeline::{RenderPipelineDescription, color_target};
use crate::renderer::targets::LIT_FORMAT;

/// Key of the only pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct DepthSlopesKey;

/// Returns the pipeline's parts.
pub(crate) fn describe(DepthSlopesKey: DepthSlopesKey) -> RenderPipelineDescription {
    RenderPipelineDescription {
        buffers: &[],
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        sample_count: 1,
        targets: vec![color_target(LIT_FORMAT, None)],
        constants: Vec::new(),
    }
}
