//! sort: stable sort of keys and of the particle indices that belong to them (`indices`): by their ranks if there are few,
//! else a radix sort.
//!
//! Reads and writes: keys and indices, alternating between two pairs of buffers. The result is in the first pair.
//! Source: Merrill and Grimshaw, "High performance and scalable radix sorting", 2011; rank sort: Knuth, "The art of
//! computer programming" 3, 5.2 (comparison counting).

use haze_core::formula::uniforms::TilesUniform;

use crate::renderer::gpu::binding::{READ_BUFFER, WRITTEN_BUFFER, uniform};
use crate::renderer::gpu::pipeline::{ComputePipelineDescription, bool_constant};
use crate::renderer::layouts::GroupSet;
use crate::renderer::pipeline_variants::PipelineKey;

/// Keys per workgroup: `ROUNDS` in `shaders/sort.wgsl` times its invocations.
pub(crate) const BLOCK: u32 = 1024;
/// Number of values of a digit.
pub(crate) const DIGITS: u32 = 256;
/// Number of digits of a key.
const DIGITS_PER_KEY: u32 = 4;
/// Up to this many keys, a GPU compares each key with all, which takes less time than dispatches that wait for each other.
const MAX_RANKED_KEYS: u32 = 8192;
/// Keys per workgroup of `rank` in `shaders/sort.wgsl`.
const RANKED_KEYS: u32 = 8;
/// Up to this many keys, every workgroup on a CPU sums up the counts of all blocks itself, because barriers within a
/// workgroup are slow on CPUs.
const MAX_KEYS_WITHOUT_SCAN: u32 = 128 * BLOCK;

/// Key of a pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct SortKey {
    step: Step,
    digit: u32,
    without_scan: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Step {
    CountDigits,
    SumCounts,
    Scatter,
    Rank,
}

/// Maximum number of pipelines of one sort.
pub(crate) const MAX_PIPELINES: usize = 3 * DIGITS_PER_KEY as usize;

/// Returns the keys of the pipelines that sort `count` keys, in order. `cooperative`: true for cooperative workgroups,
/// as on GPUs.
pub(crate) fn keys(cooperative: bool, count: u32) -> impl Iterator<Item = SortKey> {
    let without_scan = !cooperative && count <= MAX_KEYS_WITHOUT_SCAN;
    let (digits, steps): (_, &[Step]) = if is_ranked(cooperative, count) {
        (1, &[Step::Rank])
    } else if without_scan {
        (DIGITS_PER_KEY, &[Step::CountDigits, Step::Scatter])
    } else {
        (DIGITS_PER_KEY, &[Step::CountDigits, Step::SumCounts, Step::Scatter])
    };
    (0..digits).flat_map(move |digit| steps.iter().map(move |&step| SortKey { step, digit, without_scan }))
}

/// Returns the keys of all pipelines that sort any number of keys.
pub(crate) fn all_keys(cooperative: bool) -> impl Iterator<Item = SortKey> {
    [0, u32::MAX].into_iter().flat_map(move |count| keys(cooperative, count))
}

/// Returns the pair of buffers from which `count` keys are sorted into the first: the second if one dispatch does it.
pub(crate) fn unsorted_pair(cooperative: bool, count: u32) -> usize {
    usize::from(is_ranked(cooperative, count))
}

fn is_ranked(cooperative: bool, count: u32) -> bool {
    cooperative && count <= MAX_RANKED_KEYS
}

impl PipelineKey for SortKey {
    const PASS: &'static str = "sort";
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
                Step::CountDigits => "count_digits",
                Step::SumCounts => "sum_counts",
                Step::Scatter => "scatter",
                Step::Rank => "rank",
            },
            constants: vec![
                ("SHIFT", f64::from(self.digit * DIGITS.ilog2())),
                bool_constant("WITHOUT_SCAN", self.without_scan),
            ],
        }
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
            let (from, workgroups) = match key.step {
                Step::Rank => (1, self.keys.div_ceil(RANKED_KEYS)),
                Step::SumCounts => (key.digit % 2, DIGITS),
                Step::CountDigits | Step::Scatter => (key.digit % 2, self.keys.div_ceil(BLOCK)),
            };
            pass.set_bind_group(0, &self.ping_pong[from as usize], &[]);
            pass.set_pipeline(pipeline);
            pass.dispatch_workgroups(workgroups, 1, 1);
        }
    }
}
