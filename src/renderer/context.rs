//! Resources that the renderers of one device share.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use haze_core::assets::material_assets::MaterialAssets;
use haze_core::assets::ramp::Ramp;
use haze_core::error::PrepareError;
use haze_core::glam::{UVec2, Vec3};
use haze_core::view_setup::Support;

use super::auto::PathModel;
use super::gpu::Gpu;
use super::gpu::capabilities::{independent_blend_is_supported, read_only_depth_is_supported, six_way_is_supported};
use super::gpu::host_pass::HostPass;
use super::gpu::pipeline::PipelineStore;
use super::gpu::timing::Timing;
use super::layouts::Layouts;
use super::material_upload::{SharedTextures, create_material, upload_ramp};
use super::pass::depth_resolve::DepthResolveKey;
use super::pipelines::Pipelines;
use super::plan::plans_covering_every_pass;
use super::shader::{Sources, checked_shader, embedded_shader};
use super::tiled::{TiledPipelines, volume};
use crate::frame::Material;

/// Resources that all renderers of one device share: device, queue, shader modules, bind group layouts, samplers and
/// pipelines. A clone refers to the same context. A context can be used from any thread.
///
/// Create one context per device, and one [`Renderer`](crate::Renderer) per view: split screens, stereo, shadow and
/// reflection views share pipelines and materials, and creating a renderer is cheap.
#[derive(Clone, Debug)]
pub struct Context(Arc<Shared>);

#[derive(Debug)]
pub(crate) struct Shared {
    /// Unique in the process.
    pub number: u64,
    /// Number of the first context that was created on the device; [`Context::with_shaders`] keeps it. wgpu compares
    /// devices by an ID that two instances may both assign.
    pub device_number: u64,
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    pub layouts: Layouts,
    pub textures: SharedTextures,
    /// Bound instead of optical depths where no system receives shadow.
    pub no_shadow: wgpu::TextureView,
    /// Bound instead of a shadow ramp where no smoke shades the scene.
    pub no_ramp: wgpu::TextureView,
    pub pipelines: Pipelines,
    /// [`read_only_depth_is_supported`], queried once, because every query copies the adapter's information.
    pub read_only_depth: bool,
    /// Largest extent of a 3D texture, texels.
    pub max_volume_depth: u32,
    /// Capabilities that settings depend on.
    pub support: Support,
    path_model: Mutex<PathModel>,
}

impl Shared {
    /// Returns the traversal of the path `tiled`, as in [`PipelineInputs::tiles`](super::plan::PipelineInputs::tiles).
    pub fn tiles(&self) -> Option<bool> {
        self.pipelines.tiled.as_ref().map(TiledPipelines::cooperative)
    }

    pub fn gpu(&self) -> Gpu<'_> {
        Gpu { device: &self.device, queue: &self.queue }
    }

    pub fn path_model(&self) -> PathModel {
        *self.path_model.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Context {
    /// Creates the layouts. Shader modules and pipelines are compiled by the first `prepare` that needs them, or in advance by
    /// [`Renderer::warm_up`](crate::Renderer::warm_up).
    ///
    /// `queue` must be the queue of `device`. Encoders, passes, textures and buffers that the host passes to haze must
    /// belong to this device; wgpu has no means to check that, and reports or panics on its own. Both come from one
    /// `Adapter::request_device`.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        Self::create(device, queue, None)
    }

    /// As [`Context::new`], with a cache that the host created from saved data, on backends that support it (today Vulkan,
    /// with `Features::PIPELINE_CACHE`). Pipelines are looked up in it and added to it. The host reads its contents with
    /// `get_data` to save them.
    pub fn with_pipeline_cache(device: &wgpu::Device, queue: &wgpu::Queue, cache: &wgpu::PipelineCache) -> Self {
        Self::create(device, queue, Some(cache))
    }

    fn create(device: &wgpu::Device, queue: &wgpu::Queue, pipeline_cache: Option<&wgpu::PipelineCache>) -> Self {
        let layouts = Layouts::new(device);
        let store = PipelineStore::new(device, pipeline_cache);
        let Ok(pipelines) = Pipelines::new(&store, &layouts, embedded_shader);
        Self::assemble(queue, layouts, pipelines, None)
    }

    /// Creates a context of the same device with custom shaders, for shader development. Compiles and validates the
    /// shader modules that differ from this context's, and one pipeline of each of their passes, before it creates the
    /// context. Pipelines of other passes are shared.
    /// [`Renderer::warm_up`](crate::Renderer::warm_up) reports errors that occur only with other settings. After an
    /// error, keep using this context and its renderers. Materials belong to one context and have to be created again.
    ///
    /// wgpu counts the rounds of the loops of changed shaders, so that none runs forever. On an NVIDIA H100,
    /// frames of presets take up to 1.34 times as long as with the embedded ones, whose loops are known to end.
    ///
    /// # Errors
    /// [`PrepareError::Shader`]: the first error, with its line and column in the file that contains it.
    pub fn with_shaders(&self, sources: &Sources) -> Result<Self, PrepareError> {
        let Shared { device, queue, device_number, pipelines, .. } = self.shared();
        let layouts = Layouts::new(device);
        let store = PipelineStore::new(device, pipelines.store.cache.as_ref());
        let known = &pipelines.shaders;
        let mut changed =
            Pipelines::new(&store, &layouts, |name| checked_shader(device, name, sources, known.get(name)))?;
        changed.share(pipelines);
        let context = Self::assemble(queue, layouts, changed, Some(*device_number));
        let shared = context.shared();
        plans_covering_every_pass(shared.read_only_depth, shared.tiles())
            .iter()
            .try_for_each(|plan| shared.pipelines.compile(plan))?;
        shared.pipelines.compile_shadow_slices()?;
        shared.pipelines.drawn.screen_shadow.check(HostPass::color_only(wgpu::TextureFormat::Rgba16Float))?;
        // OpenGL cannot read multisampled depth.
        if shared.read_only_depth {
            shared.pipelines.drawn.depth_resolve.check(DepthResolveKey { reversed: false })?;
        }
        Ok(context)
    }

    /// `device_number`: that of an earlier context of the device.
    fn assemble(queue: &wgpu::Queue, layouts: Layouts, pipelines: Pipelines, device_number: Option<u64>) -> Self {
        static CONTEXTS: AtomicU64 = AtomicU64::new(0);
        let number = CONTEXTS.fetch_add(1, Ordering::Relaxed);
        let device = pipelines.store.device.clone();
        let white = Ramp::from_linear(UVec2::ONE, [Vec3::ONE]);
        Self(Arc::new(Shared {
            number,
            device_number: device_number.unwrap_or(number),
            textures: SharedTextures::new(&Gpu { device: &device, queue }),
            no_ramp: upload_ramp(&Gpu { device: &device, queue }, "haze no ramp", &white).view,
            no_shadow: volume(&device, "haze no shadow", 1, 1, wgpu::TextureUsages::empty()),
            read_only_depth: read_only_depth_is_supported(&device),
            max_volume_depth: device.limits().max_texture_dimension_3d,
            support: Support {
                six_way: six_way_is_supported(&device),
                independent_blend: independent_blend_is_supported(&device),
            },
            path_model: Mutex::new(PathModel::for_device_type(device.adapter_info().device_type)),
            device,
            queue: queue.clone(),
            layouts,
            pipelines,
        }))
    }

    /// Returns the device.
    pub fn device(&self) -> &wgpu::Device {
        &self.0.device
    }

    /// Returns the queue.
    pub fn queue(&self) -> &wgpu::Queue {
        &self.0.queue
    }

    /// Returns the layout of [`Renderer::scene_shadow_bind_group`](crate::Renderer::scene_shadow_bind_group), for a host's pipelines.
    pub fn scene_shadow_layout(&self) -> &wgpu::BindGroupLayout {
        &self.0.layouts.scene_shadow
    }

    /// Uploads ramps and sprite images, but those that another material of this context holds: clones of an image are
    /// uploaded once. Create each material once and keep it; all renderers of this context can use it.
    ///
    /// # Errors
    /// [`PrepareError::Field`] names an image that is too large for the device, or six-way maps whose size differs from the
    /// sprite's.
    pub fn create_material(&self, assets: &MaterialAssets) -> Result<Material, PrepareError> {
        let Shared { layouts, textures, number, .. } = &*self.0;
        Ok(create_material(&self.0.gpu(), layouts, textures, *number, assets)?)
    }

    /// Returns the GPU memory of the images that materials of this context hold, bytes. An image that several share counts
    /// once.
    pub fn material_memory(&self) -> u64 {
        self.0.textures.images.bytes()
    }

    /// Creates timestamp queries, which measure the passes of this device's renderers. `None` if the device lacks
    /// `Features::TIMESTAMP_QUERY`.
    pub fn create_timing(&self) -> Option<Timing> {
        Timing::new(&self.0.gpu(), self.0.device_number)
    }

    /// Returns the number of pipelines compiled so far. It stays constant once everything that a program draws has been
    /// drawn or warmed up.
    pub fn pipeline_count(&self) -> usize {
        self.0.pipelines.store.pipeline_count()
    }

    /// Returns true if the device supports the path `tiled`.
    pub fn supports_tiled(&self) -> bool {
        self.0.tiles().is_some()
    }

    /// Returns the cost model by which the path `auto` chooses. Initially, it contains figures measured on a device of
    /// this type.
    pub fn path_model(&self) -> PathModel {
        self.0.path_model()
    }

    /// Sets the cost model by which the path `auto` chooses, from the next frame on: the result of
    /// [`measure_paths`](Self::measure_paths), from this run or from an earlier run on this device, or the host's own
    /// figures.
    ///
    /// # Errors
    /// [`PrepareError::Field`] names a cost that is negative or not finite, or `cores` if it is 0.
    pub fn set_path_model(&self, model: PathModel) -> Result<(), PrepareError> {
        model.validate()?;
        *self.0.path_model.lock().unwrap_or_else(PoisonError::into_inner) = model;
        Ok(())
    }

    /// Selects the traversal of the path `tiled`: true for cooperative (a workgroup shares each batch of sprites;
    /// default on GPUs), false for per invocation (default on CPUs). For tests and measurements of the variant that is
    /// not the device's default. Both give the same image.
    pub fn set_cooperative_traversal(&self, cooperative: bool) {
        if let Some(tiled) = &self.0.pipelines.tiled {
            tiled.set_cooperative(cooperative);
        }
    }

    pub(crate) fn shared(&self) -> &Shared {
        &self.0
    }
}
