//! depth_resolve: keeps the farthest sample of every pixel of the host's multisampled depth buffer.
//!
//! Reads: the host's depth buffer.
//! Writes: resolved depth, Depth32Float, as the host stores it.
//! Blend: none.
//! Source: own; see `shaders/depth_resolve.wgsl`.

use haze_core::glam::UVec2;

use crate::renderer::gpu::frame_encoder::FrameEncoder;
use crate::renderer::gpu::pipeline::{RenderPipelineDescription, bool_constant, read_only_depth};
use crate::renderer::gpu::record::{set_viewport_and_scissor, written_depth};
use crate::renderer::layouts::GroupSet;
use crate::renderer::pipeline_variants::PipelineKey;

/// Format of the resolved depth.
pub(crate) const RESOLVED_DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Key of a resolve pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct DepthResolveKey {
    /// True if the depth buffer stores the near plane as 1.
    pub reversed: bool,
}

impl PipelineKey for DepthResolveKey {
    const PASS: &'static str = "depth_resolve";
    const GROUPS: GroupSet = GroupSet::None;
    type Description = RenderPipelineDescription;

    fn inputs() -> Vec<wgpu::BindingType> {
        vec![wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Depth,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: true,
        }]
    }

    fn describe(self) -> RenderPipelineDescription {
        RenderPipelineDescription {
            buffers: &[],
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                depth_write_enabled: Some(true),
                ..read_only_depth(RESOLVED_DEPTH_FORMAT, wgpu::CompareFunction::Always)
            }),
            sample_count: 1,
            targets: Vec::new(),
            constants: vec![bool_constant("REVERSED", self.reversed)],
        }
    }
}

/// The pass of a frame.
#[derive(Debug)]
pub(crate) struct DepthResolve<'a> {
    pub pipeline: wgpu::RenderPipeline,
    pub target: &'a wgpu::TextureView,
    /// Group 0: the host's depth buffer.
    pub samples: &'a wgpu::BindGroup,
    /// Rectangle of the view in the host's targets, pixels.
    pub origin: UVec2,
    pub size: UVec2,
}

impl DepthResolve<'_> {
    pub fn record(&self, encoder: &mut FrameEncoder<'_>) {
        let mut pass = encoder.render("depth_resolve", &[], Some(written_depth(self.target)));
        set_viewport_and_scissor(&mut pass, self.origin, self.size);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, self.samples, &[]);
        pass.draw(0..3, 0..1);
    }
}
