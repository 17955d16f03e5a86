//! accumulate: blends every sprite's normal and amount, or its six-way light, into the accumulation target.
//!
//! Reads: particles, sprite flipbook, detail map or noise, reduced depth or the host's own.
//! Writes: accumulation target.
//! Blend: ONE, ONE_MINUS_SRC_ALPHA; weighted normals ONE, ONE. Per texture: `targets/attachments.rs`.
//! Source: OTEE "Accumulating the particles"; techniques: NV, BLOG, MS.

use std::sync::Arc;

use haze_core::glam::UVec2;
use haze_core::settings::{AccumulationFormat, BlendOrder, NormalEncoding};
use haze_core::view_setup::AttachmentSet;

use super::depth_downsample::{DEPTH_COPY, REDUCED_DEPTH};
use super::groups::Groups;
use super::sprite_instances::{PARTICLE_LAYOUT, SpriteKey, Sprites};
use crate::renderer::gpu::binding::LOADED;
use crate::renderer::gpu::frame_encoder::FrameEncoder;
use crate::renderer::gpu::host_pass::MAX_ATTACHMENTS;
use crate::renderer::gpu::pipeline::{
    ADD_ALL, QUAD_STRIP, RenderPipelineDescription, bool_constant, color_target, depth_compare, enum_constant,
    read_only_depth,
};
use crate::renderer::gpu::record::{color_attachment, set_viewport_and_scissor, tested_depth};
use crate::renderer::layouts::GroupSet;
use crate::renderer::pipeline_variants::PipelineKey;
use crate::renderer::targets::{attachment_constants, attachments};

/// Key of an accumulation pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct AccumulateKey {
    pub format: AccumulationFormat,
    pub encoding: NormalEncoding,
    pub order: BlendOrder,
    pub attachments: AttachmentSet,
    pub sprite: SpriteKey,
    /// True if sprites are compared with the host's own depth instead of the reduced depth.
    pub host_depth: bool,
    pub depth_test: DepthTest,
    /// True to count layers instead of blending normals.
    pub overdraw: bool,
}

/// Depth test that rejects hidden sprites before they are shaded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum DepthTest {
    /// No hardware test: sprites behind the scene may show.
    InShader,
    /// Hardware test against the reduced depth, which the shader samples too.
    Reduced,
    /// Hardware test against a coarse copy of the reduced depth: this backend cannot test what the shader samples.
    Copy,
    /// Hardware test against the host's depth: its format, and true if it is reversed.
    Host(wgpu::TextureFormat, bool),
}

impl PipelineKey for AccumulateKey {
    const PASS: &'static str = "accumulate";
    const GROUPS: GroupSet = GroupSet::Sprites;
    type Description = RenderPipelineDescription;

    fn inputs() -> Vec<wgpu::BindingType> {
        vec![LOADED]
    }

    fn describe(self) -> RenderPipelineDescription {
        let set = if self.overdraw { AttachmentSet::NORMAL_AND_AMOUNT } else { self.attachments };
        RenderPipelineDescription {
            buffers: const { &[Some(PARTICLE_LAYOUT)] },
            primitive: QUAD_STRIP,
            depth_stencil: match self.depth_test {
                DepthTest::InShader => None,
                DepthTest::Reduced => Some(read_only_depth(REDUCED_DEPTH.drawn, depth_compare(false))),
                DepthTest::Copy => Some(read_only_depth(DEPTH_COPY.drawn, depth_compare(false))),
                DepthTest::Host(format, reversed) => Some(read_only_depth(format, depth_compare(reversed))),
            },
            sample_count: 1,
            targets: attachments(set)
                .map(|row| {
                    let blend = if self.overdraw { ADD_ALL } else { row.blend(self.order) };
                    color_target(row.raster_format(self.format), Some(blend))
                })
                .collect(),
            constants: self.sprite.constants(attachment_constants(set).chain([
                enum_constant!("NORMAL_ENCODING", self.encoding),
                bool_constant("HOST_DEPTH", self.host_depth),
                bool_constant("WEIGHTED", self.order == BlendOrder::Weighted),
                // The copy is too coarse to replace the shader's own test.
                bool_constant("DEPTH_TESTED", !matches!(self.depth_test, DepthTest::InShader | DepthTest::Copy)),
                bool_constant("OVERDRAW", self.overdraw),
            ])),
        }
    }
}

/// The pass for one system.
#[derive(Debug)]
pub(crate) struct Accumulate {
    pub pipeline: wgpu::RenderPipeline,
    pub targets: Arc<[wgpu::TextureView]>,
    /// Depth that the hardware tests sprites against.
    pub tested_depth: Option<wgpu::TextureView>,
    /// Size of the part in use, texels.
    pub size: UVec2,
    pub groups: Groups,
    /// Group 3: the depth that the shader reads.
    pub inputs: wgpu::BindGroup,
    pub sprites: Sprites,
}

impl Accumulate {
    pub fn record(&self, encoder: &mut FrameEncoder<'_>) {
        let attachments: [_; MAX_ATTACHMENTS] = std::array::from_fn(|index| color_attachment(self.targets.get(index)?));
        let attachments = &attachments[..self.targets.len()];
        let mut pass = encoder.render("accumulate", attachments, self.tested_depth.as_ref().map(tested_depth));
        set_viewport_and_scissor(&mut pass, UVec2::ZERO, self.size);
        pass.set_pipeline(&self.pipeline);
        self.groups.bind(&mut pass);
        pass.set_bind_group(3, &self.inputs, &[]);
        self.sprites.draw(&mut pass);
    }
}
