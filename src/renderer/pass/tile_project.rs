//! tile_project: projects every particle into the view.
//!
//! Reads: particles.
//! Writes: sprites, their rectangles, and the keys and indices to sort.

use super::Groups;
use crate::renderer::gpu::pipeline::{ComputePipelineDescription, bool_constant};
use crate::renderer::sprite_instances::SpriteKey;

/// Key of a pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct TileProjectKey {
    pub sprite: SpriteKey,
    pub weighted: bool,
}

/// Returns the pipeline's parts for a key.
pub(crate) fn describe(key: TileProjectKey) -> ComputePipelineDescription {
    let constants = key.sprite.constants([bool_constant("WEIGHTED", key.weighted)]);
    ComputePipelineDescription { entry_point: "project", constants }
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
