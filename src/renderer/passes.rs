//! The shaders of all passes and their pipelines.

use super::gpu::pipeline::Variants;
use super::layouts::Layouts;
use super::pass::accumulate::{self, AccumulateKey};
use super::pass::depth_downsample::{self, DepthDownsampleKey};
use super::pass::diffuse_bake::{self, DiffuseBakeKey};
use super::pass::forward::{self, ForwardKey};
use super::pass::specular_scatter::{self, SpecularScatterKey};
use super::pass::transfer::{self, TransferKey};
use super::plan::Plan;
use super::shader;

/// Independent of any size and view: shaders and their pipelines.
#[derive(Debug)]
pub(crate) struct Passes {
    depth_downsample: Variants<DepthDownsampleKey>,
    diffuse_bake: Variants<DiffuseBakeKey>,
    accumulate: Variants<AccumulateKey>,
    transfer: Variants<TransferKey>,
    specular_scatter: Variants<SpecularScatterKey>,
    forward: Variants<ForwardKey>,
}

impl Passes {
    /// `cache`: the host's, where the backend has one.
    pub fn new(device: &wgpu::Device, layouts: &Layouts, cache: Option<&wgpu::PipelineCache>) -> Self {
        let frame_and_system = [Some(&layouts.frame), Some(&layouts.system)];
        let material = [Some(&layouts.frame), Some(&layouts.system), Some(&layouts.material)];
        let with = |inputs| [Some(&layouts.frame), Some(&layouts.system), Some(&layouts.material), Some(inputs)];
        let (accumulate, transfer) = (with(&layouts.accumulate), with(&layouts.transfer));
        Self {
            depth_downsample: variants(device, "depth_downsample", &frame_and_system, cache),
            diffuse_bake: variants(device, "diffuse_bake", &material, cache),
            accumulate: variants(device, "accumulate", &accumulate, cache),
            transfer: variants(device, "transfer", &transfer, cache),
            specular_scatter: variants(device, "specular_scatter", &transfer, cache),
            forward: variants(device, "forward", &material, cache),
        }
    }

    /// Pipelines compiled so far.
    pub fn pipeline_count(&self) -> usize {
        self.depth_downsample.len()
            + self.diffuse_bake.len()
            + self.accumulate.len()
            + self.transfer.len()
            + self.specular_scatter.len()
            + self.forward.len()
    }

    /// Compiles what a plan draws with.
    pub fn compile(&self, device: &wgpu::Device, plan: &Plan<'_>) {
        match plan {
            Plan::Nothing => {}
            Plan::Forward(plan) => drop(self.forward(device, plan.key)),
            Plan::Deferred(plan) => {
                for key in plan.depth_downsample.into_iter().chain(plan.depth_copy) {
                    self.depth_downsample(device, key);
                }
                plan.diffuse_bake.map(|key| self.diffuse_bake(device, key));
                for key in std::iter::once(plan.accumulate).chain(plan.overdraw) {
                    self.accumulate(device, key);
                }
                for key in plan.transfers() {
                    self.transfer(device, key);
                }
                plan.specular_scatter.map(|key| self.specular_scatter(device, key));
            }
        }
    }

    pub fn depth_downsample(&self, device: &wgpu::Device, key: DepthDownsampleKey) -> wgpu::RenderPipeline {
        self.depth_downsample.get(device, key, || depth_downsample::describe(key))
    }

    pub fn diffuse_bake(&self, device: &wgpu::Device, key: DiffuseBakeKey) -> wgpu::RenderPipeline {
        self.diffuse_bake.get(device, key, || diffuse_bake::describe(key))
    }

    pub fn accumulate(&self, device: &wgpu::Device, key: AccumulateKey) -> wgpu::RenderPipeline {
        self.accumulate.get(device, key, || accumulate::describe(key))
    }

    pub fn transfer(&self, device: &wgpu::Device, key: TransferKey) -> wgpu::RenderPipeline {
        self.transfer.get(device, key, || transfer::describe(key))
    }

    pub fn specular_scatter(&self, device: &wgpu::Device, key: SpecularScatterKey) -> wgpu::RenderPipeline {
        self.specular_scatter.get(device, key, || specular_scatter::describe(key))
    }

    pub fn forward(&self, device: &wgpu::Device, key: ForwardKey) -> wgpu::RenderPipeline {
        self.forward.get(device, key, || forward::describe(key))
    }
}

fn variants<K: Copy + Eq + std::hash::Hash>(
    device: &wgpu::Device,
    name: &'static str,
    groups: &[Option<&wgpu::BindGroupLayout>],
    cache: Option<&wgpu::PipelineCache>,
) -> Variants<K> {
    // The sources are embedded and a test composes every one, so neither can fail; an empty module would be reported by
    // the device like any other invalid shader.
    let source = shader::source(&format!("{name}.wgsl")).and_then(|text| shader::compose(text).ok());
    Variants::new(device, name, source.unwrap_or_default(), groups, cache)
}
