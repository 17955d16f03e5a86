//! specular_scatter: adds the glow of lights behind the smoke, one quad of constant pixel size around each light.
//!
//! Reads: accumulation target, or lit smoke and its depth slopes; reduced depth, scene depth, lights, specular ramp.
//! Writes: the host's color target.
//! Blend: ONE, ONE.
//! Source: OTEE "Specular scattering".

use haze_core::settings::{DebugView, RampFilter, Upsample};

use super::depth_slopes::DEPTH_SLOPES;
use super::groups::Groups;
use super::light_target::LIT;
use super::upsample_lit::{LIT_TYPES, lit_textures};
use crate::renderer::gpu::host_pass::HostPass;
use crate::renderer::gpu::pipeline::{
    ADDITIVE, QUAD_STRIP, RenderPipelineDescription, bool_constant, enum_constant, read_only_depth,
};
use crate::renderer::layouts::GroupSet;
use crate::renderer::pipeline_variants::{PipelineKey, PipelineVariants};
use crate::renderer::targets::{InputGroups, SystemTextures};

/// Key of a specular scatter pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct SpecularScatterKey {
    pub host: HostPass,
    /// True if the amount comes from the output of light_target.
    pub lit: bool,
    /// True if a texel covers several pixels.
    pub coarse: bool,
    pub upsample: Upsample,
    pub ramp_filter: RampFilter,
    pub exact_filtering: bool,
}

impl PipelineKey for SpecularScatterKey {
    const PASS: &'static str = "specular_scatter";
    const GROUPS: GroupSet = GroupSet::Lighting;
    type Description = RenderPipelineDescription;

    fn inputs() -> Vec<wgpu::BindingType> {
        LIT_TYPES.to_vec()
    }

    fn describe(self) -> RenderPipelineDescription {
        let always = |format| read_only_depth(format, wgpu::CompareFunction::Always);
        RenderPipelineDescription {
            buffers: &[],
            primitive: QUAD_STRIP,
            depth_stencil: self.host.depth_format.map(always),
            sample_count: self.host.sample_count,
            targets: self.host.color_targets(ADDITIVE),
            constants: vec![
                bool_constant("LIT", self.lit),
                bool_constant("COARSE", self.coarse),
                enum_constant!("UPSAMPLE", self.upsample),
                enum_constant!("RAMP_FILTER", self.ramp_filter),
                bool_constant("EXACT_FILTERING", self.exact_filtering),
            ],
        }
    }
}

/// Returns group 3.
pub(crate) fn inputs(
    pipelines: &PipelineVariants<SpecularScatterKey>,
    textures: SystemTextures<'_>,
    groups: &mut InputGroups,
) -> wgpu::BindGroup {
    let target = textures.accumulation;
    let [lit, slopes] = [LIT, DEPTH_SLOPES].map(|read| target.get_or_first(&read));
    groups.get("specular_scatter", || pipelines.bind_textures(lit_textures(target, lit, slopes)))
}

/// The pass for one system, in the host's pass: one quad per light.
#[derive(Debug)]
pub(crate) struct SpecularScatter {
    pub pipeline: wgpu::RenderPipeline,
    pub groups: Groups,
    /// Group 3: the targets.
    pub inputs: wgpu::BindGroup,
    pub lights: u32,
    /// True if transfer_lit adds the glow to the frame, so that only the debug view of the glow needs this pass.
    pub is_in_transfer: bool,
}

impl SpecularScatter {
    /// True if a debug view needs this pass.
    pub fn is_drawn(&self, debug_view: DebugView) -> bool {
        debug_view.shows_glow() && !(self.is_in_transfer && debug_view.shows_lit_smoke())
    }

    pub fn record(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        self.groups.bind_for_lighting(pass);
        pass.set_bind_group(3, &self.inputs, &[]);
        pass.draw(0..4, 0..self.lights);
    }
}
