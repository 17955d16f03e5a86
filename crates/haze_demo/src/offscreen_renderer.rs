//! Off-screen GPU renderer for shots. Draws the smoke every frame, and the scene only if it or the camera has changed.

use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::{UVec2, Vec3, Vec4};
use haze_core::assets::image::Image;
use haze_core::assets::material_assets::MaterialAssets;
use haze_core::error::Error;
use haze_core::formula::depth::SKY_VIEW_DEPTH;
use haze_core::formula::shadow::LIGHTS_PER_BLOCK;
use haze_core::frame::EmitterPaths;
use haze_core::settings::DebugView;
use haze_preset::Environment;

use super::bloom_pass::BloomLevels;
use super::camera_passes::{CameraImages, CameraUniforms};
use super::capture::Capture;
pub use super::offscreen_context::OffscreenContext;
use super::offscreen_context::UploadedMaterial;
use super::outline_pass::OutlineInputs;
use super::scene_pipeline::{COLOR_FORMAT, DEPTH_FORMAT, default_view, texture};
use super::scene_renderer::SceneTargets;
use super::shadow_views::ShadowView;
use super::shot::{ParticleSource, Shot};
pub use super::texture_readback::PendingImage;
use super::uploaded_backdrop::UploadedBackdrop;
use crate::headless::Headless;
use haze::{
    FrameInput, Light, LightingChoice, MemoryUse, ParticleSystem, Particles, PathChoice, Renderer, RendererDescriptor,
    ScaleChoice, SceneDepth, SceneDepthKind, ShadowMap, Timing, View, WarmUp,
};
use haze_author::backdrop::Backdrop;

/// Off-screen renderer; see the module's documentation.
#[derive(Debug)]
pub struct OffscreenRenderer {
    context: OffscreenContext,
    renderer: Renderer,
    materials: Vec<Arc<UploadedMaterial>>,
    sized: Option<SizedTargets>,
    shadow_maps: ShadowMaps,
    backdrop: Option<Arc<UploadedBackdrop>>,
    /// `None`: particles are evaluated anew for each image.
    paths: Option<KeptPaths>,
}

/// Paths of the particles of each system: of all, and of the sample that stands for a fire.
#[derive(Debug, Default)]
struct KeptPaths {
    all: Vec<EmitterPaths>,
    of_fires: Vec<EmitterPaths>,
}

/// Shadow maps of the scene, and what they were drawn of.
#[derive(Debug, Default)]
struct ShadowMaps {
    of: Option<(Environment, Backdrop)>,
    maps: Vec<(ShadowView, wgpu::Texture)>,
}

/// GPU memory of an off-screen renderer, bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OffscreenMemory {
    /// Memory of haze's renderer.
    pub smoke: MemoryUse,
    /// Ramps and sprites, including those shared with other renderers.
    pub materials: u64,
    /// Targets of the scene, and output images.
    pub scene: u64,
}

impl OffscreenMemory {
    /// Returns the total.
    pub fn total(&self) -> u64 {
        self.smoke.targets + self.smoke.buffers + self.materials + self.scene
    }
}

/// Resources that depend on the image size.
#[derive(Debug)]
struct SizedTargets {
    targets: SceneTargets,
    /// Inputs of the scene that the targets currently show.
    scene_inputs: Option<SceneInputs>,
    images: [Option<wgpu::Texture>; DebugView::ALL.len()],
    /// The final image before its outlines are completed.
    smoked: Option<OutlineInputs>,
    /// Of the final image.
    camera: CameraImages,
    /// Of the final image, if it has bloom.
    bloom: Option<BloomLevels>,
}

/// Part of a frame that is measured by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FramePart {
    Scene,
    Smoke,
}

/// Inputs of the scene's image; the scene is redrawn if they change.
#[derive(Clone, Debug, PartialEq)]
struct SceneInputs {
    environment: Environment,
    backdrop: Backdrop,
    lights: Vec<Light>,
    view: View,
    /// Indices of the lights that smoke shades.
    shadowed: Vec<usize>,
}

impl OffscreenRenderer {
    /// Creates a renderer without targets. `exact_filtering` as in [`RendererDescriptor`].
    ///
    /// # Errors
    /// [`Error::Field`] if the device cannot render to half floats.
    pub fn new(context: &OffscreenContext, exact_filtering: bool) -> Result<Self, Error> {
        let descriptor = RendererDescriptor {
            color_format: COLOR_FORMAT,
            depth_format: context.attaches_depth.then_some(DEPTH_FORMAT),
            exact_filtering,
            ..RendererDescriptor::default()
        };
        let renderer = Renderer::new(&context.haze, &descriptor)?;
        Ok(Self {
            context: context.clone(),
            renderer,
            materials: Vec::new(),
            sized: None,
            shadow_maps: ShadowMaps::default(),
            backdrop: None,
            paths: None,
        })
    }

    /// Makes it evaluate particles along their paths in the frame before, for a window: faster, but then an image depends on
    /// earlier ones, by a tenth of a millimetre.
    #[must_use]
    pub fn with_kept_paths(self) -> Self {
        Self { paths: Some(KeptPaths::default()), ..self }
    }

    /// Returns a renderer without a history, like a new one, that keeps what was drawn of the scene and uploaded.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn restarted(self, exact_filtering: bool) -> Result<Self, Error> {
        let Self { renderer, .. } = Self::new(&self.context, exact_filtering)?;
        let paths = self.paths.map(|_| KeptPaths::default());
        Ok(Self { renderer, paths, ..self })
    }

    /// Returns haze's renderer.
    pub fn renderer(&self) -> &Renderer {
        &self.renderer
    }

    /// Iterates over the paths chosen in the last frame, for visible systems whose path is `auto`.
    pub fn path_choices(&self) -> impl Iterator<Item = PathChoice> {
        (0..).zip(&self.materials).filter_map(|(key, _)| self.renderer.path_choice(key))
    }

    /// Iterates over the lighting resolutions chosen in the last frame, for visible systems where it is `auto`.
    pub fn lighting_choices(&self) -> impl Iterator<Item = LightingChoice> {
        (0..).zip(&self.materials).filter_map(|(key, _)| self.renderer.lighting_choice(key))
    }

    /// Iterates over the scales chosen in the last frame, for visible systems whose scale mode is `auto`.
    pub fn scale_choices(&self) -> impl Iterator<Item = ScaleChoice> {
        (0..).zip(&self.materials).filter_map(|(key, _)| self.renderer.scale_choice(key))
    }

    /// Same as [`Renderer::set_timing`].
    ///
    /// # Errors
    /// As [`Renderer::set_timing`].
    pub fn set_timing(&mut self, timing: Option<&Timing>) -> Result<(), Error> {
        Ok(self.renderer.set_timing(timing)?)
    }

    /// Returns the GPU memory in use.
    pub fn memory_use(&self) -> OffscreenMemory {
        OffscreenMemory {
            smoke: self.renderer.memory_use(),
            materials: self.materials.iter().map(|uploaded| uploaded.material.memory_use()).sum(),
            scene: self.sized.as_ref().map_or(0, SizedTargets::bytes)
                + self.backdrop.as_ref().map_or(0, |backdrop| backdrop.bytes()),
        }
    }

    /// Records a frame: the scene if it has changed, the smoke, and one output image for each of `stages`. At most one
    /// call per submission.
    ///
    /// # Errors
    /// [`Error::Field`] if the preset was changed to invalid values or an image is too large for the device. The output
    /// images then keep their contents.
    pub fn record(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        shot: &Shot,
        stages: &[DebugView],
    ) -> Result<(), Error> {
        self.record_parts(encoder, shot, stages, |_, _| Ok(()))
    }

    /// Draws a frame and waits for the device after each part of it. Returns the wall time of the smoke alone, from
    /// submission to completion. `submit` submits an encoder and waits until the device is done.
    ///
    /// # Errors
    /// As [`record`](Self::record), and those of `submit`.
    pub fn smoke_time(
        &mut self,
        shot: &Shot,
        stages: &[DebugView],
        mut submit: impl FnMut(wgpu::CommandEncoder) -> Result<(), Error>,
    ) -> Result<Duration, Error> {
        let device = self.context.device.clone();
        let new_encoder = || device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut smoke_time = Duration::ZERO;
        self.record_parts(&mut new_encoder(), shot, stages, |encoder, part| {
            let recorded = std::mem::replace(encoder, new_encoder());
            let started = Instant::now();
            submit(recorded)?;
            if part == FramePart::Smoke {
                smoke_time += started.elapsed();
            }
            Ok(())
        })?;
        Ok(smoke_time)
    }

    /// Records a frame, and calls `end_part` after each part of it.
    fn record_parts(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        shot: &Shot,
        stages: &[DebugView],
        mut end_part: impl FnMut(&mut wgpu::CommandEncoder, FramePart) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let shot = &*shot.at_its_time();
        shot.preset.validate()?;
        self.upload(&shot.materials)?;
        let OffscreenContext { device, scene, outlines, attaches_depth, .. } = &self.context;
        let size = shot.size.max(UVec2::ONE);
        let sized = match &mut self.sized {
            Some(sized) if sized.size() == size => sized,
            sized => sized.insert(SizedTargets {
                targets: scene.targets(size),
                scene_inputs: None,
                images: Default::default(),
                smoked: None,
                camera: CameraImages::default(),
                bloom: None,
            }),
        };
        let backdrop = match self.backdrop.take() {
            Some(held) if held.backdrop == shot.backdrop => held,
            _ => scene.uploaded(&shot.backdrop),
        };
        let backdrop = &*self.backdrop.insert(backdrop);
        let view = shot.preset.camera.view(size);
        let views = shot.shadow_views();
        let held = &mut self.shadow_maps;
        let of = Some((shot.preset.environment.clone(), shot.backdrop.clone()));
        if held.of != of || !held.maps.iter().map(|(view, _)| view).eq(&views) {
            let of_scene = shot.scene();
            let draw = |view: ShadowView| {
                let map = scene.shadow_map(encoder, &of_scene, &view, backdrop);
                (view, map)
            };
            held.maps = views.into_iter().map(draw).collect();
            held.of = of;
        }
        let mut new_paths = KeptPaths::default();
        let paths = self.paths.as_mut().unwrap_or(&mut new_paths);
        paths.all.resize(shot.preset.systems.len(), EmitterPaths::default());
        paths.of_fires.resize(shot.preset.systems.len(), EmitterPaths::default());
        let sources = shot.sources(&mut paths.all);
        let systems: Vec<_> = (0..)
            .zip(sources.iter().zip(&self.materials))
            .map(|(key, ((source, settings), uploaded))| {
                let particles = match source {
                    ParticleSource::Particles(particles) => Particles::Slice(particles),
                    ParticleSource::EmitterSnapshot(emission) => Particles::Emitter(emission),
                };
                ParticleSystem::new(key, particles, settings, &uploaded.material)
            })
            .collect();
        let depth = sized.targets.depth.clone();
        let linear = sized.targets.linear.clone();
        let scene_depth = match &linear {
            Some(linear) => SceneDepth::BufferAndLinear { buffer: &depth, linear },
            None => SceneDepth::Buffer(&depth),
        };
        let shadow_maps: Vec<_> = self
            .shadow_maps
            .maps
            .iter()
            .map(|(view, depth)| ShadowMap { depth, first_layer: 0, projection: view.projection() })
            .collect();
        let lights = shot.lights_along(&mut paths.of_fires);
        let frame = FrameInput {
            shadow_maps: &shadow_maps,
            lights: &lights,
            systems: &systems,
            time: shot.preset.time,
            up: Vec3::Y,
            debug_views: stages,
            ..FrameInput::new(view, scene_depth)
        };
        end_part(encoder, FramePart::Scene)?;
        self.renderer.prepare_shadow(encoder, &frame)?;
        end_part(encoder, FramePart::Smoke)?;
        let scene_inputs = SceneInputs {
            environment: shot.preset.environment.clone(),
            backdrop: shot.backdrop.clone(),
            lights: lights.clone(),
            view,
            shadowed: self.renderer.shadowed_lights().take(LIGHTS_PER_BLOCK).collect(),
        };
        if sized.scene_inputs.as_ref() != Some(&scene_inputs) {
            scene.record(encoder, &mut sized.targets, &shot.scene(), &view, &scene_inputs.shadowed, backdrop);
            sized.scene_inputs = Some(scene_inputs);
        }
        scene.shade(encoder, &sized.targets, self.renderer.scene_shadow_bind_group());
        for &stage in stages {
            sized.images[stage as usize].get_or_insert_with(|| texture(device, "demo image", size, COLOR_FORMAT));
            if stage == DebugView::Final {
                let SizedTargets { targets, smoked, .. } = sized;
                let outline = smoked.get_or_insert_with(|| {
                    let smoked = default_view(&texture(device, "demo smoke", size, COLOR_FORMAT));
                    outlines.inputs(targets, &default_view(&targets.color), smoked)
                });
                let smoked = outline.smoked.texture();
                let color = &targets.color;
                encoder.copy_texture_to_texture(color.as_image_copy(), smoked.as_image_copy(), color.size());
            }
        }
        end_part(encoder, FramePart::Scene)?;
        self.renderer.prepare(encoder, &frame)?;
        for &stage in stages {
            let Some(image) = &sized.images[stage as usize] else { continue };
            // Debug views other than the final image are shown on black.
            let (view, load) = match &sized.smoked {
                Some(outline) if stage == DebugView::Final => (outline.smoked.clone(), wgpu::LoadOp::Load),
                _ => (default_view(image), wgpu::LoadOp::Clear(wgpu::Color::BLACK)),
            };
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("smoke"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
                })],
                depth_stencil_attachment: attaches_depth.then_some(wgpu::RenderPassDepthStencilAttachment {
                    view: &depth,
                    depth_ops: None,
                    stencil_ops: None,
                }),
                ..Default::default()
            });
            self.renderer.render_debug_view(&mut pass, stage);
        }
        end_part(encoder, FramePart::Smoke)?;
        let image = sized.images[DebugView::Final as usize].as_ref();
        if let Some((inputs, image)) = sized.smoked.as_ref().zip(image).filter(|_| stages.contains(&DebugView::Final)) {
            let visible = (0..).zip(&self.materials).filter_map(|(key, _)| self.renderer.targets(key)?.smoke_depths);
            let depths = visible
                .fold([SKY_VIEW_DEPTH, 0.0], |[nearest, farthest], [near, far]| [nearest.min(near), farthest.max(far)]);
            let uniforms = CameraUniforms::new(shot, &lights);
            self.context.camera.prepare(&mut sized.camera, &uniforms, size, &depth);
            let completed = sized.camera.textures().next().unwrap_or(image);
            outlines.record(encoder, &sized.targets, inputs, depths, &default_view(completed));
            self.context.camera.record(encoder, &sized.camera, &uniforms, image);
        }
        let strength = shot.bloom();
        match image.filter(|_| strength > 0.0 && stages.contains(&DebugView::Final)) {
            Some(image) => {
                let bloom = self.context.bloom();
                let held = sized.bloom.take().filter(|levels| levels.is_of(image));
                let levels = sized.bloom.insert(held.unwrap_or_else(|| bloom.levels(image)));
                bloom.record(encoder, levels, strength);
            }
            None => sized.bloom = None,
        }
        end_part(encoder, FramePart::Scene)
    }

    /// Forces the scene to be redrawn in the next frame. Call it if the last recorded encoder was dropped without being
    /// submitted.
    pub fn invalidate_scene(&mut self) {
        if let Some(sized) = &mut self.sized {
            sized.scene_inputs = None;
        }
        self.shadow_maps = ShadowMaps::default();
    }

    /// Compiles the pipelines that a shot needs.
    ///
    /// # Errors
    /// [`PrepareError::Shader`](haze_core::error::PrepareError::Shader) with the name of the pass, if custom shaders cannot be compiled.
    pub fn warm_up(&self, shot: &Shot) -> Result<(), Error> {
        let shot = shot.at_its_time();
        let settings: Vec<_> = shot.preset.systems.iter().map(|system| system.settings).collect();
        Ok(self.renderer.warm_up(&WarmUp {
            view: shot.preset.camera.view(shot.size),
            scene_depth: if self.context.scene.draws_linear {
                SceneDepthKind::BufferAndLinear(DEPTH_FORMAT)
            } else {
                SceneDepthKind::Buffer(DEPTH_FORMAT)
            },
            settings: &settings,
            debug_views: &[shot.debug_view],
        })?)
    }

    /// Returns the output image of a debug view as last recorded: linear HDR, `Rgba16Float`, of the shot's size.
    pub fn image(&self, stage: DebugView) -> Option<&wgpu::Texture> {
        self.sized.as_ref()?.images[stage as usize].as_ref()
    }

    /// Records copies of the last frame's intermediate targets, after the frame in the same encoder. `None` if no frame
    /// was recorded, and on OpenGL, which cannot copy depth.
    pub fn capture(&self, encoder: &mut wgpu::CommandEncoder) -> Option<Capture> {
        let targets = &self.sized.as_ref().filter(|_| self.context.copies_depth)?.targets;
        let systems: Vec<_> = (0..).zip(&self.materials).map(|(key, _)| self.renderer.targets(key)).collect();
        let scene = [targets.depth.texture(), &targets.color, targets.front.texture()];
        Some(Capture::record(&self.context.device, encoder, scene, &systems))
    }

    /// Returns the scene's view depth, `R32Float`, metres, if the device can render to it.
    pub fn linear_depth(&self) -> Option<&wgpu::Texture> {
        self.sized.as_ref()?.targets.linear.as_ref().map(wgpu::TextureView::texture)
    }

    /// Draws a shot and waits for the device. Returns the time from submission to completion.
    ///
    /// # Errors
    /// As [`record`](Self::record); [`Error::Device`] if the device failed.
    pub fn draw(&mut self, gpu: &Headless, shot: &Shot) -> Result<Duration, Error> {
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.record(&mut encoder, shot, &[shot.debug_view])?;
        let start = Instant::now();
        gpu.submit(encoder)?;
        Ok(start.elapsed())
    }

    /// Reads back the image of the shot's debug view, linear HDR. Black if it was never drawn.
    ///
    /// # Errors
    /// [`Error::Device`] if the device failed.
    pub fn read(&self, gpu: &Headless, shot: &Shot) -> Result<Image<Vec4>, Error> {
        let Some(image) = self.image(shot.debug_view) else { return Ok(Image::new(shot.size, Vec4::W)) };
        let size = UVec2::new(image.width(), image.height());
        Ok(Image { size, texels: gpu.read_rgba16float(image)? })
    }

    /// Records a copy of the image of a debug view, to be read when the GPU is done. `None` if it was never drawn.
    pub fn read_later(&self, encoder: &mut wgpu::CommandEncoder, stage: DebugView) -> Option<PendingImage> {
        Some(PendingImage::record(&self.context.device, encoder, self.image(stage)?))
    }

    /// Uploads images that are not on the GPU yet.
    fn upload(&mut self, assets: &[MaterialAssets]) -> Result<(), Error> {
        self.materials.truncate(assets.len());
        for (index, assets) in assets.iter().enumerate() {
            match self.materials.get_mut(index) {
                Some(uploaded) if uploaded.assets.shares_memory(assets) => {}
                Some(uploaded) => *uploaded = self.context.upload(assets)?,
                None => self.materials.push(self.context.upload(assets)?),
            }
        }
        Ok(())
    }
}

impl SizedTargets {
    fn size(&self) -> UVec2 {
        UVec2::new(self.targets.color.width(), self.targets.color.height())
    }

    fn bytes(&self) -> u64 {
        let bytes = |texture: &wgpu::Texture| {
            let texel = texture.format().block_copy_size(None).unwrap_or_default();
            u64::from(texel) * u64::from(texture.width()) * u64::from(texture.height())
        };
        let smoked = self.smoked.iter().map(|outline| outline.smoked.texture());
        let bloom = self.bloom.iter().flat_map(BloomLevels::textures);
        let images = self.images.iter().flatten();
        self.targets.textures().chain(images).chain(smoked).chain(self.camera.textures()).chain(bloom).map(bytes).sum()
    }
}
