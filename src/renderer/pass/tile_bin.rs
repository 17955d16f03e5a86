//! tile_bin
//! What: lists the sprites that touch a bin of the target, front to back, for every bin.
//! Reads: sorted numbers, rectangles. Writes: lists, and where they begin.

use crate::renderer::gpu::pipeline::{ComputeParts, switch};

/// Sprites that are put into bins by one invocation: RUN in `shaders/tile_bin.wgsl`.
pub(crate) const RUN: u32 = 64;
/// Sprites whose lists are made in one: bits of `touching` in `shaders/tile_bin.wgsl`.
pub(crate) const FEW: u32 = 1 << 15;

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
    ListFew,
    Allocate,
    AllocateAlone,
    Fill,
    CountAlone,
    FillAlone,
}

/// Pipelines at the most.
pub(crate) const STEPS: usize = 4;

/// All of them, in order. `in_step`: workgroups add up together. `sorted`: the hidden sprites are last. `few`: no more than [`FEW`].
pub(crate) fn keys(in_step: bool, sorted: bool, few: bool) -> impl Iterator<Item = TileBinKey> {
    let steps: &[Step] = match (in_step, few) {
        (true, true) => &[Step::Gather, Step::ListFew],
        (true, false) => &[Step::Gather, Step::CountSprites, Step::Allocate, Step::Fill],
        (false, _) => &[Step::Gather, Step::CountAlone, Step::AllocateAlone, Step::FillAlone],
    };
    steps.iter().map(move |&step| TileBinKey { step, sorted })
}

/// The pipeline for a key.
pub(crate) fn describe(key: TileBinKey) -> ComputeParts {
    ComputeParts {
        entry_point: match key.step {
            Step::Gather => "gather",
            Step::CountSprites => "count_sprites",
            Step::ListFew => "list_few",
            Step::Allocate => "allocate",
            Step::AllocateAlone => "allocate_alone",
            Step::Fill => "fill",
            Step::CountAlone => "count_alone",
            Step::FillAlone => "fill_alone",
        },
        constants: vec![switch("SORTED", key.sorted)],
    }
}

/// The pass for one system.
#[derive(Debug)]
pub(crate) struct TileBin {
    /// As [`keys`].
    pub pipelines: [Option<(TileBinKey, wgpu::ComputePipeline)>; STEPS],
    pub inputs: wgpu::BindGroup,
    pub particles: u32,
    pub bins: u32,
    pub runs: u32,
}

impl TileBin {
    pub fn record(&self, pass: &mut wgpu::ComputePass<'_>) {
        pass.set_bind_group(0, &self.inputs, &[]);
        for (key, pipeline) in self.pipelines.iter().flatten() {
            let (x, y) = match key.step {
                Step::Gather => (self.particles.div_ceil(64), 1),
                Step::CountSprites | Step::Fill => (self.bins.div_ceil(64), self.runs),
                Step::Allocate | Step::ListFew => (self.bins, 1),
                Step::AllocateAlone => (self.bins.div_ceil(64), 1),
                Step::CountAlone | Step::FillAlone => (self.runs.div_ceil(8), 1),
            };
            pass.set_pipeline(pipeline);
            pass.dispatch_workgroups(x, y, 1);
        }
    }
}
