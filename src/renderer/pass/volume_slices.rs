//! Slices of a volume, drawn one after the other on devices without compute shaders.

use std::ops::Range;

use haze_core::glam::{UVec2, UVec3};

use crate::renderer::gpu::frame_encoder::FrameEncoder;
use crate::renderer::gpu::pipeline::{Constant, RenderPipelineDescription, color_target};
use crate::renderer::gpu::record::{begin_pass, color_attachment, set_viewport_and_scissor};
use crate::renderer::layouts::SHADOW_FORMAT;

/// A pass that computes slices of the volume of a frame's shadow: shadow_march_slice, shadow_visibility_slice.
#[derive(Debug)]
pub(crate) struct VolumeSlices<'a> {
    pub name: &'static str,
    pub pipeline: wgpu::RenderPipeline,
    /// Group 0.
    pub inputs: wgpu::BindGroup,
    pub volume: &'a wgpu::TextureView,
    /// Number of cells along each axis.
    pub size: UVec3,
    /// Indices along z.
    pub slices: Range<u32>,
}

impl VolumeSlices<'_> {
    pub fn record(&self, encoder: &mut FrameEncoder<'_>) {
        for slice in self.slices.clone() {
            let target = color_attachment(self.volume)
                .map(|target| wgpu::RenderPassColorAttachment { depth_slice: Some(slice), ..target });
            let mut pass = begin_pass(encoder.commands(), self.name, &[target], None, None);
            set_viewport_and_scissor(&mut pass, UVec2::ZERO, self.size.truncate());
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &self.inputs, &[]);
            pass.draw(0..3, slice..slice + 1);
        }
    }
}

/// Returns the parts of a pipeline of `VolumeSlices`.
pub(crate) fn volume_slice(constants: Vec<Constant>) -> RenderPipelineDescription {
    RenderPipelineDescription {
        buffers: &[],
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        sample_count: 1,
        targets: vec![color_target(SHADOW_FORMAT, None)],
        constants,
    }
}
