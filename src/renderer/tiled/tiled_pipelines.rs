//! Shaders and pipelines of the tiled passes.

use std::sync::atomic::{AtomicBool, Ordering};

use haze_core::error::PrepareError;

use super::accumulate_variants::AccumulateVariants;
use crate::renderer::gpu::pipeline::{PipelineStore, Shader};
use crate::renderer::layouts::Layouts;
use crate::renderer::pass::density_splat::DensitySplatKey;
use crate::renderer::pass::depth_sort::DepthSortKey;
use crate::renderer::pass::emit::EmitKey;
use crate::renderer::pass::measure::MeasureKey;
use crate::renderer::pass::shadow_march::ShadowMarchKey;
use crate::renderer::pass::shadow_visibility::ShadowVisibilityKey;
use crate::renderer::pass::sort::{self, SortKey};
use crate::renderer::pass::tile_accumulate::{TileAccumulateKey, TraversalMode};
use crate::renderer::pass::tile_bin::{self, TileBinKey};
use crate::renderer::pass::tile_gather::TileGatherKey;
use crate::renderer::pass::tile_project::TileProjectKey;
use crate::renderer::pass::tile_refine::TileRefineKey;
use crate::renderer::pipeline_variants::pipeline_set;

pipeline_set! {
    /// Compute passes, but for those over texels and for tile_accumulate.
    pub(crate) ComputePipelines {
        emit: EmitKey,
        measure: MeasureKey,
        depth_sort: DepthSortKey,
        density_splat: DensitySplatKey,
        shadow_march: ShadowMarchKey,
        shadow_visibility: ShadowVisibilityKey,
        project: TileProjectKey,
        sort: SortKey,
        gather: TileGatherKey,
        bin: TileBinKey,
        refine: TileRefineKey,
    }
}

/// Shaders and pipelines of compute passes. Only devices that support them have this.
#[derive(Debug)]
pub(crate) struct TiledPipelines {
    /// True for cooperative traversal, false for per-invocation traversal; false at first on CPUs only.
    cooperative: AtomicBool,
    /// Queried once, because every query copies all limits.
    pub limits: wgpu::Limits,
    pub passes: ComputePipelines,
    pub accumulate: AccumulateVariants,
}

/// Pipeline keys of a system's tiled passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TiledKeys {
    pub project: TileProjectKey,
    pub accumulate: TileAccumulateKey,
}

impl TiledKeys {
    /// Returns the key of tile_refine. `None` for cooperative traversal, in which each workgroup filters its bin's list
    /// itself.
    fn refine(&self) -> Option<TileRefineKey> {
        let TileAccumulateKey { sprite, host_depth, stops, .. } = self.accumulate;
        (!self.accumulate.is_cooperative()).then_some(TileRefineKey { sprite, host_depth, stops })
    }
}

/// Pipelines in the order of [`sort::keys`]. An array, so that a frame allocates nothing for it.
type SortPipelines = [Option<(SortKey, wgpu::ComputePipeline)>; sort::MAX_PIPELINES];

/// Pipelines of one system.
pub(crate) struct SystemPipelines {
    pub project: wgpu::ComputePipeline,
    pub sort: Option<SortPipelines>,
    pub gather: wgpu::ComputePipeline,
    pub bin: [Option<(TileBinKey, wgpu::ComputePipeline)>; tile_bin::MAX_PIPELINES],
    /// Present for per-invocation traversal.
    pub refine: Option<wgpu::ComputePipeline>,
    pub accumulate: wgpu::ComputePipeline,
}

impl TiledPipelines {
    /// Creates layouts and shader modules. `shader` returns the shader of a pass by name.
    pub fn new<E>(
        store: &PipelineStore,
        layouts: &Layouts,
        shader: impl Fn(&'static str) -> Result<Shader, E>,
    ) -> Result<Self, E> {
        let device = &store.device;
        Ok(Self {
            cooperative: AtomicBool::new(device.adapter_info().device_type != wgpu::DeviceType::Cpu),
            limits: device.limits(),
            accumulate: AccumulateVariants::new(store, layouts, shader("tile_accumulate")?),
            passes: ComputePipelines::new(store, layouts, shader)?,
        })
    }

    /// Shares the pipelines of another context of the device that have the same module.
    pub fn share(&mut self, other: &Self) {
        self.passes.share(&other.passes);
        self.accumulate.share(&other.accumulate);
    }

    /// Returns true for cooperative traversal, false for per-invocation traversal.
    pub fn cooperative(&self) -> bool {
        self.cooperative.load(Ordering::Relaxed)
    }

    pub fn set_cooperative(&self, cooperative: bool) {
        self.cooperative.store(cooperative, Ordering::Relaxed);
    }

    /// Compiles the pipelines for these keys, or returns the shader error.
    pub fn compile(&self, keys: TiledKeys) -> Result<(), PrepareError> {
        self.passes.emit.check(EmitKey)?;
        self.passes.project.check(keys.project)?;
        self.compile_sort()?;
        for either in [true, false] {
            self.passes.gather.check(TileGatherKey { sorted: either })?;
            tile_bin::keys(keys.accumulate.is_cooperative(), either).try_for_each(|key| self.passes.bin.check(key))?;
        }
        keys.refine().into_iter().try_for_each(|key| self.passes.refine.check(key))?;
        // The size of the target decides which one is used.
        let of_gpus = TraversalMode::COOPERATIVE;
        let traversals = if keys.accumulate.is_cooperative() { &of_gpus[..] } else { &[TraversalMode::PerInvocation] };
        for &traversal in traversals {
            self.accumulate.check(TileAccumulateKey { traversal, ..keys.accumulate })?;
        }
        Ok(())
    }

    /// Compiles the pipelines that measure a host's particles.
    pub fn compile_measure(&self) -> Result<(), PrepareError> {
        MeasureKey::ALL.into_iter().try_for_each(|key| self.passes.measure.check(key))
    }

    /// Compiles the pipelines of shadow.
    pub fn compile_shadow(&self) -> Result<(), PrepareError> {
        self.passes.density_splat.check(DensitySplatKey)?;
        ShadowMarchKey::ALL.into_iter().try_for_each(|key| self.passes.shadow_march.check(key))?;
        self.passes.shadow_visibility.check(ShadowVisibilityKey)
    }

    /// Compiles the pipelines that sort a host's particles back to front.
    pub fn compile_depth_sort(&self) -> Result<(), PrepareError> {
        self.passes.depth_sort.check(DepthSortKey::DepthKeys)?;
        self.passes.depth_sort.check(DepthSortKey::GatherParticles)?;
        self.compile_sort()
    }

    fn compile_sort(&self) -> Result<(), PrepareError> {
        sort::all_keys(self.cooperative()).try_for_each(|key| self.passes.sort.check(key))
    }

    /// Returns the pipelines that sort `count` keys.
    pub fn sort(&self, count: u32) -> SortPipelines {
        let mut keys = sort::keys(self.cooperative(), count).map(|key| (key, self.passes.sort.get(key)));
        std::array::from_fn(|_| keys.next())
    }

    /// Returns the pair of buffers in which that sort expects its keys.
    pub fn unsorted_pair(&self, count: u32) -> usize {
        sort::unsorted_pair(self.cooperative(), count)
    }

    /// Returns the pipelines of a system with `count` sprites. `sorts`: true if the sprites are unsorted and their
    /// order matters.
    pub fn pipelines(&self, keys: TiledKeys, sorts: bool, count: u32) -> SystemPipelines {
        let bin_keys = tile_bin::keys(keys.accumulate.is_cooperative(), count <= tile_bin::MAX_SPRITES_SINGLE_DISPATCH);
        let mut bin = bin_keys.map(|key| (key, self.passes.bin.get(key)));
        SystemPipelines {
            project: self.passes.project.get(keys.project),
            sort: sorts.then(|| self.sort(count)),
            gather: self.passes.gather.get(TileGatherKey { sorted: sorts }),
            bin: std::array::from_fn(|_| bin.next()),
            refine: keys.refine().map(|key| self.passes.refine.get(key)),
            accumulate: self.accumulate.pipeline(keys.accumulate),
        }
    }
}
