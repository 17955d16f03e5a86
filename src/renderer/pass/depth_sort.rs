//! depth_sort: sorts a host's particles back to front.
//!
//! Reads: particles; after the sort, the sorted particle indices.
//! Writes: keys and particle indices; after the sort, sorted particles.

use haze_core::formula::uniforms::TilesUniform;

use super::groups::Groups;
use super::sort::Sort;
use crate::renderer::gpu::binding::{READ_BUFFER, WRITTEN_BUFFER, uniform};
use crate::renderer::gpu::pipeline::ComputePipelineDescription;
use crate::renderer::layouts::GroupSet;
use crate::renderer::pipeline_variants::PipelineKey;

/// Key of a pipeline: the step before the sort, and the step after it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum DepthSortKey {
    DepthKeys,
    GatherParticles,
}

impl PipelineKey for DepthSortKey {
    const PASS: &'static str = "depth_sort";
    const GROUPS: GroupSet = GroupSet::Sprites;
    type Description = ComputePipelineDescription;

    fn inputs() -> Vec<wgpu::BindingType> {
        vec![uniform(size_of::<TilesUniform>()), READ_BUFFER, WRITTEN_BUFFER, WRITTEN_BUFFER, WRITTEN_BUFFER]
    }

    fn describe(self) -> ComputePipelineDescription {
        let entry_point = match self {
            DepthSortKey::DepthKeys => "depth_keys",
            DepthSortKey::GatherParticles => "gather_particles",
        };
        ComputePipelineDescription { entry_point, constants: Vec::new() }
    }
}

/// The pass for one system.
#[derive(Debug)]
pub(crate) struct DepthSort {
    pub depth_keys: wgpu::ComputePipeline,
    pub sort: Sort,
    pub gather_particles: wgpu::ComputePipeline,
    /// Group 3, with the keys before the sort and after it.
    pub unsorted: wgpu::BindGroup,
    pub sorted: wgpu::BindGroup,
    pub particles: u32,
}

impl DepthSort {
    pub fn record(&self, pass: &mut wgpu::ComputePass<'_>, groups: &Groups) {
        self.dispatch(pass, groups, &self.depth_keys, &self.unsorted);
        self.sort.record(pass);
        self.dispatch(pass, groups, &self.gather_particles, &self.sorted);
    }

    fn dispatch(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        groups: &Groups,
        pipeline: &wgpu::ComputePipeline,
        inputs: &wgpu::BindGroup,
    ) {
        pass.set_pipeline(pipeline);
        groups.bind_to_compute(pass);
        pass.set_bind_group(3, inputs, &[]);
        pass.dispatch_workgroups(self.particles.div_ceil(64), 1, 1);
    }
}
