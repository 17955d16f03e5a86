//! Pipelines and uploaded materials that the off-screen renderers of a device share.

use std::sync::{Arc, Mutex, OnceLock, PoisonError, Weak};

use haze_core::assets::material_assets::MaterialAssets;
use haze_core::error::Error;

use super::bloom_pass::{BLOOM_SHADER, BloomPass};
use super::camera_passes::CameraPasses;

use super::outline_pass::OutlinePass;
use super::scene_pipeline::LINEAR_FORMAT;
use super::scene_renderer::SceneRenderer;
use haze::shader::Sources;
use haze::{Context, Material, PathModel, Timing, read_only_depth_is_supported};

/// Pipelines and materials that all [`OffscreenRenderer`](super::offscreen_renderer::OffscreenRenderer)s of a device
/// fraction. A clone shares them too.
#[derive(Clone, Debug)]
pub struct OffscreenContext {
    pub(super) device: wgpu::Device,
    pub(super) haze: Context,
    pub(super) scene: Arc<SceneRenderer>,
    pub(super) outlines: Arc<OutlinePass>,
    pub(super) camera: Arc<CameraPasses>,
    /// Compiled on first use: few images have bloom.
    bloom: Arc<OnceLock<BloomPass>>,
    /// Materials that existing renderers have uploaded. Shared images are uploaded once.
    materials: Arc<Mutex<Vec<Weak<UploadedMaterial>>>>,
    /// True to attach the scene's depth buffer to the smoke pass: it is not sampled there, or the device supports
    /// read-only depth.
    pub(super) attaches_depth: bool,
    /// True if depth can be copied to a buffer.
    pub(super) copies_depth: bool,
}

impl OffscreenContext {
    /// Creates shaders and layouts of the scene and of haze. Pipelines are compiled on first use.
    pub fn new(adapter: &wgpu::Adapter, device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        let usages = adapter.get_texture_format_features(LINEAR_FORMAT).allowed_usages;
        let draws_linear = usages.contains(wgpu::TextureUsages::RENDER_ATTACHMENT);
        let flags = adapter.get_downlevel_capabilities().flags;
        let haze = Context::new(device, queue);
        let scene = SceneRenderer::new(device, queue, draws_linear, haze.scene_shadow_layout());
        Self {
            copies_depth: flags.contains(wgpu::DownlevelFlags::DEPTH_TEXTURE_AND_BUFFER_COPIES),
            device: device.clone(),
            outlines: Arc::new(OutlinePass::new(device, queue, &scene.scene_layout)),
            scene: Arc::new(scene),
            haze,
            camera: Arc::new(CameraPasses::new(device, queue)),
            bloom: Arc::default(),
            materials: Arc::default(),
            attaches_depth: draws_linear || read_only_depth_is_supported(device),
        }
    }

    /// True if [`capture`](super::offscreen_renderer::OffscreenRenderer::capture) is supported.
    pub fn can_capture(&self) -> bool {
        self.copies_depth
    }

    /// Creates timestamp queries; `None` if the device does not support them.
    pub fn timing(&self) -> Option<Timing> {
        self.haze.create_timing()
    }

    /// Same as [`Context::measure_paths`].
    ///
    /// # Errors
    /// As [`Context::measure_paths`].
    pub fn measure_paths(
        &self,
        submit: impl FnMut(wgpu::CommandEncoder) -> Result<(), Error>,
    ) -> Result<PathModel, Error> {
        self.haze.measure_paths(submit)
    }

    /// Returns a copy with another haze [`Context`] of the same device, for example one with other shaders.
    #[must_use]
    pub fn with_context(&self, haze: Context) -> Self {
        // Materials belong to the context that created them.
        Self { haze, materials: Arc::default(), ..self.clone() }
    }

    /// Returns a copy with other shaders.
    ///
    /// # Errors
    /// As [`Context::with_shaders`].
    pub fn with_shaders(&self, sources: &Sources) -> Result<Self, Error> {
        Ok(self.with_context(self.haze.with_shaders(sources)?))
    }

    pub(super) fn bloom(&self) -> &BloomPass {
        self.bloom.get_or_init(|| BloomPass::new(&self.device, BLOOM_SHADER))
    }

    /// Uploads images, or returns those that another renderer of the context has uploaded.
    pub(super) fn upload(&self, assets: &MaterialAssets) -> Result<Arc<UploadedMaterial>, Error> {
        let mut materials = self.materials.lock().unwrap_or_else(PoisonError::into_inner);
        materials.retain(|uploaded| uploaded.strong_count() > 0);
        if let Some(uploaded) = materials.iter().filter_map(Weak::upgrade).find(|one| one.assets.shares_memory(assets))
        {
            return Ok(uploaded);
        }
        let material = self.haze.create_material(assets)?;
        let uploaded = Arc::new(UploadedMaterial { assets: assets.clone(), material });
        materials.push(Arc::downgrade(&uploaded));
        Ok(uploaded)
    }
}

/// Images of a system in memory and on the GPU.
#[derive(Debug)]
pub(super) struct UploadedMaterial {
    pub assets: MaterialAssets,
    pub material: Material,
}
