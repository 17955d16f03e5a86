//! tile_gather: copies the sprites' rectangles into sorted order, and counts the visible sprites.
//!
//! Reads: sorted keys and sprite indices, rectangles.
//! Writes: sorted rectangles, the count, and the indirect dispatch size for it.

use crate::renderer::gpu::pipeline::{ComputePipelineDescription, bool_constant};

/// Key of a pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct TileGatherKey {
    /// True if the sprites are sorted by key, hidden ones last.
    pub sorted: bool,
}

/// Returns the pipeline's parts for a key.
pub(crate) fn describe(key: TileGatherKey) -> ComputePipelineDescription {
    ComputePipelineDescription { entry_point: "gather", constants: vec![bool_constant("SORTED", key.sorted)] }
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
