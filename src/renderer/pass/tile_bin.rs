//! tile_bin: lists, for every bin of the target, the sprites that touch it, front to back.
//!
//! Reads: sorted sprite indices and rectangles.
//! Writes: sprite lists, and the start of each.

use haze_core::formula::uniforms::TilesUniform;

use crate::renderer::gpu::binding::{READ_BUFFER, WRITTEN_BUFFER, uniform};
use crate::renderer::gpu::pipeline::ComputePipelineDescription;
use crate::renderer::layouts::GroupSet;
use crate::renderer::pipeline_variants::PipelineKey;

/// Up to this many sprites, one dispatch makes all lists: the number of bits of `touching` in `shaders/tile_bin.wgsl`.
pub(crate) const MAX_SPRITES_SINGLE_DISPATCH: u32 = 1 << 15;

/// Key of a pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct TileBinKey {
    step: Step,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Step {
    CountSprites,
    BuildLists,
    Allocate,
    AllocatePerInvocation,
    Fill,
    CountPerRun,
    FillPerRun,
}

/// Maximum number of pipelines in one frame.
pub(crate) const MAX_PIPELINES: usize = 3;

/// Returns the keys of a frame's pipelines, in order. `cooperative`: true for cooperative workgroups. `few`: true for
/// at most [`MAX_SPRITES_SINGLE_DISPATCH`] sprites.
pub(crate) fn keys(cooperative: bool, few: bool) -> impl Iterator<Item = TileBinKey> {
    let steps: &[Step] = match (cooperative, few) {
        (true, true) => &[Step::BuildLists],
        (true, false) => &[Step::CountSprites, Step::Allocate, Step::Fill],
        (false, _) => &[Step::CountPerRun, Step::AllocatePerInvocation, Step::FillPerRun],
    };
    steps.iter().map(|&step| TileBinKey { step })
}

impl PipelineKey for TileBinKey {
    const PASS: &'static str = "tile_bin";
    const GROUPS: GroupSet = GroupSet::None;
    type Description = ComputePipelineDescription;

    fn inputs() -> Vec<wgpu::BindingType> {
        vec![
            uniform(size_of::<TilesUniform>()),
            READ_BUFFER,
            READ_BUFFER,
            WRITTEN_BUFFER,
            WRITTEN_BUFFER,
            WRITTEN_BUFFER,
            WRITTEN_BUFFER,
        ]
    }

    fn describe(self) -> ComputePipelineDescription {
        ComputePipelineDescription {
            entry_point: match self.step {
                Step::CountSprites => "count_sprites",
                Step::BuildLists => "build_lists_in_one_dispatch",
                Step::Allocate => "allocate",
                Step::AllocatePerInvocation => "allocate_per_invocation",
                Step::Fill => "fill",
                Step::CountPerRun => "count_per_run",
                Step::FillPerRun => "fill_per_run",
            },
            constants: Vec::new(),
        }
    }
}

/// The pass for one system.
#[derive(Debug)]
pub(crate) struct TileBin {
    /// Pipelines in the order of [`keys`].
    pub pipelines: [Option<(TileBinKey, wgpu::ComputePipeline)>; MAX_PIPELINES],
    pub inputs: wgpu::BindGroup,
    /// Indirect dispatch size for the runs of visible sprites.
    pub workgroups: wgpu::Buffer,
    pub bins: u32,
    /// Number of runs of all sprites.
    pub runs: u32,
}

impl TileBin {
    pub fn record(&self, pass: &mut wgpu::ComputePass<'_>) {
        pass.set_bind_group(0, &self.inputs, &[]);
        for (key, pipeline) in self.pipelines.iter().flatten() {
            pass.set_pipeline(pipeline);
            match key.step {
                // Of many sprites some are usually out of sight, so the dispatch covers only the visible ones.
                Step::CountSprites | Step::Fill => pass.dispatch_workgroups_indirect(&self.workgroups, 0),
                Step::Allocate | Step::BuildLists => pass.dispatch_workgroups(self.bins, 1, 1),
                Step::AllocatePerInvocation => pass.dispatch_workgroups(self.bins.div_ceil(64), 1, 1),
                Step::CountPerRun | Step::FillPerRun => pass.dispatch_workgroups(self.runs.div_ceil(8), 1, 1),
            }
        }
    }
}
