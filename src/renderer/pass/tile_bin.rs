//! tile_bin
//! What: lists the sprites that touch a bin of the target, front to back, for every bin.
//! Reads: sorted numbers, rectangles. Writes: lists, and where they begin.

use crate::renderer::gpu::pipeline::{ComputeParts, switch};

/// Sprites that are put into bins by one invocation: RUN in `shaders/tile_bin.wgsl`.
pub(crate) const RUN: u32 = 64;

/// What makes one pipeline differ from another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct TileBinKey {
    step: Step,
    sorted: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Step {
    Gather,
    CountSprites,
    Allocate,
    AllocateAlone,
    Fill,
}

/// All of them, in order. `in_step`: workgroups add up together. `sorted`: the hidden sprites are last.
pub(crate) fn keys(in_step: bool, sorted: bool) -> [TileBinKey; 4] {
    let allocate = if in_step { Step::Allocate } else { Step::AllocateAlone };
    [Step::Gather, Step::CountSprites, allocate, Step::Fill].map(|step| TileBinKey { step, sorted })
}

/// The pipeline for a key.
pub(crate) fn describe(key: TileBinKey) -> ComputeParts {
    ComputeParts {
        entry_point: match key.step {
            Step::Gather => "gather",
            Step::CountSprites => "count_sprites",
            Step::Allocate => "allocate",
            Step::AllocateAlone => "allocate_alone",
            Step::Fill => "fill",
        },
        constants: vec![switch("SORTED", key.sorted)],
    }
}

/// The pass for one system.
#[derive(Debug)]
pub(crate) struct TileBin {
    /// As [`keys`].
    pub pipelines: [wgpu::ComputePipeline; 4],
    pub inputs: wgpu::BindGroup,
    pub particles: u32,
    pub bins: u32,
    pub runs: u32,
    pub in_step: bool,
}

impl TileBin {
    pub fn record(&self, pass: &mut wgpu::ComputePass<'_>) {
        pass.set_bind_group(0, &self.inputs, &[]);
        let by_bin_and_run = (self.bins.div_ceil(64), self.runs);
        let by_bin = (if self.in_step { self.bins } else { self.bins.div_ceil(64) }, 1);
        let workgroups = [(self.particles.div_ceil(64), 1), by_bin_and_run, by_bin, by_bin_and_run];
        for (pipeline, (x, y)) in self.pipelines.iter().zip(workgroups) {
            pass.set_pipeline(pipeline);
            pass.dispatch_workgroups(x, y, 1);
        }
    }
}
