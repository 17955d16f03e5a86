//! depth_slopes: fits a line to the lit smoke over depth around each texel, for its upsampling under `guided`.
//!
//! Reads: lit smoke, reduced depth.
//! Writes: slopes, Rgba16Float.
//! Blend: none.
//! Source: He and Sun, "Fast guided filter", 2015.

use glam::UVec2;

use super::Groups;
use crate::renderer::gpu::pipeline::{RenderPipelineDescription, color_target};
use crate::renderer::gpu::record::{begin_pass, color_attachment, set_viewport_and_scissor};
use crate::renderer::gpu::timing::Timing;
use crate::renderer::targets::LIT_FORMAT;

/// Key of the pipeline, of which there is one.
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

/// The pass for one system.
#[derive(Debug)]
pub(crate) struct DepthSlopes {
    pub pipeline: wgpu::RenderPipeline,
    pub target: wgpu::TextureView,
    /// Size of the part in use, texels.
    pub size: UVec2,
    pub groups: Groups,
    /// Group 3: lit smoke and reduced depth.
    pub inputs: wgpu::BindGroup,
}

impl DepthSlopes {
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, timing: Option<&Timing>) {
        let mut pass = begin_pass(encoder, "depth_slopes", &[color_attachment(&self.target)], None, timing);
        set_viewport_and_scissor(&mut pass, UVec2::ZERO, self.size);
        pass.set_pipeline(&self.pipeline);
        self.groups.bind_for_lighting(&mut pass);
        pass.set_bind_group(3, &self.inputs, &[]);
        pass.draw(0..3, 0..1);
    }
}
