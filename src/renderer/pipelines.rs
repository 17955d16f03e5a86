//! Shaders of all passes, and their pipelines.

use std::cell::RefCell;
use std::collections::HashMap;

use super::gpu::capabilities::tiles_are_supported;
use super::gpu::host_pass::HostPass;
use super::gpu::pipeline::{PipelineStore, PipelineVariants, Shader, pipeline_variants};
use super::layouts::Layouts;
use super::pass::accumulate::{self, AccumulateKey};
use super::pass::depth_downsample::{self, DepthDownsampleKey};
use super::pass::depth_resolve::{self, DepthResolveKey};
use super::pass::depth_slopes::{self, DepthSlopesKey};
use super::pass::diffuse_bake::{self, DiffuseBakeKey};
use super::pass::forward::{self, ForwardKey};
use super::pass::light_target::{self, LightingKey};
use super::pass::mark_cells::{self, MarkCellsKey};
use super::pass::screen_shadow;
use super::pass::shadow_march_slice::{self, MarchTo};
use super::pass::shadow_visibility_slice;
use super::pass::specular_scatter::{self, SpecularScatterKey};
use super::pass::transfer::{self, TransferKey};
use super::pass::transfer_lit::{self, TransferLitKey};
use super::plan::Plan;
use super::tiled::TiledPipelines;
use crate::error::Error;

/// Shaders and pipelines of all passes, independent of size and view.
#[derive(Debug)]
pub(crate) struct Pipelines {
    pub depth_downsample: PipelineVariants<DepthDownsampleKey>,
    pub depth_resolve: PipelineVariants<DepthResolveKey>,
    pub diffuse_bake: PipelineVariants<DiffuseBakeKey>,
    pub accumulate: PipelineVariants<AccumulateKey>,
    pub light_target: PipelineVariants<LightingKey>,
    pub depth_slopes: PipelineVariants<DepthSlopesKey>,
    pub mark_cells: PipelineVariants<MarkCellsKey>,
    pub transfer: PipelineVariants<TransferKey>,
    pub transfer_lit: PipelineVariants<TransferLitKey>,
    pub specular_scatter: PipelineVariants<SpecularScatterKey>,
    pub forward: PipelineVariants<ForwardKey>,
    pub screen_shadow: PipelineVariants<HostPass>,
    pub shadow_march_slice: PipelineVariants<MarchTo>,
    pub shadow_visibility_slice: PipelineVariants<()>,
    pub store: PipelineStore,
    /// `None` if the device does not support the path `tiled`.
    pub tiled: Option<TiledPipelines>,
    /// Shaders by the names of their passes.
    pub shaders: HashMap<&'static str, Shader>,
}

impl Pipelines {
    /// Creates the shader modules and pipeline layouts. `shader` returns the shader of a pass by name.
    pub fn new<E>(
        store: &PipelineStore,
        layouts: &Layouts,
        shader: impl Fn(&'static str) -> Result<Shader, E>,
    ) -> Result<Self, E> {
        // Some shaders have variants for drawing and for computing.
        let created = RefCell::new(HashMap::new());
        let shader = |name| {
            if let Some(shader) = created.borrow().get(name) {
                return Ok(Shader::clone(shader));
            }
            let shader = shader(name)?;
            created.borrow_mut().insert(name, shader.clone());
            Ok(shader)
        };
        let frame_and_system = [Some(&layouts.frame), Some(&layouts.system)];
        let material = [Some(&layouts.frame), Some(&layouts.system), Some(&layouts.material)];
        let with = |material, inputs| [Some(&layouts.frame), Some(&layouts.system), Some(material), Some(inputs)];
        let accumulate = with(&layouts.material, &layouts.accumulate);
        let transfer = with(&layouts.lighting, &layouts.transfer);
        let lit = with(&layouts.lighting, &layouts.lit);
        let screen_shadow =
            [&layouts.shadow_maps, &layouts.frame, &layouts.screen_shadow, &layouts.scene_shadow].map(Some);
        let (march_slice, visibility_slice) = ([Some(&layouts.shadow_march_slice)], [Some(&layouts.shadow_maps)]);
        let mut pipelines = Self {
            depth_downsample: pipeline_variants!(store, shader, depth_downsample, &frame_and_system),
            depth_resolve: pipeline_variants!(store, shader, depth_resolve, &[Some(&layouts.depth_resolve)]),
            diffuse_bake: pipeline_variants!(store, shader, diffuse_bake, &material),
            accumulate: pipeline_variants!(store, shader, accumulate, &accumulate),
            light_target: pipeline_variants!(store, shader, light_target, &transfer),
            depth_slopes: pipeline_variants!(store, shader, depth_slopes, &lit),
            mark_cells: pipeline_variants!(store, shader, mark_cells, &lit),
            transfer: pipeline_variants!(store, shader, transfer, &transfer),
            transfer_lit: pipeline_variants!(store, shader, transfer_lit, &lit),
            specular_scatter: pipeline_variants!(store, shader, specular_scatter, &lit),
            forward: pipeline_variants!(store, shader, forward, &material),
            screen_shadow: pipeline_variants!(store, shader, screen_shadow, &screen_shadow),
            shadow_march_slice: pipeline_variants!(store, shader, shadow_march_slice, &march_slice),
            shadow_visibility_slice: pipeline_variants!(store, shader, shadow_visibility_slice, &visibility_slice),
            store: store.clone(),
            tiled: match tiles_are_supported(&store.device) {
                true => Some(TiledPipelines::new(store, layouts, shader)?),
                false => None,
            },
            shaders: HashMap::new(),
        };
        pipelines.shaders = created.into_inner();
        Ok(pipelines)
    }

    /// Shares the pipelines of another context of the device that have the same module.
    pub fn share(&mut self, other: &Self) {
        self.depth_downsample.share(&other.depth_downsample);
        self.depth_resolve.share(&other.depth_resolve);
        self.diffuse_bake.share(&other.diffuse_bake);
        self.accumulate.share(&other.accumulate);
        self.light_target.share(&other.light_target);
        self.depth_slopes.share(&other.depth_slopes);
        self.mark_cells.share(&other.mark_cells);
        self.transfer.share(&other.transfer);
        self.transfer_lit.share(&other.transfer_lit);
        self.specular_scatter.share(&other.specular_scatter);
        self.forward.share(&other.forward);
        self.screen_shadow.share(&other.screen_shadow);
        self.shadow_march_slice.share(&other.shadow_march_slice);
        self.shadow_visibility_slice.share(&other.shadow_visibility_slice);
        if let (Some(tiled), Some(other)) = (&mut self.tiled, &other.tiled) {
            tiled.share(other);
        }
    }

    /// Compiles the pipelines of a plan, or returns the shader error.
    pub fn compile(&self, plan: &Plan<'_>) -> Result<(), Error> {
        self.tiled.as_ref().map_or(Ok(()), TiledPipelines::compile_measure)?;
        if plan.receives_shadow() {
            self.tiled.as_ref().map_or_else(|| self.compile_shadow_slices(), TiledPipelines::compile_shadow)?;
        }
        match plan {
            Plan::Skip => Ok(()),
            Plan::Forward(plan) => {
                self.compile_depth_sort()?;
                self.forward.check(plan.key)
            }
            Plan::Deferred(plan) => {
                match self.tiled.as_ref().filter(|_| plan.computes_depth()) {
                    Some(tiled) => plan.depth_downsample.map_or(Ok(()), |key| tiled.depth_downsample.check(key))?,
                    None => {
                        let mut downsamples = plan.depth_downsample.into_iter().chain(plan.depth_copy);
                        downsamples.try_for_each(|key| self.depth_downsample.check(key))?;
                    }
                }
                plan.diffuse_bake.map_or(Ok(()), |key| self.diffuse_bake.check(key))?;
                match (plan.tiled, &self.tiled) {
                    (Some(keys), Some(tiled)) => tiled.compile(keys)?,
                    _ => {
                        self.compile_depth_sort()?;
                        self.accumulate.check(plan.accumulate)?;
                    }
                }
                plan.overdraw.map_or(Ok(()), |key| self.accumulate.check(key))?;
                match self.tiled.as_ref().filter(|_| plan.computes_texels) {
                    Some(tiled) => {
                        plan.light_target.map_or(Ok(()), |key| tiled.light_target.check(key))?;
                        plan.depth_slopes.map_or(Ok(()), |key| tiled.depth_slopes.check(key))?;
                    }
                    None => {
                        plan.light_target.map_or(Ok(()), |key| self.light_target.check(key))?;
                        plan.depth_slopes.map_or(Ok(()), |key| self.depth_slopes.check(key))?;
                    }
                }
                if let Some((tiled, key)) = self.tiled.as_ref().zip(plan.upsample_lit) {
                    tiled.upsample_lit.check(key)?;
                }
                plan.transfers().try_for_each(|key| self.transfer.check(key))?;
                plan.mark_cells.map_or(Ok(()), |key| self.mark_cells.check(key))?;
                let mut lit = plan.lit_transfers().flat_map(|(_, keys)| keys).flatten();
                lit.try_for_each(|key| self.transfer_lit.check(key))?;
                plan.specular_scatter.map_or(Ok(()), |key| self.specular_scatter.check(key))
            }
        }
    }

    /// Compiles the shadow of devices without compute shaders.
    pub fn compile_shadow_slices(&self) -> Result<(), Error> {
        self.shadow_march_slice.check(MarchTo::Lights)?;
        self.shadow_march_slice.check(MarchTo::Sky)?;
        self.shadow_visibility_slice.check(())
    }

    /// Compiles the sort of a host's particles, which is needed if they arrive unsorted.
    fn compile_depth_sort(&self) -> Result<(), Error> {
        self.tiled.as_ref().map_or(Ok(()), TiledPipelines::compile_depth_sort)
    }
}
