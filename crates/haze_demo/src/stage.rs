//! A shot on the GPU, frame after frame: the scene is drawn when it or the camera changes, the smoke every time.

use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::time::{Duration, Instant};

use glam::{UVec2, Vec3, Vec4};

use super::capture::Capture;
use super::scene_renderer::{COLOUR_FORMAT, DEPTH_FORMAT, LINEAR_FORMAT, SceneRenderer, SceneTargets, texture, whole};
use super::shot::{Shot, Source};
use crate::headless::Headless;
use haze::assets::material::MaterialAssets;
use haze::assets::picture::Picture;
use haze::error::Error;
use haze::frame::{Frame, Light, Material, Particles, SceneDepth, System, View};
use haze::preset::Environment;
use haze::settings::ShadeTree;
use haze::shader::Sources;
use haze::{
    Context, Descriptor, MemoryUse, PathChoice, PathModel, Renderer, SceneDepthKind, Timing, WarmUp,
    read_only_depth_is_supported,
};

/// What the stages of one device share. A clone is the same.
#[derive(Clone, Debug)]
pub struct StageContext {
    device: wgpu::Device,
    queue: wgpu::Queue,
    haze: Context,
    scene: Arc<SceneRenderer>,
    /// What stages that are there have uploaded: pictures that several show are uploaded once.
    materials: Arc<Mutex<Vec<Weak<Uploaded>>>>,
    /// The depth buffer is attached where it need not be read, or can be all the same.
    tests_depth: bool,
    /// Depth can be copied to a buffer.
    copies_depth: bool,
}

impl StageContext {
    /// Compiles the scene's shader and haze's.
    pub fn new(adapter: &wgpu::Adapter, device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        let usages = adapter.get_texture_format_features(LINEAR_FORMAT).allowed_usages;
        let draws_linear = usages.contains(wgpu::TextureUsages::RENDER_ATTACHMENT);
        let flags = adapter.get_downlevel_capabilities().flags;
        Self {
            copies_depth: flags.contains(wgpu::DownlevelFlags::DEPTH_TEXTURE_AND_BUFFER_COPIES),
            device: device.clone(),
            queue: queue.clone(),
            haze: Context::new(device, queue, None),
            scene: Arc::new(SceneRenderer::new(device, queue, draws_linear)),
            materials: Arc::default(),
            tests_depth: draws_linear || read_only_depth_is_supported(device),
        }
    }

    /// Whether [`Stage::capture`] can copy what was drawn.
    pub fn can_capture(&self) -> bool {
        self.copies_depth
    }

    /// What measures the stages of this device; none where it cannot.
    pub fn timing(&self) -> Option<Timing> {
        Timing::new(&self.device, &self.queue)
    }

    /// As [`Context::measure_paths`].
    ///
    /// # Errors
    /// As there.
    pub fn measure_paths(
        &self,
        submit: impl FnMut(wgpu::CommandEncoder) -> Result<(), Error>,
    ) -> Result<PathModel, Error> {
        self.haze.measure_paths(&self.device, &self.queue, submit)
    }

    /// The same with another context of haze's, of the same device: with other shaders, say.
    #[must_use]
    pub fn with_haze(&self, haze: Context) -> Self {
        // Materials are of the context that made them.
        Self { haze, materials: Arc::default(), ..self.clone() }
    }

    /// The same with other shaders.
    ///
    /// # Errors
    /// As [`Context::with_shaders`].
    pub fn with_shaders(&self, sources: &Sources) -> Result<Self, Error> {
        Ok(self.with_haze(Context::with_shaders(&self.device, &self.queue, None, sources)?))
    }

    fn upload(&self, assets: &MaterialAssets) -> Result<Arc<Uploaded>, Error> {
        let mut materials = self.materials.lock().unwrap_or_else(PoisonError::into_inner);
        materials.retain(|uploaded| uploaded.strong_count() > 0);
        if let Some(uploaded) = materials.iter().filter_map(Weak::upgrade).find(|one| one.assets.shares(assets)) {
            return Ok(uploaded);
        }
        let material = self.haze.create_material(&self.device, &self.queue, assets)?;
        let uploaded = Arc::new(Uploaded { assets: assets.clone(), material });
        materials.push(Arc::downgrade(&uploaded));
        Ok(uploaded)
    }
}

/// Pictures of a system, and the same on the GPU.
#[derive(Debug)]
struct Uploaded {
    assets: MaterialAssets,
    material: Material,
}

/// See the module.
#[derive(Debug)]
pub struct Stage {
    context: StageContext,
    renderer: Renderer,
    materials: Vec<Arc<Uploaded>>,
    set: Option<Set>,
}

/// Bytes of GPU memory that a stage holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StageMemory {
    /// Of haze's renderer.
    pub smoke: MemoryUse,
    /// Ramps and sprites, those that other stages show as well among them.
    pub materials: u64,
    /// The scene's targets, and the pictures.
    pub scene: u64,
}

impl StageMemory {
    /// All of it.
    pub fn total(&self) -> u64 {
        self.smoke.targets + self.smoke.buffers + self.materials + self.scene
    }
}

/// What depends on the picture's size.
#[derive(Debug)]
struct Set {
    targets: SceneTargets,
    /// What the targets show.
    drawn: Option<Drawn>,
    pictures: [Option<wgpu::Texture>; ShadeTree::ALL.len()],
}

/// What a picture of the scene depends on.
#[derive(Clone, Debug, PartialEq)]
struct Drawn {
    environment: Environment,
    lights: Vec<Light>,
    view: View,
}

impl Stage {
    /// An empty stage. `exact_filtering` as in [`Descriptor`].
    ///
    /// # Errors
    /// [`Error::Field`] where the device cannot draw to half floats.
    pub fn new(context: &StageContext, exact_filtering: bool) -> Result<Self, Error> {
        let descriptor = Descriptor {
            context: Some(&context.haze),
            color_format: COLOUR_FORMAT,
            depth_format: context.tests_depth.then_some(DEPTH_FORMAT),
            exact_filtering,
            ..Descriptor::default()
        };
        let renderer = Renderer::new(&context.device, &context.queue, &descriptor)?;
        Ok(Self { context: context.clone(), renderer, materials: Vec::new(), set: None })
    }

    /// haze's renderer of this stage.
    pub fn renderer(&self) -> &Renderer {
        &self.renderer
    }

    /// What the path `auto` took in the last frame, system by system: those in sight that leave it open.
    pub fn path_choices(&self) -> impl Iterator<Item = PathChoice> {
        (0..).zip(&self.materials).filter_map(|(key, _)| self.renderer.path_choice(key))
    }

    /// As [`Renderer::set_timing`].
    ///
    /// # Errors
    /// As there.
    pub fn set_timing(&mut self, timing: Option<&Timing>) -> Result<(), Error> {
        self.renderer.set_timing(timing)
    }

    /// Bytes of GPU memory held.
    pub fn memory_use(&self) -> StageMemory {
        StageMemory {
            smoke: self.renderer.memory_use(),
            materials: self.materials.iter().map(|uploaded| uploaded.material.memory_use()).sum(),
            scene: self.set.as_ref().map_or(0, Set::bytes),
        }
    }

    /// Records a frame: the scene if anything of it is new, the smoke, and a picture of every one of `stages`. One call for each
    /// submission.
    ///
    /// # Errors
    /// [`Error::Field`] when the preset was changed to something invalid or a picture is too large for the device. The pictures
    /// are as they were then.
    pub fn record(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        shot: &Shot,
        stages: &[ShadeTree],
    ) -> Result<(), Error> {
        shot.preset.validate()?;
        self.upload(&shot.materials)?;
        let StageContext { device, queue, scene, tests_depth, .. } = &self.context;
        let size = shot.size.max(UVec2::ONE);
        let set = match &mut self.set {
            Some(set) if set.size() == size => set,
            set => set.insert(Set { targets: scene.targets(size), drawn: None, pictures: Default::default() }),
        };
        let view = shot.preset.camera.view(size);
        let drawn = Drawn { environment: shot.preset.environment, lights: shot.preset.lights.clone(), view };
        if set.drawn.as_ref() != Some(&drawn) {
            scene.record(encoder, &set.targets, &shot.scene(), &view);
            set.drawn = Some(drawn);
        }
        let sources = shot.sources();
        let systems: Vec<_> = (0..)
            .zip(sources.iter().zip(&self.materials))
            .map(|(key, ((source, settings), uploaded))| {
                let particles = match source {
                    Source::Particles(particles) => Particles::Slice(particles),
                    Source::Emission(emission) => Particles::Emission(emission),
                };
                System { key, ..System::new(particles, settings, &uploaded.material) }
            })
            .collect();
        let depth = &set.targets.depth;
        let frame = Frame {
            lights: &shot.preset.lights,
            systems: &systems,
            time: shot.preset.time,
            up: Vec3::Y,
            stages,
            ..Frame::new(
                view,
                match &set.targets.linear {
                    Some(linear) => SceneDepth::Both { buffer: depth, linear },
                    None => SceneDepth::Buffer(depth),
                },
            )
        };
        self.renderer.prepare(device, queue, encoder, &frame)?;
        for &stage in stages {
            let picture = set.pictures[stage as usize]
                .get_or_insert_with(|| texture(device, "demo picture", size, COLOUR_FORMAT));
            // Other stages than the picture are shown on black.
            let mut load = wgpu::LoadOp::Clear(wgpu::Color::BLACK);
            if stage == ShadeTree::Final {
                let colour = &set.targets.colour;
                encoder.copy_texture_to_texture(colour.as_image_copy(), picture.as_image_copy(), colour.size());
                load = wgpu::LoadOp::Load;
            }
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("smoke"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &whole(picture),
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
                })],
                depth_stencil_attachment: tests_depth.then_some(wgpu::RenderPassDepthStencilAttachment {
                    view: depth,
                    depth_ops: None,
                    stencil_ops: None,
                }),
                ..Default::default()
            });
            self.renderer.render_stage(&mut pass, stage);
        }
        Ok(())
    }

    /// What was recorded last was dropped: the next frame draws all of it again.
    pub fn forget(&mut self) {
        self.set.iter_mut().for_each(|set| set.drawn = None);
    }

    /// Compiles what a shot is drawn with.
    ///
    /// # Errors
    /// [`Error::Shader`] naming the pass that cannot be compiled, of a context with shaders of an author's.
    pub fn warm_up(&self, shot: &Shot) -> Result<(), Error> {
        let settings: Vec<_> = shot.preset.systems.iter().map(|system| system.settings_for(shot.size.y)).collect();
        self.renderer.warm_up(&WarmUp {
            view: shot.preset.camera.view(shot.size),
            scene_depth: if self.context.scene.draws_linear {
                SceneDepthKind::Both(DEPTH_FORMAT)
            } else {
                SceneDepthKind::Buffer(DEPTH_FORMAT)
            },
            settings: &settings,
            stages: &[shot.shade_tree],
        })
    }

    /// The picture of a stage as last recorded: linear HDR, `Rgba16Float`, of the shot's size.
    pub fn picture(&self, stage: ShadeTree) -> Option<&wgpu::Texture> {
        self.set.as_ref()?.pictures[stage as usize].as_ref()
    }

    /// Records a copy of what the last frame was drawn from, after it in its encoder; `None` where there was none, and on OpenGL,
    /// which copies no depth.
    pub fn capture(&self, encoder: &mut wgpu::CommandEncoder) -> Option<Capture> {
        let targets = &self.set.as_ref().filter(|_| self.context.copies_depth)?.targets;
        let systems: Vec<_> = (0..).zip(&self.materials).map(|(key, _)| self.renderer.targets(key)).collect();
        let scene = [targets.depth.texture(), &targets.colour];
        Some(Capture::record(&self.context.device, encoder, scene, &systems))
    }

    /// The scene's view depth, `R32Float`, metres, on devices that can draw it.
    pub fn linear_depth(&self) -> Option<&wgpu::Texture> {
        self.set.as_ref()?.targets.linear.as_ref().map(wgpu::TextureView::texture)
    }

    /// Draws a shot's stage now, and tells how long the device took.
    ///
    /// # Errors
    /// As [`record`](Self::record); [`Error::Device`] when the device failed.
    pub fn draw(&mut self, gpu: &Headless, shot: &Shot) -> Result<Duration, Error> {
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.record(&mut encoder, shot, &[shot.shade_tree])?;
        let start = Instant::now();
        gpu.submit(encoder)?;
        Ok(start.elapsed())
    }

    /// Reads a shot's stage back, linear HDR; black if it was never drawn.
    ///
    /// # Errors
    /// [`Error::Device`] when the device failed.
    pub fn read(&self, gpu: &Headless, shot: &Shot) -> Result<Picture<Vec4>, Error> {
        let Some(picture) = self.picture(shot.shade_tree) else { return Ok(Picture::new(shot.size, Vec4::W)) };
        let size = UVec2::new(picture.width(), picture.height());
        Ok(Picture { size, texels: gpu.read_rgba16float(picture)? })
    }

    /// Puts pictures on the GPU that are not there yet.
    fn upload(&mut self, assets: &[MaterialAssets]) -> Result<(), Error> {
        self.materials.truncate(assets.len());
        for (index, assets) in assets.iter().enumerate() {
            match self.materials.get_mut(index) {
                Some(slot) if slot.assets.shares(assets) => {}
                Some(slot) => *slot = self.context.upload(assets)?,
                None => self.materials.push(self.context.upload(assets)?),
            }
        }
        Ok(())
    }
}

impl Set {
    fn size(&self) -> UVec2 {
        UVec2::new(self.targets.colour.width(), self.targets.colour.height())
    }

    fn bytes(&self) -> u64 {
        let bytes = |texture: &wgpu::Texture| {
            let texel = texture.format().block_copy_size(None).unwrap_or_default();
            u64::from(texel) * u64::from(texture.width()) * u64::from(texture.height())
        };
        self.targets.textures().chain(self.pictures.iter().flatten()).map(bytes).sum()
    }
}
