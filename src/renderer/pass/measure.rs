//! measure: measures the extent of a host's particles, which the CPU cannot read.
//!
//! Reads: particles; the system's uniforms.
//! Writes: the extent, which is then copied into the system's uniforms.

use std::mem::offset_of;

use haze_core::formula::uniforms::{MeasureUniform, SystemUniform};

use super::groups::Groups;
use crate::renderer::gpu::binding::{READ_BUFFER, WRITTEN_BUFFER, uniform};
use crate::renderer::gpu::frame_encoder::FrameEncoder;
use crate::renderer::gpu::pipeline::ComputePipelineDescription;
use crate::renderer::layouts::GroupSet;
use crate::renderer::pipeline_variants::PipelineKey;

/// Invocations of a workgroup, and the largest number of workgroups: WORKGROUP in `shaders/measure.wgsl`.
pub(crate) const WORKGROUP: u32 = 256;

/// Bytes of the extent that are copied: `center`, `smoke_near`, `smoke_far` and `smoke_depth_limit` of the uniforms, in
/// this order.
const EXTENT_BYTES: u64 = 24;

const _: () = assert!(
    offset_of!(SystemUniform, smoke_near) == offset_of!(SystemUniform, center) + 12
        && offset_of!(SystemUniform, smoke_far) == offset_of!(SystemUniform, center) + 16
        && offset_of!(SystemUniform, smoke_depth_limit) == offset_of!(SystemUniform, center) + 20
);

/// Key of a pipeline: the step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum MeasureKey {
    SumParticles,
    CombineSums,
    FarthestParticle,
}

impl MeasureKey {
    /// All steps, in order.
    pub const ALL: [Self; 3] = [Self::SumParticles, Self::CombineSums, Self::FarthestParticle];
}

impl PipelineKey for MeasureKey {
    const PASS: &'static str = "measure";
    const GROUPS: GroupSet = GroupSet::Sprites;
    type Description = ComputePipelineDescription;

    fn inputs() -> Vec<wgpu::BindingType> {
        vec![uniform(size_of::<MeasureUniform>()), READ_BUFFER, WRITTEN_BUFFER, WRITTEN_BUFFER]
    }

    fn describe(self) -> ComputePipelineDescription {
        let entry_point = match self {
            MeasureKey::SumParticles => "sum_particles",
            MeasureKey::CombineSums => "combine_sums",
            MeasureKey::FarthestParticle => "farthest_particle",
        };
        ComputePipelineDescription { entry_point, constants: Vec::new() }
    }
}

/// The pass for one system.
#[derive(Debug)]
pub(crate) struct Measure {
    /// In the order of [`MeasureKey::ALL`].
    pub pipelines: [wgpu::ComputePipeline; 3],
    pub groups: Groups,
    /// Group 3.
    pub inputs: wgpu::BindGroup,
    /// Workgroups of the steps that read particles.
    pub workgroups: u32,
    pub measured: wgpu::Buffer,
    /// Uniforms of the system.
    pub system: wgpu::Buffer,
}

impl Measure {
    pub fn record(&self, encoder: &mut FrameEncoder<'_>) {
        let pass = encoder.compute("measure");
        self.groups.bind_to_compute(pass);
        pass.set_bind_group(3, &self.inputs, &[]);
        for (pipeline, workgroups) in self.pipelines.iter().zip([self.workgroups, 1, self.workgroups]) {
            pass.set_pipeline(pipeline);
            pass.dispatch_workgroups(workgroups, 1, 1);
        }
        let offset = offset_of!(SystemUniform, center) as u64;
        encoder.commands().copy_buffer_to_buffer(&self.measured, 0, &self.system, offset, EXTENT_BYTES);
    }
}
