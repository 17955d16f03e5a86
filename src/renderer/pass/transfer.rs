//! transfer: lights the accumulated smoke once per pixel, over the system's bounding box.
//!
//! Reads: accumulation target, reduced depth, scene depth, lights, ramps.
//! Writes: the host's color target.
//! Blend: ONE, ONE_MINUS_SRC_ALPHA.
//! Source: OTEE "Transfer & lighting".

use haze_core::settings::{CoverageMode, DebugView, Upsample};

use super::groups::Groups;
use super::light_target::{self, LightingKey, accumulated};
use crate::renderer::gpu::host_pass::HostPass;
use crate::renderer::gpu::pipeline::{
    Constant, PREMULTIPLIED_OVER, RenderPipelineDescription, bool_constant, depth_compare, enum_constant,
    read_only_depth,
};
use crate::renderer::layouts::GroupSet;
use crate::renderer::pipeline_variants::{PipelineKey, PipelineVariants};
use crate::renderer::targets::{InputGroups, SystemTextures};

/// Vertices of the box: twelve triangles.
const BOX_VERTICES: u32 = 36;
/// Vertices of a tile.
const TILE_VERTICES: u32 = 4;

/// Key of a transfer pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct TransferKey {
    pub drawn: BoundingBoxKey,
    pub lighting: LightingKey,
    pub upsample: Upsample,
    pub host_depth: bool,
    pub debug_view: DebugView,
    pub coverage: CoverageMode,
    pub is_additive: bool,
}

/// State of the host's pass and the faces with which a system's bounding box is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct BoundingBoxKey {
    pub host: HostPass,
    /// True to draw the back faces, untested: the near plane cuts the box, or there is no depth attachment.
    pub back_faces: bool,
    pub reversed: bool,
    /// True if the view mirrors, which reverses the winding of faces.
    pub mirrored: bool,
}

impl BoundingBoxKey {
    /// Returns a pipeline's parts. `constants`: those of the pass.
    pub fn describe(self, constants: Vec<Constant>) -> RenderPipelineDescription {
        let (cull, compare) = if self.back_faces {
            (wgpu::Face::Front, wgpu::CompareFunction::Always)
        } else {
            (wgpu::Face::Back, depth_compare(self.reversed))
        };
        let back_faces = bool_constant("BACK_FACES", self.back_faces);
        RenderPipelineDescription {
            buffers: &[],
            primitive: wgpu::PrimitiveState {
                front_face: if self.mirrored { wgpu::FrontFace::Cw } else { wgpu::FrontFace::Ccw },
                cull_mode: Some(cull),
                ..Default::default()
            },
            depth_stencil: self.host.depth_format.map(|format| read_only_depth(format, compare)),
            sample_count: self.host.sample_count,
            targets: self.host.color_targets(PREMULTIPLIED_OVER),
            constants: constants.into_iter().chain([back_faces]).collect(),
        }
    }
}

impl PipelineKey for TransferKey {
    const PASS: &'static str = "transfer";
    const GROUPS: GroupSet = GroupSet::Lighting;
    type Description = RenderPipelineDescription;

    fn inputs() -> Vec<wgpu::BindingType> {
        light_target::READS.to_vec()
    }

    fn describe(self) -> RenderPipelineDescription {
        self.drawn.describe(self.lighting.constants_with([
            enum_constant!("UPSAMPLE", self.upsample),
            enum_constant!("DEBUG_VIEW", self.debug_view),
            bool_constant("HOST_DEPTH", self.host_depth),
            enum_constant!("COVERAGE_MODE", self.coverage),
            bool_constant("ADDITIVE", self.is_additive),
        ]))
    }
}

/// Returns group 3.
pub(crate) fn inputs(
    pipelines: &PipelineVariants<TransferKey>,
    textures: SystemTextures<'_>,
    groups: &mut InputGroups,
) -> wgpu::BindGroup {
    let first = &textures.accumulation.attachments[0];
    groups.get("transfer", || pipelines.bind_textures(accumulated(textures, first)))
}

/// Returns group 3 with counted layers instead of the first texture, if they are counted.
pub(crate) fn overdraw_inputs(
    pipelines: &PipelineVariants<TransferKey>,
    textures: SystemTextures<'_>,
    groups: &mut InputGroups,
) -> Option<wgpu::BindGroup> {
    let layers = textures.accumulation.overdraw.as_ref()?;
    Some(groups.get("overdraw", || pipelines.bind_textures(accumulated(textures, &layers[0]))))
}

/// The pass for one system, in the host's pass; with lit smoke, transfer_lit.
#[derive(Debug)]
pub(crate) struct Transfer {
    /// Pipelines by debug view, drawn one after the other; `None` for those that are not shown.
    pub pipelines: [[Option<wgpu::RenderPipeline>; 2]; DebugView::ALL.len()],
    pub groups: Groups,
    /// Group 3: the targets.
    pub inputs: wgpu::BindGroup,
    /// As `inputs`, with counted layers instead of the first texture.
    pub overdraw_inputs: Option<wgpu::BindGroup>,
    /// Present if smoke is lit at the target's resolution.
    pub lit: Option<LitInputs>,
}

/// Inputs of transfer_lit.
#[derive(Debug)]
pub(crate) struct LitInputs {
    /// Group 3.
    pub group: wgpu::BindGroup,
    /// Number of tiles, which it draws instead of the box.
    pub tiles: u32,
}

impl Transfer {
    /// Draws the box for a debug view. Draws nothing for one that was not planned.
    pub fn record(&self, pass: &mut wgpu::RenderPass<'_>, debug_view: DebugView) {
        let lit = self.lit.as_ref().filter(|_| debug_view.shows_lit_smoke());
        let inputs = match (debug_view, lit) {
            (DebugView::Overdraw, _) => self.overdraw_inputs.as_ref(),
            (_, Some(lit)) => Some(&lit.group),
            _ => Some(&self.inputs),
        };
        let (vertices, instances) = lit.map_or((BOX_VERTICES, 1), |lit| (TILE_VERTICES, lit.tiles));
        self.groups.bind_for_lighting(pass);
        pass.set_bind_group(3, inputs, &[]);
        for pipeline in self.pipelines[debug_view as usize].iter().flatten() {
            pass.set_pipeline(pipeline);
            pass.draw(0..vertices, 0..instances);
        }
    }
}
