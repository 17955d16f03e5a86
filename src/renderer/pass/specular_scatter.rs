//! specular_scatter: adds the glow of lights behind the smoke, one quad of constant pixel size around each light.
//!
//! Reads: accumulation target, or lit smoke and its depth slopes; reduced depth, scene depth, lights, specular ramp.
//! Writes: the host's color target.
//! Blend: ONE, ONE.
//! Source: OTEE "Specular scattering".

use super::Groups;
use crate::renderer::gpu::host_pass::HostPass;
use crate::renderer::gpu::pipeline::{
    ADDITIVE, QUAD_STRIP, RenderPipelineDescription, bool_constant, enum_constant, read_only_depth,
};
use crate::settings::{DebugView, RampFilter, Upsample};

/// Key of a specular scatter pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct SpecularScatterKey {
    pub host: HostPass,
    /// True if the amount comes from the output of light_target.
    pub lit: bool,
    pub upsample: Upsample,
    pub ramp_filter: RampFilter,
    pub exact_filtering: bool,
}

/// Returns the pipeline's parts for a key.
pub(crate) fn describe(key: SpecularScatterKey) -> RenderPipelineDescription {
    let always = |format| read_only_depth(format, wgpu::CompareFunction::Always);
    RenderPipelineDescription {
        buffers: &[],
        primitive: QUAD_STRIP,
        depth_stencil: key.host.depth_format.map(always),
        sample_count: key.host.sample_count,
        targets: key.host.color_targets(ADDITIVE),
        constants: vec![
            bool_constant("LIT", key.lit),
            enum_constant!("UPSAMPLE", key.upsample),
            enum_constant!("RAMP_FILTER", key.ramp_filter),
            bool_constant("EXACT_FILTERING", key.exact_filtering),
        ],
    }
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
