//! tile_gather: copies the sprites' rectangles into sorted order, and counts the visible sprites.
//!
//! Reads: sorted keys and sprite indices, rectangles.
//! Writes: sorted rectangles, the count, and the indirect dispatch size for it.

use haze_core::formula::uniforms::TilesUniform;

use crate::renderer::gpu::binding::{READ_BUFFER, WRITTEN_BUFFER, uniform};
use crate::renderer::gpu::pipeline::{ComputePipelineDescription, bool_constant};
use crate::renderer::layouts::GroupSet;
use crate::renderer::pipeline_variants::PipelineKey;

/// Key of a pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct TileGatherKey {
    /// True if the sprites are sorted by key, hidden ones last.
    pub sorted: bool,
}

impl PipelineKey for TileGatherKey {
    const PASS: &'static str = "tile_gather";
    const GROUPS: GroupSet = GroupSet::None;
    type Description = ComputePipelineDescription;

    fn inputs() -> Vec<wgpu::BindingType> {
        vec![
            uniform(size_of::<TilesUniform>()),
            READ_BUFFER,
            READ_BUFFER,
            READ_BUFFER,
            WRITTEN_BUFFER,
            WRITTEN_BUFFER,
            WRITTEN_BUFFER,
        ]
    }

    fn describe(self) -> ComputePipelineDescription {
        ComputePipelineDescription { entry_point: "gather", constants: vec![bool_constant("SORTED", self.sorted)] }
    }
}

/// The pass for one system.
#[derive(Debug)]
pub(crate) struct TileGather {
    pub pipeline: wgpu::ComputePipeline,
    pub inputs: wgpu::BindGroup,
    pub particles: u32,
}

impl TileGather {
    pub fn record(&self, pass: &mut wgpu::ComputePass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.inputs, &[]);
        pass.dispatch_workgroups(self.particles.div_ceil(64), 1, 1);
    }
}
