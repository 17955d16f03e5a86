//! depth_downsample: reduces the scene depth to the resolution of the accumulation target.
//!
//! Reads: scene depth.
//! Writes: reduced depth, Depth32Float, linear view depth divided by `depth_limit`. If the backend cannot test what it
//! samples, also a coarse copy, never nearer than the original.
//! Blend: none.
//! Source: OTEE "Transfer & lighting", option 1.

use glam::UVec2;

use crate::renderer::gpu::pipeline::{RenderPipelineDescription, bool_constant, enum_constant, read_only_depth};
use crate::renderer::gpu::record::{begin_pass, set_viewport_and_scissor, written_depth};
use crate::renderer::gpu::timing::Timing;
use crate::renderer::targets::{DEPTH_COPY_FORMAT, REDUCED_DEPTH_FORMAT};
use crate::settings::DepthDownsample;

/// Key of a downsampling pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct DepthDownsampleKey {
    pub mode: DepthDownsample,
    /// True for the coarse copy.
    pub copy: bool,
}

/// Returns the pipeline's parts for a key.
pub(crate) fn describe(key: DepthDownsampleKey) -> RenderPipelineDescription {
    let format = if key.copy { DEPTH_COPY_FORMAT } else { REDUCED_DEPTH_FORMAT };
    RenderPipelineDescription {
        buffers: &[],
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            depth_write_enabled: Some(true),
            ..read_only_depth(format, wgpu::CompareFunction::Always)
        }),
        sample_count: 1,
        targets: Vec::new(),
        constants: vec![enum_constant!("DEPTH_DOWNSAMPLE", key.mode), bool_constant("COARSE_COPY", key.copy)],
    }
}

/// The pass for one system and one target.
#[derive(Debug)]
pub(crate) struct Downsample {
    pub pipeline: wgpu::RenderPipeline,
    pub target: wgpu::TextureView,
    /// Size of the part in use, texels.
    pub size: UVec2,
    pub frame: wgpu::BindGroup,
    pub system: wgpu::BindGroup,
}

impl Downsample {
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, timing: Option<&Timing>) {
        let mut pass = begin_pass(encoder, "depth_downsample", &[], Some(written_depth(&self.target)), timing);
        set_viewport_and_scissor(&mut pass, UVec2::ZERO, self.size);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.frame, &[]);
        pass.set_bind_group(1, &self.system, &[]);
        pass.draw(0..3, 0..1);
    }
}
