//! tile_bin
//! What: lists the sprites that touch a bin of the target, front to back, for every bin.
//! Reads: sorted numbers and rectangles. Writes: lists, and where they begin.

use crate::renderer::gpu::pipeline::ComputeParts;

/// Sprites that are put into bins by one invocation: RUN in `shaders/lib/tiles.wgsl`.
pub(crate) const RUN: u32 = 64;
/// Sprites whose lists are made in one: bits of `touching` in `shaders/tile_bin.wgsl`.
pub(crate) const FEW: u32 = 1 << 15;

/// What makes one pipeline differ from another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct TileBinKey {
    step: Step,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Step {
    CountSprites,
    ListFew,
    Allocate,
    AllocateAlone,
    Fill,
    CountAlone,
    FillAlone,
}

/// Pipelines at the most.
pub(crate) const STEPS: usize = 3;

/// All of them, in order. `in_step`: workgroups add up together. `few`: no more sprites than [`FEW`].
pub(crate) fn keys(in_step: bool, few: bool) -> impl Iterator<Item = TileBinKey> {
    let steps: &[Step] = match (in_step, few) {
        (true, true) => &[Step::ListFew],
        (true, false) => &[Step::CountSprites, Step::Allocate, Step::Fill],
        (false, _) => &[Step::CountAlone, Step::AllocateAlone, Step::FillAlone],
    };
    steps.iter().map(|&step| TileBinKey { step })
}

/// The pipeline for a key.
pub(crate) fn describe(key: TileBinKey) -> ComputeParts {
    ComputeParts {
        entry_point: match key.step {
            Step::CountSprites => "count_sprites",
            Step::ListFew => "list_few",
            Step::Allocate => "allocate",
            Step::AllocateAlone => "allocate_alone",
            Step::Fill => "fill",
            Step::CountAlone => "count_alone",
            Step::FillAlone => "fill_alone",
        },
        constants: Vec::new(),
    }
}

/// The pass for one system.
#[derive(Debug)]
pub(crate) struct TileBin {
    /// As [`keys`].
    pub pipelines: [Option<(TileBinKey, wgpu::ComputePipeline)>; STEPS],
    pub inputs: wgpu::BindGroup,
    /// Workgroups for the runs that are shown.
    pub workgroups: wgpu::Buffer,
    pub bins: u32,
    /// Of all sprites.
    pub runs: u32,
}

impl TileBin {
    pub fn record(&self, pass: &mut wgpu::ComputePass<'_>) {
        pass.set_bind_group(0, &self.inputs, &[]);
        for (key, pipeline) in self.pipelines.iter().flatten() {
            pass.set_pipeline(pipeline);
            match key.step {
                // Of many some are out of sight, more often than not.
                Step::CountSprites | Step::Fill => pass.dispatch_workgroups_indirect(&self.workgroups, 0),
                Step::Allocate | Step::ListFew => pass.dispatch_workgroups(self.bins, 1, 1),
                Step::AllocateAlone => pass.dispatch_workgroups(self.bins.div_ceil(64), 1, 1),
                Step::CountAlone | Step::FillAlone => pass.dispatch_workgroups(self.runs.div_ceil(8), 1, 1),
            }
        }
    }
}
