//! sort: stable radix sort of keys and of the particle indices that belong to them (`indices`).
//!
//! Reads and writes: keys and indices, alternating between two pairs of buffers; after four digits the result is in the
//! first pair.
//! Source: Merrill and Grimshaw, "High performance and scalable radix sorting", 2011.

use crate::renderer::gpu::pipeline::{ComputePipelineDescription, bool_constant};

/// Keys per workgroup: `ROUNDS` in `shaders/sort.wgsl` times its invocations.
pub(crate) const BLOCK: u32 = 1024;
/// Number of values of a digit.
pub(crate) const DIGITS: u32 = 256;
/// Number of digits of a key.
const DIGITS_PER_KEY: u32 = 4;
/// Up to this many keys, every workgroup on a GPU counts the digits of all keys itself, which takes less time than
/// dispatches that wait for each other.
const MAX_KEYS_SCATTER_ONLY: u32 = 8192;
/// Up to this many keys, every workgroup on a CPU sums up the counts of all blocks itself, because barriers within a
/// workgroup are slow on CPUs.
const MAX_KEYS_WITHOUT_SCAN: u32 = 128 * BLOCK;

/// Key of a pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct SortKey {
    step: Step,
    digit: u32,
    variant: SortVariant,
}

/// Size class of the number of keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum SortVariant {
    ScatterOnly,
    WithoutScan,
    WithScan,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Step {
    CountDigits,
    SumCounts,
    Scatter,
}

/// Maximum number of pipelines of one sort.
pub(crate) const MAX_PIPELINES: usize = 3 * DIGITS_PER_KEY as usize;

/// Returns the keys of the pipelines that sort `count` keys, in order. `cooperative`: true for cooperative workgroups,
/// as on GPUs.
pub(crate) fn keys(cooperative: bool, count: u32) -> impl Iterator<Item = SortKey> {
    let (variant, steps): (_, &[Step]) = match (cooperative, count) {
        (true, 0..=MAX_KEYS_SCATTER_ONLY) => (SortVariant::ScatterOnly, &[Step::Scatter]),
        (false, 0..=MAX_KEYS_WITHOUT_SCAN) => (SortVariant::WithoutScan, &[Step::CountDigits, Step::Scatter]),
        _ => (SortVariant::WithScan, &[Step::CountDigits, Step::SumCounts, Step::Scatter]),
    };
    (0..DIGITS_PER_KEY).flat_map(move |digit| steps.iter().map(move |&step| SortKey { step, digit, variant }))
}

/// Returns the keys of all pipelines that sort any number of keys.
pub(crate) fn all_keys(cooperative: bool) -> impl Iterator<Item = SortKey> {
    [0, u32::MAX].into_iter().flat_map(move |count| keys(cooperative, count))
}

/// Returns the pipeline's parts for a key.
pub(crate) fn describe(key: SortKey) -> ComputePipelineDescription {
    ComputePipelineDescription {
        entry_point: match key.step {
            Step::CountDigits => "count_digits",
            Step::SumCounts => "sum_counts",
            Step::Scatter => "scatter",
        },
        constants: vec![
            ("SHIFT", f64::from(key.digit * DIGITS.ilog2())),
            bool_constant("SCATTER_ONLY", key.variant == SortVariant::ScatterOnly),
            bool_constant("WITHOUT_SCAN", key.variant == SortVariant::WithoutScan),
        ],
    }
}

/// The sort of one system.
#[derive(Debug)]
pub(crate) struct Sort {
    /// Pipelines in the order of [`keys`].
    pub pipelines: [Option<(SortKey, wgpu::ComputePipeline)>; MAX_PIPELINES],
    /// Bind groups: from the first pair of buffers to the second, and back.
    pub ping_pong: [wgpu::BindGroup; 2],
    pub keys: u32,
}

impl Sort {
    pub fn record(&self, pass: &mut wgpu::ComputePass<'_>) {
        for (key, pipeline) in self.pipelines.iter().flatten() {
            let workgroups = match key {
                SortKey { step: Step::SumCounts, .. } => DIGITS,
                SortKey { variant: SortVariant::ScatterOnly, .. } => self.keys.div_ceil(DIGITS),
                _ => self.keys.div_ceil(BLOCK),
            };
            pass.set_bind_group(0, &self.ping_pong[key.digit as usize % 2], &[]);
            pass.set_pipeline(pipeline);
            pass.dispatch_workgroups(workgroups, 1, 1);
        }
    }
}
