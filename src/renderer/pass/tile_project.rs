//! tile_project: projects every particle into the view.
//!
//! Reads: particles.
//! Writes: sprites, their rectangles, and the keys and indices to sort.

use haze_core::formula::uniforms::TilesUniform;

use super::groups::Groups;
use super::sprite_instances::SpriteKey;
use crate::renderer::gpu::binding::{READ_BUFFER, WRITTEN_BUFFER, uniform};
use crate::renderer::gpu::pipeline::{ComputePipelineDescription, bool_constant};
use crate::renderer::layouts::GroupSet;
use crate::renderer::pipeline_variants::PipelineKey;

/// Key of a pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct TileProjectKey {
    pub sprite: SpriteKey,
    pub weighted: bool,
}

impl PipelineKey for TileProjectKey {
    const PASS: &'static str = "tile_project";
    const GROUPS: GroupSet = GroupSet::Sprites;
    type Description = ComputePipelineDescription;

    fn inputs() -> Vec<wgpu::BindingType> {
        vec![
            uniform(size_of::<TilesUniform>()),
            READ_BUFFER,
            WRITTEN_BUFFER,
            WRITTEN_BUFFER,
            WRITTEN_BUFFER,
            WRITTEN_BUFFER,
            WRITTEN_BUFFER,
        ]
    }

    fn describe(self) -> ComputePipelineDescription {
        let constants = self.sprite.constants([bool_constant("WEIGHTED", self.weighted)]);
        ComputePipelineDescription { entry_point: "project", constants }
    }
}

/// The pass for one system.
#[derive(Debug)]
pub(crate) struct TileProject {
    pub pipeline: wgpu::ComputePipeline,
    /// Group 3.
    pub inputs: wgpu::BindGroup,
    pub particles: u32,
}

impl TileProject {
    pub fn record(&self, pass: &mut wgpu::ComputePass<'_>, groups: &Groups) {
        pass.set_pipeline(&self.pipeline);
        groups.bind_to_compute(pass);
        pass.set_bind_group(3, &self.inputs, &[]);
        pass.dispatch_workgroups(self.particles.div_ceil(64), 1, 1);
    }
}
