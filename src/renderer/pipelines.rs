//! Shaders of all passes, and their pipelines.

use std::cell::RefCell;
use std::collections::HashMap;

use haze_core::error::PrepareError;

use super::gpu::capabilities::tiles_are_supported;
use super::gpu::host_pass::HostPass;
use super::gpu::pipeline::{PipelineStore, Shader};
use super::layouts::Layouts;
use super::pass::TexelPipelineSet;
use super::pass::accumulate::AccumulateKey;
use super::pass::depth_resolve::DepthResolveKey;
use super::pass::diffuse_bake::DiffuseBakeKey;
use super::pass::forward::ForwardKey;
use super::pass::shadow_march_slice::MarchTo;
use super::pass::shadow_visibility_slice::ShadowVisibilitySliceKey;
use super::pass::specular_scatter::SpecularScatterKey;
use super::pass::transfer::TransferKey;
use super::pass::transfer_lit::TransferLitKey;
use super::pipeline_variants::pipeline_set;
use super::plan::Plan;
use super::tiled::TiledPipelines;

pipeline_set! {
    /// Passes that draw, but for those over texels.
    pub(crate) DrawnPipelines {
        depth_resolve: DepthResolveKey,
        diffuse_bake: DiffuseBakeKey,
        accumulate: AccumulateKey,
        transfer: TransferKey,
        transfer_lit: TransferLitKey,
        specular_scatter: SpecularScatterKey,
        forward: ForwardKey,
        screen_shadow: HostPass,
        shadow_march_slice: MarchTo,
        shadow_visibility_slice: ShadowVisibilitySliceKey,
    }
}

/// Shaders and pipelines of all passes, independent of size and view.
#[derive(Debug)]
pub(crate) struct Pipelines {
    pub drawn: DrawnPipelines,
    pub texels: TexelPipelineSet,
    /// `None` if the device does not support the path `tiled`.
    pub tiled: Option<TiledPipelines>,
    pub store: PipelineStore,
    /// Shaders by the names of their passes.
    pub shaders: HashMap<&'static str, Shader>,
}

impl Pipelines {
    /// Composes the shaders and creates pipeline layouts. `shader` returns the shader of a pass by name.
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
        let computes = tiles_are_supported(&store.device);
        let drawn = DrawnPipelines::new(store, layouts, shader)?;
        let texels = TexelPipelineSet::new(store, layouts, computes, shader)?;
        let tiled = if computes { Some(TiledPipelines::new(store, layouts, shader)?) } else { None };
        Ok(Self { drawn, texels, tiled, store: store.clone(), shaders: created.into_inner() })
    }

    /// Shares the pipelines of another context of the device that have the same module.
    pub fn share(&mut self, other: &Self) {
        self.drawn.share(&other.drawn);
        self.texels.share(&other.texels);
        if let (Some(tiled), Some(other)) = (&mut self.tiled, &other.tiled) {
            tiled.share(other);
        }
    }

    /// Compiles the pipelines of a plan, or returns the shader error.
    pub fn compile(&self, plan: &Plan<'_>) -> Result<(), PrepareError> {
        self.tiled.as_ref().map_or(Ok(()), TiledPipelines::compile_measure)?;
        if plan.receives_shadow() {
            self.tiled.as_ref().map_or_else(|| self.compile_shadow_slices(), TiledPipelines::compile_shadow)?;
        }
        let drawn = &self.drawn;
        match plan {
            Plan::Skip => Ok(()),
            Plan::Forward(plan) => {
                self.compile_depth_sort()?;
                drawn.forward.check(plan.key)
            }
            Plan::Deferred(plan) => {
                self.texels.check(&plan.texels)?;
                plan.diffuse_bake.map_or(Ok(()), |key| drawn.diffuse_bake.check(key))?;
                match (plan.tiled, &self.tiled) {
                    (Some(keys), Some(tiled)) => tiled.compile(keys)?,
                    _ => {
                        self.compile_depth_sort()?;
                        drawn.accumulate.check(plan.accumulate)?;
                    }
                }
                plan.overdraw.map_or(Ok(()), |key| drawn.accumulate.check(key))?;
                plan.transfers().try_for_each(|key| drawn.transfer.check(key))?;
                let mut lit = plan.lit_transfers().flat_map(|(_, keys)| keys).flatten();
                lit.try_for_each(|key| drawn.transfer_lit.check(key))?;
                plan.specular_scatter.map_or(Ok(()), |key| drawn.specular_scatter.check(key))
            }
        }
    }

    /// Compiles the shadow of devices without compute shaders.
    pub fn compile_shadow_slices(&self) -> Result<(), PrepareError> {
        self.drawn.shadow_march_slice.check(MarchTo::Lights)?;
        self.drawn.shadow_march_slice.check(MarchTo::Sky)?;
        self.drawn.shadow_visibility_slice.check(ShadowVisibilitySliceKey)
    }

    /// Compiles the sort of a host's particles, which is needed if they arrive unsorted.
    fn compile_depth_sort(&self) -> Result<(), PrepareError> {
        self.tiled.as_ref().map_or(Ok(()), TiledPipelines::compile_depth_sort)
    }
}
