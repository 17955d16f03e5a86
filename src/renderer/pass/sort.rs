//! sort
//! What: a stable radix sort of keys and the numbers that go with them.
//! Reads and writes: keys and numbers, in two pairs of buffers by turns; four turns end where they began.
//! Source: Merrill and Grimshaw, "High performance and scalable radix sorting", 2011.

use crate::renderer::gpu::pipeline::{ComputeParts, switch};

/// Keys that one workgroup sorts: ROUNDS in `shaders/sort.wgsl` times its invocations.
pub(crate) const BLOCK: u32 = 1024;
/// Values of a digit.
pub(crate) const DIGITS: u32 = 256;
/// Digits of a key.
const TURNS: u32 = 4;
/// Keys that every block counts by itself: that takes less than dispatches that wait for each other.
pub(crate) const FEW: u32 = 8192;

/// One of the pipelines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct SortKey {
    step: Step,
    turn: u32,
    few: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Step {
    CountDigits,
    SumCounts,
    Scatter,
}

/// Pipelines at the most.
pub(crate) const STEPS: usize = 3 * TURNS as usize;

/// All of them, in order. `few`: no more keys than [`FEW`].
pub(crate) fn keys(few: bool) -> impl Iterator<Item = SortKey> {
    let each_turn: &[Step] = if few { &[Step::Scatter] } else { &[Step::CountDigits, Step::SumCounts, Step::Scatter] };
    (0..TURNS).flat_map(move |turn| each_turn.iter().map(move |&step| SortKey { step, turn, few }))
}

/// The pipeline for a key.
pub(crate) fn describe(key: SortKey) -> ComputeParts {
    ComputeParts {
        entry_point: match key.step {
            Step::CountDigits => "count_digits",
            Step::SumCounts => "sum_counts",
            Step::Scatter => "scatter",
        },
        constants: vec![("SHIFT", f64::from(key.turn * DIGITS.ilog2())), switch("FEW", key.few)],
    }
}

/// The sort of one system.
#[derive(Debug)]
pub(crate) struct Sort {
    /// As [`keys`].
    pub pipelines: [Option<(SortKey, wgpu::ComputePipeline)>; STEPS],
    /// From the first pair of buffers to the second, and back.
    pub there_and_back: [wgpu::BindGroup; 2],
    pub keys: u32,
}

impl Sort {
    pub fn record(&self, pass: &mut wgpu::ComputePass<'_>) {
        for (key, pipeline) in self.pipelines.iter().flatten() {
            let workgroups = match key {
                SortKey { step: Step::SumCounts, .. } => DIGITS,
                SortKey { few: true, .. } => self.keys.div_ceil(DIGITS),
                _ => self.keys.div_ceil(BLOCK),
            };
            pass.set_bind_group(0, &self.there_and_back[key.turn as usize % 2], &[]);
            pass.set_pipeline(pipeline);
            pass.dispatch_workgroups(workgroups, 1, 1);
        }
    }
}
