//! shadow_march_slice, shadow_visibility_slice: the volume of a frame's shadow, slice by slice, on devices without compute
//! shaders.
//!
//! Reads: optical depths across the cells, which the CPU has added up; shadow maps of the lights.
//! Writes: optical depths towards the lights, openness to sky and ground, visibility of the lights.
//! Blend: none.

use std::ops::Range;

use glam::{UVec2, UVec3};

use super::shadow_march::MarchTo;
use crate::renderer::gpu::pipeline::{RenderPipelineDescription, bool_constant, color_target};
use crate::renderer::gpu::record::{begin_pass, color_attachment, set_viewport_and_scissor};
use crate::renderer::layouts::SHADOW_FORMAT;

/// Returns the parts of a pipeline of shadow_march_slice.
pub(crate) fn describe_march(key: MarchTo) -> RenderPipelineDescription {
    RenderPipelineDescription {
        constants: vec![bool_constant("TO_SKY", key == MarchTo::Sky)],
        ..describe_visibility(())
    }
}

/// Returns the parts of the pipeline of shadow_visibility_slice.
pub(crate) fn describe_visibility((): ()) -> RenderPipelineDescription {
    RenderPipelineDescription {
        buffers: &[],
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        sample_count: 1,
        targets: vec![color_target(SHADOW_FORMAT, None)],
        constants: Vec::new(),
    }
}

/// Slices of the volume that one pipeline computes.
#[derive(Debug)]
pub(crate) struct Slices {
    pub pipeline: wgpu::RenderPipeline,
    /// Group 0.
    pub inputs: wgpu::BindGroup,
    /// Indices along z.
    pub range: Range<u32>,
}

/// The passes for one frame.
#[derive(Debug)]
pub(crate) struct ShadowSlices<'a> {
    pub slices: Vec<Slices>,
    pub volume: &'a wgpu::TextureView,
    /// Number of cells along each axis.
    pub size: UVec3,
}

impl ShadowSlices<'_> {
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        for Slices { pipeline, inputs, range } in &self.slices {
            for slice in range.clone() {
                let target = color_attachment(self.volume)
                    .map(|target| wgpu::RenderPassColorAttachment { depth_slice: Some(slice), ..target });
                let mut pass = begin_pass(encoder, "shadow_march", &[target], None, None);
                set_viewport_and_scissor(&mut pass, UVec2::ZERO, self.size.truncate());
                pass.set_pipeline(pipeline);
                pass.set_bind_group(0, inputs, &[]);
                pass.draw(0..3, slice..slice + 1);
            }
        }
    }
}
