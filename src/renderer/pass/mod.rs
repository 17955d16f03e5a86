//! Passes, one file each: pipeline keys, pipeline parts and recording. A pass receives values (bind groups, buffers,
//! counts, targets) and does not depend on their owner.

pub(crate) mod accumulate;
pub(crate) mod density_splat;
pub(crate) mod depth_downsample;
pub(crate) mod depth_resolve;
pub(crate) mod depth_slopes;
pub(crate) mod depth_sort;
pub(crate) mod diffuse_bake;
pub(crate) mod emit;
pub(crate) mod forward;
pub(crate) mod light_target;
pub(crate) mod mark_cells;
pub(crate) mod measure;
pub(crate) mod screen_shadow;
pub(crate) mod shadow_march;
pub(crate) mod shadow_march_slice;
pub(crate) mod shadow_visibility;
pub(crate) mod shadow_visibility_slice;
pub(crate) mod sort;
pub(crate) mod specular_scatter;
pub(crate) mod tile_accumulate;
pub(crate) mod tile_bin;
pub(crate) mod tile_gather;
pub(crate) mod tile_project;
pub(crate) mod tile_refine;
pub(crate) mod transfer;
pub(crate) mod transfer_lit;
pub(crate) mod upsample_lit;

use std::ops::Range;

use glam::{UVec2, UVec3};

use super::gpu::frame_encoder::FrameEncoder;
use super::gpu::pipeline::{Constant, RenderPipelineDescription, color_target};
use super::gpu::record::{begin_pass, color_attachment, set_viewport_and_scissor, written_depth};
use super::layouts::SHADOW_FORMAT;

/// Bind groups 0 to 2 of a system's passes.
#[derive(Clone, Debug)]
pub(crate) struct Groups {
    pub frame: wgpu::BindGroup,
    pub system: wgpu::BindGroup,
    pub material: wgpu::BindGroup,
    /// The part of the material that the passes that light accumulated smoke read.
    pub lighting: wgpu::BindGroup,
}

impl Groups {
    fn bind(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.bind_with(pass, &self.material);
    }

    /// Binds the groups of a pass that lights accumulated smoke.
    fn bind_for_lighting(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.bind_with(pass, &self.lighting);
    }

    fn bind_with(&self, pass: &mut wgpu::RenderPass<'_>, material: &wgpu::BindGroup) {
        pass.set_bind_group(0, &self.frame, &[]);
        pass.set_bind_group(1, &self.system, &[]);
        pass.set_bind_group(2, material, &[]);
    }

    fn bind_to_compute(&self, pass: &mut wgpu::ComputePass<'_>) {
        self.bind_to_compute_with(pass, &self.material);
    }

    fn bind_to_compute_with(&self, pass: &mut wgpu::ComputePass<'_>, material: &wgpu::BindGroup) {
        pass.set_bind_group(0, &self.frame, &[]);
        pass.set_bind_group(1, &self.system, &[]);
        pass.set_bind_group(2, material, &[]);
    }
}

/// A pass that writes every texel of a system's target, every cell or every pixel: depth_downsample, light_target,
/// depth_slopes, mark_cells, upsample_lit.
#[derive(Debug)]
pub(crate) struct TexelPass {
    /// Name in times and captures.
    pub name: &'static str,
    pub pipeline: TexelPipeline,
    /// Size of the part in use, texels.
    pub size: UVec2,
    pub groups: Groups,
    /// Group 3.
    pub inputs: Option<wgpu::BindGroup>,
}

/// Pipeline of a `TexelPass`, and the target that it writes.
#[derive(Debug)]
pub(crate) enum TexelPipeline {
    Color(wgpu::RenderPipeline, wgpu::TextureView),
    Colors(wgpu::RenderPipeline, [wgpu::TextureView; 2]),
    Depth(wgpu::RenderPipeline, wgpu::TextureView),
    /// The target is among the inputs.
    Compute(wgpu::ComputePipeline),
}

/// Texels or pixels of a workgroup along each axis.
const TEXELS_SIDE: u32 = 8;

impl TexelPass {
    pub fn record(&self, encoder: &mut FrameEncoder<'_>) {
        let (pipeline, colors, depth) = match &self.pipeline {
            TexelPipeline::Color(pipeline, target) => (pipeline, [color_attachment(target), None], None),
            TexelPipeline::Colors(pipeline, targets) => (pipeline, targets.each_ref().map(color_attachment), None),
            TexelPipeline::Depth(pipeline, target) => (pipeline, [None, None], Some(written_depth(target))),
            TexelPipeline::Compute(pipeline) => return self.record_compute(pipeline, encoder),
        };
        let count = colors.iter().flatten().count();
        let mut pass = encoder.render(self.name, &colors[..count], depth);
        set_viewport_and_scissor(&mut pass, UVec2::ZERO, self.size);
        pass.set_pipeline(pipeline);
        self.groups.bind_for_lighting(&mut pass);
        pass.set_bind_group(3, &self.inputs, &[]);
        pass.draw(0..3, 0..1);
    }

    fn record_compute(&self, pipeline: &wgpu::ComputePipeline, encoder: &mut FrameEncoder<'_>) {
        let pass = encoder.compute(self.name);
        pass.set_pipeline(pipeline);
        self.groups.bind_to_compute_with(pass, &self.groups.lighting);
        pass.set_bind_group(3, &self.inputs, &[]);
        pass.dispatch_workgroups(self.size.x.div_ceil(TEXELS_SIDE), self.size.y.div_ceil(TEXELS_SIDE), 1);
    }
}

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
fn volume_slice(constants: Vec<Constant>) -> RenderPipelineDescription {
    RenderPipelineDescription {
        buffers: &[],
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        sample_count: 1,
        targets: vec![color_target(SHADOW_FORMAT, None)],
        constants,
    }
}
