//! Shaders of all passes, and their pipelines.

use super::gpu::capabilities::tiles_are_supported;
use super::gpu::pipeline::{PipelineVariants, Shader};
use super::layouts::Layouts;
use super::pass::accumulate::{self, AccumulateKey};
use super::pass::depth_downsample::{self, DepthDownsampleKey};
use super::pass::diffuse_bake::{self, DiffuseBakeKey};
use super::pass::forward::{self, ForwardKey};
use super::pass::light_target::{self, LightingKey};
use super::pass::specular_scatter::{self, SpecularScatterKey};
use super::pass::transfer::{self, TransferKey};
use super::plan::Plan;
use super::tiled::TiledPipelines;
use crate::error::Error;

/// Shaders and pipelines of all passes, independent of size and view.
#[derive(Debug)]
pub(crate) struct Pipelines {
    depth_downsample: PipelineVariants<DepthDownsampleKey>,
    diffuse_bake: PipelineVariants<DiffuseBakeKey>,
    accumulate: PipelineVariants<AccumulateKey>,
    light_target: PipelineVariants<LightingKey>,
    transfer: PipelineVariants<TransferKey>,
    specular_scatter: PipelineVariants<SpecularScatterKey>,
    forward: PipelineVariants<ForwardKey>,
    /// `None` if the device does not support the path `tiled`.
    pub tiled: Option<TiledPipelines>,
}

impl Pipelines {
    /// Creates the shader modules and pipeline layouts. `shader` returns the shader of a pass by name; `cache` is the
    /// host's pipeline cache, if the backend supports one.
    pub fn new<E>(
        device: &wgpu::Device,
        layouts: &Layouts,
        cache: Option<&wgpu::PipelineCache>,
        shader: impl Fn(&'static str) -> Result<Shader, E>,
    ) -> Result<Self, E> {
        let frame_and_system = [Some(&layouts.frame), Some(&layouts.system)];
        let material = [Some(&layouts.frame), Some(&layouts.system), Some(&layouts.material)];
        let with = |material, inputs| [Some(&layouts.frame), Some(&layouts.system), Some(material), Some(inputs)];
        let accumulate = with(&layouts.material, &layouts.accumulate);
        let transfer = with(&layouts.lighting, &layouts.transfer);
        macro_rules! variants {
            ($pass:ident, $groups:expr) => {{
                let name = stringify!($pass);
                PipelineVariants::new(device, name, shader(name)?, $pass::describe, $groups, cache)
            }};
        }
        Ok(Self {
            depth_downsample: variants!(depth_downsample, &frame_and_system),
            diffuse_bake: variants!(diffuse_bake, &material),
            accumulate: variants!(accumulate, &accumulate),
            light_target: variants!(light_target, &transfer),
            transfer: variants!(transfer, &transfer),
            specular_scatter: variants!(specular_scatter, &transfer),
            forward: variants!(forward, &material),
            tiled: match tiles_are_supported(device) {
                true => Some(TiledPipelines::new(device, layouts, cache, &shader)?),
                false => None,
            },
        })
    }

    /// Returns the number of pipelines compiled so far.
    pub fn pipeline_count(&self) -> usize {
        self.depth_downsample.len()
            + self.diffuse_bake.len()
            + self.accumulate.len()
            + self.light_target.len()
            + self.transfer.len()
            + self.specular_scatter.len()
            + self.forward.len()
            + self.tiled.as_ref().map_or(0, TiledPipelines::pipeline_count)
    }

    /// Compiles the pipelines of a plan, or returns the shader error.
    pub fn compile(&self, device: &wgpu::Device, plan: &Plan<'_>) -> Result<(), Error> {
        match plan {
            Plan::Skip => Ok(()),
            Plan::Forward(plan) => {
                self.compile_depth_sort(device)?;
                self.forward.check(device, plan.key)
            }
            Plan::Deferred(plan) => {
                let mut downsamples = plan.depth_downsample.into_iter().chain(plan.depth_copy);
                downsamples.try_for_each(|key| self.depth_downsample.check(device, key))?;
                plan.diffuse_bake.map_or(Ok(()), |key| self.diffuse_bake.check(device, key))?;
                match (plan.tiled, &self.tiled) {
                    (Some(keys), Some(tiled)) => tiled.compile(device, keys)?,
                    _ => {
                        self.compile_depth_sort(device)?;
                        self.accumulate.check(device, plan.accumulate)?;
                    }
                }
                plan.overdraw.map_or(Ok(()), |key| self.accumulate.check(device, key))?;
                plan.light_target.map_or(Ok(()), |key| self.light_target.check(device, key))?;
                plan.transfers().try_for_each(|key| self.transfer.check(device, key))?;
                plan.specular_scatter.map_or(Ok(()), |key| self.specular_scatter.check(device, key))
            }
        }
    }

    /// Compiles the sort of a host's particles, which is needed if they arrive unsorted.
    fn compile_depth_sort(&self, device: &wgpu::Device) -> Result<(), Error> {
        self.tiled.as_ref().map_or(Ok(()), |tiled| tiled.compile_depth_sort(device))
    }

    pub fn depth_downsample(&self, device: &wgpu::Device, key: DepthDownsampleKey) -> wgpu::RenderPipeline {
        self.depth_downsample.get(device, key)
    }

    pub fn diffuse_bake(&self, device: &wgpu::Device, key: DiffuseBakeKey) -> wgpu::RenderPipeline {
        self.diffuse_bake.get(device, key)
    }

    pub fn accumulate(&self, device: &wgpu::Device, key: AccumulateKey) -> wgpu::RenderPipeline {
        self.accumulate.get(device, key)
    }

    pub fn light_target(&self, device: &wgpu::Device, key: LightingKey) -> wgpu::RenderPipeline {
        self.light_target.get(device, key)
    }

    pub fn transfer(&self, device: &wgpu::Device, key: TransferKey) -> wgpu::RenderPipeline {
        self.transfer.get(device, key)
    }

    pub fn specular_scatter(&self, device: &wgpu::Device, key: SpecularScatterKey) -> wgpu::RenderPipeline {
        self.specular_scatter.get(device, key)
    }

    pub fn forward(&self, device: &wgpu::Device, key: ForwardKey) -> wgpu::RenderPipeline {
        self.forward.get(device, key)
    }
}
