//! tile_gather
//! What: puts the rectangles of sprites in order, and finds how many are shown.
//! Reads: sorted keys and numbers, rectangles. Writes: sorted rectangles, the number, and workgroups for as many.

use crate::renderer::gpu::pipeline::{ComputeParts, switch};

/// What makes one pipeline differ from another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct TileGatherKey {
    /// The hidden sprites are last.
    pub sorted: bool,
}

/// The pipeline for a key.
pub(crate) fn describe(key: TileGatherKey) -> ComputeParts {
    ComputeParts { entry_point: "gather", constants: vec![switch("SORTED", key.sorted)] }
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
