//! Resources that the renderers of one device share.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use super::auto::PathModel;
use super::gpu::Gpu;
use super::gpu::capabilities::{read_only_depth_is_supported, six_way_is_supported};
use super::layouts::Layouts;
use super::material_upload::{SharedTextures, create_material};
use super::pipelines::Pipelines;
use super::plan::plans_covering_every_pass;
use super::shader::{Sources, checked_shader, embedded_shader};
use super::tiled::TiledPipelines;
use crate::assets::material_assets::MaterialAssets;
use crate::error::{Error, FieldError};
use crate::frame::Material;

/// Resources that all renderers of one device share: shader modules, bind group layouts, samplers and pipelines. A
/// clone refers to the same context. A context can be used from any thread.
///
/// A program with one view needs no explicit context: [`Renderer::new`](crate::Renderer::new) creates one. For split
/// screens, stereo, shadow or reflection views, create one renderer per view and give each the same context: creating a
/// renderer is then cheap, and no pipeline is compiled twice.
#[derive(Clone, Debug)]
pub struct Context(Arc<Shared>);

#[derive(Debug)]
pub(crate) struct Shared {
    /// Unique in the process. wgpu compares devices by an ID that two instances may both assign.
    pub number: u64,
    pub device: wgpu::Device,
    pub layouts: Layouts,
    textures: SharedTextures,
    pub pipelines: Pipelines,
    /// [`read_only_depth_is_supported`], queried once, because every query copies the adapter's information.
    pub read_only_depth: bool,
    /// True if the device supports six-way lighting; otherwise smoke is lit by normals.
    pub six_way: bool,
    path_model: Mutex<PathModel>,
}

impl Shared {
    /// Returns the traversal of the path `tiled`, as in [`PipelineInputs::tiles`](super::plan::PipelineInputs::tiles).
    pub fn tiles(&self) -> Option<bool> {
        self.pipelines.tiled.as_ref().map(TiledPipelines::cooperative)
    }

    pub fn path_model(&self) -> PathModel {
        *self.path_model.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Context {
    /// Compiles the shader modules. Pipelines are compiled by the first `prepare` that needs them, or in advance by
    /// [`Renderer::warm_up`](crate::Renderer::warm_up).
    ///
    /// `pipeline_cache`: a cache that the host created from saved data, on backends that support it (today Vulkan, with
    /// `Features::PIPELINE_CACHE`). Pipelines are looked up in it and added to it. The host reads its contents with
    /// `get_data` to save them.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, pipeline_cache: Option<&wgpu::PipelineCache>) -> Self {
        let layouts = Layouts::new(device);
        let Ok(pipelines) = Pipelines::new(device, &layouts, pipeline_cache, |name| embedded_shader(device, name));
        Self::assemble(device, queue, layouts, pipelines)
    }

    /// Creates a context with custom shaders, for shader development. Compiles and validates all shader modules and one
    /// pipeline of every pass before it creates the context. [`Renderer::warm_up`](crate::Renderer::warm_up) reports
    /// errors that occur only with other settings. After an error, keep using the previous context and its renderers.
    ///
    /// # Errors
    /// [`Error::Shader`]: the first error, with its line and column in the file that contains it.
    pub fn with_shaders(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        pipeline_cache: Option<&wgpu::PipelineCache>,
        sources: &Sources,
    ) -> Result<Self, Error> {
        let layouts = Layouts::new(device);
        let pipelines = Pipelines::new(device, &layouts, pipeline_cache, |name| checked_shader(device, name, sources))?;
        let context = Self::assemble(device, queue, layouts, pipelines);
        let shared = context.shared();
        plans_covering_every_pass(shared.read_only_depth, shared.tiles())
            .iter()
            .try_for_each(|plan| shared.pipelines.compile(device, plan))?;
        Ok(context)
    }

    fn assemble(device: &wgpu::Device, queue: &wgpu::Queue, layouts: Layouts, pipelines: Pipelines) -> Self {
        static CONTEXTS: AtomicU64 = AtomicU64::new(0);
        Self(Arc::new(Shared {
            number: CONTEXTS.fetch_add(1, Ordering::Relaxed),
            device: device.clone(),
            textures: SharedTextures::new(&Gpu { device, queue }),
            read_only_depth: read_only_depth_is_supported(device),
            six_way: six_way_is_supported(device),
            path_model: Mutex::new(PathModel::of_class(device.adapter_info().device_type)),
            layouts,
            pipelines,
        }))
    }

    /// Uploads ramps and sprite images. Create each material once and keep it; all renderers of this context can use
    /// it.
    ///
    /// # Errors
    /// [`Error::Field`] names an image that is too large for the device, six-way maps whose size differs from the
    /// sprite's, or `device` if it is not this context's device.
    pub fn create_material(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        assets: &MaterialAssets,
    ) -> Result<Material, Error> {
        self.validate_device(device)?;
        let Shared { layouts, textures, number, .. } = &*self.0;
        Ok(create_material(&Gpu { device, queue }, layouts, textures, *number, assets)?)
    }

    /// Returns the number of pipelines compiled so far. It stays constant once everything that a program draws has been
    /// drawn or warmed up.
    pub fn pipeline_count(&self) -> usize {
        self.0.pipelines.pipeline_count()
    }

    /// Returns true if the device supports the path `tiled`.
    pub fn has_tiles(&self) -> bool {
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
    /// [`Error::Field`] names a cost that is negative or not finite, or `cores` if it is 0.
    pub fn set_path_model(&self, model: PathModel) -> Result<(), Error> {
        model.validate()?;
        *self.0.path_model.lock().unwrap_or_else(PoisonError::into_inner) = model;
        Ok(())
    }

    /// Selects the traversal of the path `tiled`: true for cooperative (a workgroup shares each batch of sprites;
    /// default on GPUs), false for per invocation (default on CPUs). For tests and measurements of the variant that is
    /// not the device's default. Both give the same image.
    #[doc(hidden)]
    pub fn set_cooperative_traversal(&self, cooperative: bool) {
        self.0.pipelines.tiled.iter().for_each(|tiled| tiled.set_cooperative(cooperative));
    }

    pub(crate) fn shared(&self) -> &Shared {
        &self.0
    }

    /// Refuses any device other than this context's.
    pub(crate) fn validate_device(&self, device: &wgpu::Device) -> Result<(), FieldError> {
        if self.0.device == *device {
            return Ok(());
        }
        let expected = "the device that created the context";
        Err(FieldError::from_problem("device", "differs from the context's device", expected))
    }
}
