//! diffuse_bake: bakes all lights through the diffuse ramp into a small texture by normal, once per system and frame.
//!
//! Reads: lights, diffuse ramp.
//! Writes: cubemap faces or motif, Rgba16Float.
//! Blend: none.
//! Source: OTEE "Diffuse lighting": "use cubemaps", "motif lighting".

use std::sync::Arc;

use haze_core::formula::diffuse_bake::baked_size_and_layers;
use haze_core::settings::{Backlight, DiffuseMode, RampFilter};

use super::groups::Groups;
use crate::renderer::gpu::frame_encoder::FrameEncoder;
use crate::renderer::gpu::pipeline::{RenderPipelineDescription, bool_constant, color_target, enum_constant};
use crate::renderer::gpu::record::color_attachment;
use crate::renderer::layouts::GroupSet;
use crate::renderer::pipeline_variants::PipelineKey;
use crate::renderer::targets::BAKED_DIFFUSE_FORMAT;

/// Key of a baking pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct DiffuseBakeKey {
    /// A mode that bakes.
    pub mode: DiffuseMode,
    pub backlight: Backlight,
    pub ambient: bool,
    pub ramp_filter: RampFilter,
    pub exact_filtering: bool,
}

impl PipelineKey for DiffuseBakeKey {
    const PASS: &'static str = "diffuse_bake";
    const GROUPS: GroupSet = GroupSet::Sprites;
    type Description = RenderPipelineDescription;

    fn describe(self) -> RenderPipelineDescription {
        let (side, _) = baked_size_and_layers(self.mode).unwrap_or((1, 1));
        RenderPipelineDescription {
            buffers: &[],
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            sample_count: 1,
            targets: vec![color_target(BAKED_DIFFUSE_FORMAT, None)],
            constants: vec![
                bool_constant("MOTIF", self.mode == DiffuseMode::Motif),
                ("BAKE_SIZE", f64::from(side)),
                enum_constant!("BACKLIGHT", self.backlight),
                bool_constant("AMBIENT", self.ambient),
                enum_constant!("RAMP_FILTER", self.ramp_filter),
                bool_constant("EXACT_FILTERING", self.exact_filtering),
            ],
        }
    }
}

/// The pass for one system: every face of the cubemap, or the motif.
#[derive(Debug)]
pub(crate) struct DiffuseBake {
    pub pipeline: wgpu::RenderPipeline,
    pub faces: Arc<[wgpu::TextureView]>,
    pub groups: Groups,
}

impl DiffuseBake {
    pub fn record(&self, encoder: &mut FrameEncoder<'_>) {
        for (face, view) in (0..).zip(self.faces.iter()) {
            let mut pass = encoder.render("diffuse_bake", &[color_attachment(view)], None);
            pass.set_pipeline(&self.pipeline);
            self.groups.bind(&mut pass);
            pass.draw(3 * face..3 * face + 3, 0..1);
        }
    }
}
