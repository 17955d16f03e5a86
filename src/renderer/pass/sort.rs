//! sort
//! What: a stable radix sort of keys and the numbers that go with them.
//! Reads and writes: keys and numbers, in two pairs of buffers by turns; four turns end where they began.
//! Source: Merrill and Grimshaw, "High performance and scalable radix sorting", 2011.

use crate::renderer::gpu::pipeline::ComputeParts;

/// Keys that one workgroup sorts: ROUNDS in `shaders/sort.wgsl` times its invocations.
pub(crate) const BLOCK: u32 = 1024;
/// Values of a digit.
pub(crate) const DIGITS: u32 = 256;
/// Digits of a key.
const TURNS: usize = 4;

/// One of the pipelines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct SortKey {
    step: Step,
    /// The digit's lowest bit.
    shift: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Step {
    CountDigits,
    SumCounts,
    Scatter,
}

/// Of all turns.
pub(crate) const STEPS: usize = TURNS * EACH_TURN.len();
const EACH_TURN: [Step; 3] = [Step::CountDigits, Step::SumCounts, Step::Scatter];

/// All of them, in order.
pub(crate) fn keys() -> [SortKey; STEPS] {
    std::array::from_fn(|index| SortKey {
        step: EACH_TURN[index % EACH_TURN.len()],
        shift: (index / EACH_TURN.len()) as u32 * DIGITS.ilog2(),
    })
}

/// The pipeline for a key.
pub(crate) fn describe(key: SortKey) -> ComputeParts {
    ComputeParts {
        entry_point: match key.step {
            Step::CountDigits => "count_digits",
            Step::SumCounts => "sum_counts",
            Step::Scatter => "scatter",
        },
        constants: vec![("SHIFT", f64::from(key.shift))],
    }
}

/// The sort of one system.
#[derive(Debug)]
pub(crate) struct Sort {
    /// As [`keys`].
    pub pipelines: [wgpu::ComputePipeline; STEPS],
    /// From the first pair of buffers to the second, and back.
    pub there_and_back: [wgpu::BindGroup; 2],
    pub blocks: u32,
}

impl Sort {
    pub fn record(&self, pass: &mut wgpu::ComputePass<'_>) {
        for (turn, pipelines) in self.pipelines.chunks(EACH_TURN.len()).enumerate() {
            pass.set_bind_group(0, &self.there_and_back[turn % 2], &[]);
            for (pipeline, workgroups) in pipelines.iter().zip([self.blocks, DIGITS, self.blocks]) {
                pass.set_pipeline(pipeline);
                pass.dispatch_workgroups(workgroups, 1, 1);
            }
        }
    }
}
