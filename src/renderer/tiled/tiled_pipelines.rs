//! Layouts, shaders and pipelines of the tiled passes.

use std::sync::atomic::{AtomicBool, Ordering};

use super::accumulate_variants::AccumulateVariants;
use crate::error::Error;
use crate::formula::uniforms::{
    EmitterUniform, MeasureUniform, ShadowMarchUniform, ShadowVisibilityUniform, SplatUniform, TilesUniform,
};
use crate::renderer::gpu::pipeline::{
    ComputePipelineDescription, PipelineStore, PipelineVariants, Shader, pipeline_variants,
};
use crate::renderer::layouts::{Layouts, SHADOW_FORMAT, texture_type, transfer_types};
use crate::renderer::pass::density_splat;
use crate::renderer::pass::depth_downsample::{self, DepthDownsampleKey};
use crate::renderer::pass::depth_slopes::{self, DepthSlopesKey};
use crate::renderer::pass::depth_sort::{self, DepthSortKey};
use crate::renderer::pass::emit;
use crate::renderer::pass::light_target::{self, LightingKey};
use crate::renderer::pass::measure::{self, MeasureKey};
use crate::renderer::pass::shadow_march::{self, ShadowMarchKey};
use crate::renderer::pass::shadow_visibility;
use crate::renderer::pass::sort::{self, SortKey};
use crate::renderer::pass::tile_accumulate::{TileAccumulateKey, Traversal};
use crate::renderer::pass::tile_bin::{self, TileBinKey};
use crate::renderer::pass::tile_gather::{self, TileGatherKey};
use crate::renderer::pass::tile_project::{self, TileProjectKey};
use crate::renderer::pass::tile_refine::{self, TileRefineKey};
use crate::renderer::pass::upsample_lit::{self, UpsampleLitKey};
use crate::renderer::targets::{CELLS_FORMAT, COMPUTED_DEPTH_FORMAT, GLOWS_FORMAT, LIT_FORMAT};

/// Layouts, shaders and pipelines of the tiled passes. Only devices that support them have this.
#[derive(Debug)]
pub(crate) struct TiledPipelines {
    pub layouts: TiledLayouts,
    /// True for cooperative traversal, false for per-invocation traversal; false at first on CPUs only.
    cooperative: AtomicBool,
    /// Queried once, because every query copies all limits.
    pub limits: wgpu::Limits,
    /// Evaluates emitters.
    pub emit: PipelineVariants<(), ComputePipelineDescription>,
    pub measure: PipelineVariants<MeasureKey, ComputePipelineDescription>,
    pub depth_sort: PipelineVariants<DepthSortKey, ComputePipelineDescription>,
    pub density_splat: PipelineVariants<(), ComputePipelineDescription>,
    pub shadow_march: PipelineVariants<ShadowMarchKey, ComputePipelineDescription>,
    pub shadow_visibility: PipelineVariants<(), ComputePipelineDescription>,
    // Variants of the passes that write every texel of a target.
    pub depth_downsample: PipelineVariants<DepthDownsampleKey, ComputePipelineDescription>,
    pub light_target: PipelineVariants<LightingKey, ComputePipelineDescription>,
    pub depth_slopes: PipelineVariants<DepthSlopesKey, ComputePipelineDescription>,
    pub upsample_lit: PipelineVariants<UpsampleLitKey, ComputePipelineDescription>,
    project: PipelineVariants<TileProjectKey, ComputePipelineDescription>,
    sort: PipelineVariants<SortKey, ComputePipelineDescription>,
    gather: PipelineVariants<TileGatherKey, ComputePipelineDescription>,
    bin: PipelineVariants<TileBinKey, ComputePipelineDescription>,
    refine: PipelineVariants<TileRefineKey, ComputePipelineDescription>,
    pub accumulate: AccumulateVariants,
}

/// Bind group layouts of the tiled passes.
#[derive(Debug)]
pub(crate) struct TiledLayouts {
    pub emit: wgpu::BindGroupLayout,
    pub measure: wgpu::BindGroupLayout,
    pub depth_sort: wgpu::BindGroupLayout,
    pub density_splat: wgpu::BindGroupLayout,
    pub shadow_march: wgpu::BindGroupLayout,
    pub shadow_visibility: wgpu::BindGroupLayout,
    /// Of the passes that write every texel: as the render pass's group 3, with the target as last binding.
    pub depth_downsample: wgpu::BindGroupLayout,
    pub light_target: wgpu::BindGroupLayout,
    pub depth_slopes: wgpu::BindGroupLayout,
    pub upsample_lit: wgpu::BindGroupLayout,
    pub project: wgpu::BindGroupLayout,
    pub sort: wgpu::BindGroupLayout,
    pub gather: wgpu::BindGroupLayout,
    pub bin: wgpu::BindGroupLayout,
    pub refine: wgpu::BindGroupLayout,
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
        let own = TiledLayouts::new(device);
        let with = |inputs| [Some(&layouts.frame), Some(&layouts.system), Some(&layouts.material), Some(inputs)];
        let texels = |inputs| [Some(&layouts.frame), Some(&layouts.system), Some(&layouts.lighting), Some(inputs)];
        Ok(Self {
            cooperative: AtomicBool::new(device.adapter_info().device_type != wgpu::DeviceType::Cpu),
            limits: device.limits(),
            emit: pipeline_variants!(store, shader, emit, &[Some(&own.emit)]),
            measure: pipeline_variants!(store, shader, measure, &with(&own.measure)),
            depth_sort: pipeline_variants!(store, shader, depth_sort, &with(&own.depth_sort)),
            density_splat: pipeline_variants!(store, shader, density_splat, &with(&own.density_splat)),
            shadow_march: pipeline_variants!(store, shader, shadow_march, &[Some(&own.shadow_march)]),
            shadow_visibility: pipeline_variants!(store, shader, shadow_visibility, &[Some(&own.shadow_visibility)]),
            depth_downsample: PipelineVariants::new(
                store,
                "depth_downsample",
                shader("depth_downsample")?,
                depth_downsample::describe_compute,
                &texels(&own.depth_downsample),
            ),
            light_target: PipelineVariants::new(
                store,
                "light_target",
                shader("light_target")?,
                light_target::describe_compute,
                &texels(&own.light_target),
            ),
            depth_slopes: PipelineVariants::new(
                store,
                "depth_slopes",
                shader("depth_slopes")?,
                depth_slopes::describe_compute,
                &texels(&own.depth_slopes),
            ),
            upsample_lit: pipeline_variants!(store, shader, upsample_lit, &texels(&own.upsample_lit)),
            project: pipeline_variants!(store, shader, tile_project, &with(&own.project)),
            sort: pipeline_variants!(store, shader, sort, &[Some(&own.sort)]),
            gather: pipeline_variants!(store, shader, tile_gather, &[Some(&own.gather)]),
            bin: pipeline_variants!(store, shader, tile_bin, &[Some(&own.bin)]),
            refine: pipeline_variants!(store, shader, tile_refine, &with(&own.refine)),
            accumulate: AccumulateVariants::new(store, layouts, shader("tile_accumulate")?),
            layouts: own,
        })
    }

    /// Shares the pipelines of another context of the device that have the same module.
    pub fn share(&mut self, other: &Self) {
        self.emit.share(&other.emit);
        self.measure.share(&other.measure);
        self.depth_sort.share(&other.depth_sort);
        self.density_splat.share(&other.density_splat);
        self.shadow_march.share(&other.shadow_march);
        self.shadow_visibility.share(&other.shadow_visibility);
        self.depth_downsample.share(&other.depth_downsample);
        self.light_target.share(&other.light_target);
        self.depth_slopes.share(&other.depth_slopes);
        self.upsample_lit.share(&other.upsample_lit);
        self.project.share(&other.project);
        self.sort.share(&other.sort);
        self.gather.share(&other.gather);
        self.bin.share(&other.bin);
        self.refine.share(&other.refine);
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
    pub fn compile(&self, keys: TiledKeys) -> Result<(), Error> {
        self.emit.check(())?;
        self.project.check(keys.project)?;
        self.compile_sort()?;
        for either in [true, false] {
            self.gather.check(TileGatherKey { sorted: either })?;
            tile_bin::keys(keys.accumulate.is_cooperative(), either).try_for_each(|key| self.bin.check(key))?;
        }
        keys.refine().into_iter().try_for_each(|key| self.refine.check(key))?;
        // The size of the target decides which one is used.
        let of_gpus = Traversal::COOPERATIVE;
        let traversals = if keys.accumulate.is_cooperative() { &of_gpus[..] } else { &[Traversal::PerInvocation] };
        for &traversal in traversals {
            self.accumulate.check(TileAccumulateKey { traversal, ..keys.accumulate })?;
        }
        Ok(())
    }

    /// Compiles the pipelines that measure a host's particles.
    pub fn compile_measure(&self) -> Result<(), Error> {
        MeasureKey::ALL.into_iter().try_for_each(|key| self.measure.check(key))
    }

    /// Compiles the pipelines of shadow.
    pub fn compile_shadow(&self) -> Result<(), Error> {
        self.density_splat.check(())?;
        ShadowMarchKey::ALL.into_iter().try_for_each(|key| self.shadow_march.check(key))?;
        self.shadow_visibility.check(())
    }

    /// Compiles the pipelines that sort a host's particles back to front.
    pub fn compile_depth_sort(&self) -> Result<(), Error> {
        self.depth_sort.check(DepthSortKey::DepthKeys)?;
        self.depth_sort.check(DepthSortKey::GatherParticles)?;
        self.compile_sort()
    }

    fn compile_sort(&self) -> Result<(), Error> {
        sort::all_keys(self.cooperative()).try_for_each(|key| self.sort.check(key))
    }

    /// Returns the pipelines that sort `count` keys.
    pub fn sort(&self, count: u32) -> SortPipelines {
        let mut keys = sort::keys(self.cooperative(), count).map(|key| (key, self.sort.get(key)));
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
        let mut bin = bin_keys.map(|key| (key, self.bin.get(key)));
        SystemPipelines {
            project: self.project.get(keys.project),
            sort: sorts.then(|| self.sort(count)),
            gather: self.gather.get(TileGatherKey { sorted: sorts }),
            bin: std::array::from_fn(|_| bin.next()),
            refine: keys.refine().map(|key| self.refine.get(key)),
            accumulate: self.accumulate.pipeline(keys.accumulate),
        }
    }
}

impl TiledLayouts {
    fn new(device: &wgpu::Device) -> Self {
        let buffer = |ty| wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
        let uniform_of = |size: usize| wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: false,
            min_binding_size: wgpu::BufferSize::new(size as u64),
        };
        let uniform = uniform_of(size_of::<TilesUniform>());
        let (read, written) = (
            buffer(wgpu::BufferBindingType::Storage { read_only: true }),
            buffer(wgpu::BufferBindingType::Storage { read_only: false }),
        );
        let unfilterable = wgpu::TextureSampleType::Float { filterable: false };
        let depth = texture_type(unfilterable, wgpu::TextureViewDimension::D2);
        let map = texture_type(unfilterable, wgpu::TextureViewDimension::D2Array);
        let target = |format, view_dimension| wgpu::BindingType::StorageTexture {
            access: wgpu::StorageTextureAccess::WriteOnly,
            format,
            view_dimension,
        };
        let filterable = wgpu::TextureSampleType::Float { filterable: true };
        let density = texture_type(filterable, wgpu::TextureViewDimension::D3);
        let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
        let volume = target(SHADOW_FORMAT, wgpu::TextureViewDimension::D3);
        let flat = |format| target(format, wgpu::TextureViewDimension::D2);
        let lit = flat(LIT_FORMAT);
        let upsampled = texture_type(filterable, wgpu::TextureViewDimension::D2);
        let layout = |label, types: &[wgpu::BindingType]| {
            let entry = |(binding, &ty)| wgpu::BindGroupLayoutEntry {
                binding,
                visibility: wgpu::ShaderStages::COMPUTE,
                ty,
                count: None,
            };
            let entries: Vec<_> = (0..).zip(types).map(entry).collect();
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
        };
        Self {
            emit: layout("haze emit inputs", &[uniform_of(size_of::<EmitterUniform>()), written]),
            measure: layout("haze measure inputs", &[uniform_of(size_of::<MeasureUniform>()), read, written, written]),
            depth_sort: layout("haze depth_sort inputs", &[uniform, read, written, written, written]),
            density_splat: layout("haze density_splat inputs", &[uniform_of(size_of::<SplatUniform>()), read, written]),
            shadow_march: layout(
                "haze shadow_march inputs",
                &[uniform_of(size_of::<ShadowMarchUniform>()), read, volume, density, sampler],
            ),
            shadow_visibility: layout(
                "haze shadow_visibility inputs",
                &[uniform_of(size_of::<ShadowVisibilityUniform>()), map, map, map, volume],
            ),
            depth_downsample: layout("haze depth_downsample target", &[flat(COMPUTED_DEPTH_FORMAT)]),
            light_target: layout(
                "haze light_target inputs",
                &[transfer_types().as_slice(), &[lit, flat(CELLS_FORMAT), flat(GLOWS_FORMAT)]].concat(),
            ),
            depth_slopes: layout("haze depth_slopes inputs", &[depth, depth, lit, flat(CELLS_FORMAT)]),
            upsample_lit: layout("haze upsample_lit inputs", &[upsampled, depth, upsampled, depth, depth, depth, lit]),
            project: layout("haze tile_project inputs", &[uniform, read, written, written, written, written, written]),
            sort: layout("haze sort inputs", &[uniform, read, read, written, written, written, written]),
            gather: layout("haze tile_gather inputs", &[uniform, read, read, read, written, written, written]),
            bin: layout("haze tile_bin inputs", &[uniform, read, read, written, written, written, written]),
            refine: layout("haze tile_refine inputs", &[uniform, read, read, read, depth, written]),
        }
    }
}
