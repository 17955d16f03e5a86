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
/// Keys that every block counts by itself on a GPU: that takes less than dispatches that wait for each other.
const FEW: u32 = 8192;
/// Keys of whose blocks every one sums up all counts by itself on a CPU, where the steps of a workgroup wait for each other at length.
const OF_FEW_BLOCKS: u32 = 128 * BLOCK;

/// One of the pipelines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct SortKey {
    step: Step,
    turn: u32,
    number: Number,
}

/// How many keys there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Number {
    Few,
    OfFewBlocks,
    Many,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Step {
    CountDigits,
    SumCounts,
    Scatter,
}

/// Pipelines at the most.
pub(crate) const STEPS: usize = 3 * TURNS as usize;

/// All of them that sort so many keys, in order. `in_step`: workgroups add up together.
pub(crate) fn keys(in_step: bool, count: u32) -> impl Iterator<Item = SortKey> {
    let (number, each_turn): (_, &[Step]) = match (in_step, count) {
        (true, 0..=FEW) => (Number::Few, &[Step::Scatter]),
        (false, 0..=OF_FEW_BLOCKS) => (Number::OfFewBlocks, &[Step::CountDigits, Step::Scatter]),
        _ => (Number::Many, &[Step::CountDigits, Step::SumCounts, Step::Scatter]),
    };
    (0..TURNS).flat_map(move |turn| each_turn.iter().map(move |&step| SortKey { step, turn, number }))
}

/// All of them that sort any number.
pub(crate) fn all_keys(in_step: bool) -> impl Iterator<Item = SortKey> {
    [0, u32::MAX].into_iter().flat_map(move |count| keys(in_step, count))
}

/// The pipeline for a key.
pub(crate) fn describe(key: SortKey) -> ComputeParts {
    ComputeParts {
        entry_point: match key.step {
            Step::CountDigits => "count_digits",
            Step::SumCounts => "sum_counts",
            Step::Scatter => "scatter",
        },
        constants: vec![
            ("SHIFT", f64::from(key.turn * DIGITS.ilog2())),
            switch("FEW", key.number == Number::Few),
            switch("FEW_BLOCKS", key.number == Number::OfFewBlocks),
        ],
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
                SortKey { number: Number::Few, .. } => self.keys.div_ceil(DIGITS),
                _ => self.keys.div_ceil(BLOCK),
            };
            pass.set_bind_group(0, &self.there_and_back[key.turn as usize % 2], &[]);
            pass.set_pipeline(pipeline);
            pass.dispatch_workgroups(workgroups, 1, 1);
        }
    }
}
