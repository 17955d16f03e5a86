//! depth_slopes: fits a line to the lit smoke over depth around each texel, for its upsampling under `guided`.
//! `TexelPass` records it.
//!
//! Reads: lit smoke, reduced depth.
//! Writes: slopes, Rgba16Float; in compute also the cells with slopes.
//! Blend: none.
//! Source: He and Sun, "Fast guided filter", 2015.

use crate::renderer::gpu::pipeline::{ComputePipelineDescription, RenderPipelineDescription, color_target};
use crate::renderer::targets::LIT_FORMAT;

/// Key of the only pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct DepthSlopesKey;

/// Returns the parts of the compute pipeline.
pub(crate) fn describe_compute(DepthSlopesKey: DepthSlopesKey) -> ComputePipelineDescription {
    ComputePipelineDescription { entry_point: "texels", constants: Vec::new() }
}

/// Returns the parts of the render pipeline.
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
