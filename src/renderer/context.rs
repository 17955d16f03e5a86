//! What renderers of one device share.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use super::auto::PathModel;
use super::gpu::Gpu;
use super::gpu::capabilities::{read_only_depth_is_supported, six_way_is_supported};
use super::layouts::Layouts;
use super::material::{SharedTextures, create_material};
use super::passes::Passes;
use super::plan::one_of_each;
use super::shader::{Sources, checked_shader, embedded_shader};
use super::tiled::Tiled;
use crate::assets::material::MaterialAssets;
use crate::error::{Error, FieldError};
use crate::frame::Material;

/// What all renderers of one device share: shader modules, bind group layouts, samplers and pipelines. A clone is the same
/// context; it may be used from any thread.
///
/// A program with one view needs none of its own: [`Renderer::new`](crate::Renderer::new) makes one. For split screens, stereo,
/// shadow or reflection views, make a renderer for each view, and hand the same context to each: they are cheap then, and no
/// pipeline is compiled twice.
#[derive(Clone, Debug)]
pub struct Context(Arc<Shared>);

#[derive(Debug)]
pub(crate) struct Shared {
    /// No other context has it. wgpu compares devices by a number that two instances may both give.
    pub number: u64,
    pub device: wgpu::Device,
    pub layouts: Layouts,
    textures: SharedTextures,
    pub passes: Passes,
    /// [`read_only_depth_is_supported`], asked once: the answer is one of many that a device makes a copy of each time.
    pub read_only_depth: bool,
    /// Six-way light is there; else smoke is lit by normals.
    pub six_way: bool,
    path_model: Mutex<PathModel>,
}

impl Shared {
    /// As [`Situation::tiles`](super::plan::Situation::tiles).
    pub fn tiles(&self) -> Option<bool> {
        self.passes.tiled.as_ref().map(Tiled::in_step)
    }

    pub fn path_model(&self) -> PathModel {
        *self.path_model.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Context {
    /// Compiles the shader modules. Pipelines are compiled by the first `prepare` that needs them, or ahead by
    /// [`Renderer::warm_up`](crate::Renderer::warm_up).
    ///
    /// `pipeline_cache`: one that the host made from what it saved the last time, on backends that have them (today Vulkan, with
    /// `Features::PIPELINE_CACHE`). Pipelines are looked up in it and added to it; the host takes its contents out with
    /// `get_data` when it likes.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, pipeline_cache: Option<&wgpu::PipelineCache>) -> Self {
        let layouts = Layouts::new(device);
        let Ok(passes) = Passes::new(device, &layouts, pipeline_cache, |name| embedded_shader(device, name));
        Self::assemble(device, queue, layouts, passes)
    }

    /// The same with shaders that someone works on. They are compiled and checked before the context is made: the modules, and a
    /// pipeline of every pass. What only other settings bring to light, [`Renderer::warm_up`](crate::Renderer::warm_up)
    /// reports. On its error keep the context that there is, and its renderers.
    ///
    /// # Errors
    /// [`Error::Shader`]: the first mistake, with its place in the file that has it.
    pub fn with_shaders(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        pipeline_cache: Option<&wgpu::PipelineCache>,
        sources: &Sources,
    ) -> Result<Self, Error> {
        let layouts = Layouts::new(device);
        let passes = Passes::new(device, &layouts, pipeline_cache, |name| checked_shader(device, name, sources))?;
        let context = Self::assemble(device, queue, layouts, passes);
        let shared = context.shared();
        one_of_each(shared.read_only_depth, shared.tiles())
            .iter()
            .try_for_each(|plan| shared.passes.compile(device, plan))?;
        Ok(context)
    }

    fn assemble(device: &wgpu::Device, queue: &wgpu::Queue, layouts: Layouts, passes: Passes) -> Self {
        static CONTEXTS: AtomicU64 = AtomicU64::new(0);
        Self(Arc::new(Shared {
            number: CONTEXTS.fetch_add(1, Ordering::Relaxed),
            device: device.clone(),
            textures: SharedTextures::new(&Gpu { device, queue }),
            read_only_depth: read_only_depth_is_supported(device),
            six_way: six_way_is_supported(device),
            path_model: Mutex::new(PathModel::of_class(device.adapter_info().device_type)),
            layouts,
            passes,
        }))
    }

    /// Uploads ramps and sprite pictures. Make each material once and keep it; all renderers of this context draw with it.
    ///
    /// # Errors
    /// [`Error::Field`] naming a picture that is too large for the device, or the device if it is another than this context's.
    pub fn create_material(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        assets: &MaterialAssets,
    ) -> Result<Material, Error> {
        self.validate_device(device)?;
        let Shared { layouts, textures, number, .. } = &*self.0;
        Ok(create_material(&Gpu { device, queue }, &layouts.material, textures, *number, assets)?)
    }

    /// Pipelines compiled so far. It stands still once everything that a program draws has been drawn or warmed up.
    pub fn pipeline_count(&self) -> usize {
        self.0.passes.pipeline_count()
    }

    /// True if the device has the path `tiled`.
    pub fn has_tiles(&self) -> bool {
        self.0.tiles().is_some()
    }

    /// By what the path `auto` chooses: at first, what devices of this kind were measured at.
    pub fn path_model(&self) -> PathModel {
        self.0.path_model()
    }

    /// Sets by what the path `auto` chooses, from the next frame on: what [`measure_paths`](Self::measure_paths) found, now or when the
    /// program last ran on this device, or a host's own figures.
    ///
    /// # Errors
    /// [`Error::Field`] naming a cost that is negative or not finite, or no cores.
    pub fn set_path_model(&self, model: PathModel) -> Result<(), Error> {
        model.validate()?;
        *self.0.path_model.lock().unwrap_or_else(PoisonError::into_inner) = model;
        Ok(())
    }

    /// Whether the workgroups of the path `tiled` walk in step, as is best for GPUs, or each invocation by itself, as is best for
    /// CPUs: for tests and measurements of the one where the other is chosen. The picture is the same.
    #[doc(hidden)]
    pub fn walk_in_step(&self, in_step: bool) {
        self.0.passes.tiled.iter().for_each(|tiled| tiled.set_in_step(in_step));
    }

    pub(crate) fn shared(&self) -> &Shared {
        &self.0
    }

    /// Refuses any device but this context's.
    pub(crate) fn validate_device(&self, device: &wgpu::Device) -> Result<(), FieldError> {
        if self.0.device == *device {
            return Ok(());
        }
        Err(FieldError::new("device", "another than the context's", "the device that the context was made with"))
    }
}
