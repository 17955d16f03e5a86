//! depth_sort
//! What: puts a host's particles back to front. Reads: particles, their numbers, sorted. Writes: keys and numbers; particles.

use super::Groups;
use super::sort::Sort;
use crate::renderer::gpu::pipeline::ComputeParts;

/// What makes one pipeline differ from another: before the sort, and after it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum DepthSortKey {
    DepthKeys,
    GatherParticles,
}

/// The pipeline for a key.
pub(crate) fn describe(key: DepthSortKey) -> ComputeParts {
    let entry_point = match key {
        DepthSortKey::DepthKeys => "depth_keys",
        DepthSortKey::GatherParticles => "gather_particles",
    };
    ComputeParts { entry_point, constants: Vec::new() }
}

/// The pass for one system.
#[derive(Debug)]
pub(crate) struct DepthSort {
    pub depth_keys: wgpu::ComputePipeline,
    pub sort: Sort,
    pub gather_particles: wgpu::ComputePipeline,
    /// Group 3 of both pipelines.
    pub inputs: wgpu::BindGroup,
    pub particles: u32,
}

impl DepthSort {
    pub fn record(&self, pass: &mut wgpu::ComputePass<'_>, groups: &Groups) {
        self.dispatch(pass, groups, &self.depth_keys);
        self.sort.record(pass);
        self.dispatch(pass, groups, &self.gather_particles);
    }

    fn dispatch(&self, pass: &mut wgpu::ComputePass<'_>, groups: &Groups, pipeline: &wgpu::ComputePipeline) {
        pass.set_pipeline(pipeline);
        groups.bind_to_compute(pass);
        pass.set_bind_group(3, &self.inputs, &[]);
        pass.dispatch_workgroups(self.particles.div_ceil(64), 1, 1);
    }
}
