//! Measurement of both accumulation paths on a device, by a few small frames.

use std::time::{Duration, Instant};

use haze_core::assets::material_assets::MaterialAssets;
use haze_core::error::PrepareError;
use haze_core::frame::{Particle, View};
use haze_core::glam::camera::rh::proj::directx::perspective;
use haze_core::glam::{Mat4, UVec2, Vec3};
use haze_core::settings::{RenderPath, Settings, Traversal};

use super::Renderer;
use super::auto::{PathCosts, PathModel, PathWorkload};
use super::context::Context;
use super::descriptor::RendererDescriptor;
use super::gpu::record::{begin_pass, written_depth};
use crate::frame::{FrameInput, Material, ParticleSystem, Particles, SceneDepth};

/// Test scene: `SPRITES` sprites, one behind the other, each covering an image of `SIZE` pixels.
const SIZE: UVec2 = UVec2::splat(256);
const SPRITES: u32 = 16;
/// Minimum time of a measured frame. It is also at least `MIN_TIME_FACTOR` times the time of a frame that draws all
/// sprites once. Jitter of clock and queue is small against it.
const MIN_FRAME_TIME: Duration = Duration::from_millis(4);
const MIN_TIME_FACTOR: u32 = 2;
/// Maximum number of times that a frame draws all sprites.
const MAX_LOOPS: u32 = 4096;
/// Frames measured per path and loop count. The shortest counts, because disturbances only lengthen a frame; many short
/// frames are likely to include an undisturbed one.
const ROUNDS: u32 = 8;
/// Frames measured per step of the search for the loop count.
const SEARCH_ROUNDS: u32 = 3;

impl Context {
    /// Measures the cost of both accumulation paths on this device for the path `auto`, and sets the result as the
    /// [`path_model`](Self::path_model). Renders about fifty small frames: about 0.2 s on a GPU, 2 to 3 s on a software
    /// adapter. Call it when the program starts, or save the result between runs. A device without the path `tiled`
    /// keeps its model.
    ///
    /// haze never submits commands: `submit` must submit the encoder and wait until the device has finished.
    ///
    /// # Errors
    /// Those of [`Renderer::prepare`] and of `submit`.
    pub fn measure_paths<E: From<PrepareError>>(
        &self,
        mut submit: impl FnMut(wgpu::CommandEncoder) -> Result<(), E>,
    ) -> Result<PathModel, E> {
        if self.shared().tiles().is_none() {
            return Ok(self.path_model());
        }
        let class = PathModel::for_device_type(self.device().adapter_info().device_type);
        let mut scene = ProbeScene::new(self)?;
        let seconds = scene.seconds(&mut submit)?;
        let workload = scene.workload();
        let times = |costs: PathCosts, seconds: f64| {
            // Expected time of one pass over all sprites, without the costs per frame.
            let expected = costs.milliseconds(&workload, 1.0)
                - costs.milliseconds(&PathWorkload { fragments: 0.0, sprites: 0.0, ..workload }, 1.0);
            (1.0e3 * seconds) as f32 / expected
        };
        let model = class.scaled_by_probe([times(class.raster, seconds[0]), times(class.tiled, seconds[1])]);
        self.set_path_model(model)?;
        Ok(model)
    }
}

const PATHS: [RenderPath; 2] = [RenderPath::Raster, RenderPath::Tiled];

/// Renderer and test scene of the measurement.
struct ProbeScene {
    renderer: Renderer,
    material: Material,
    depth: wgpu::TextureView,
    view: View,
    particles: Vec<Particle>,
}

impl ProbeScene {
    fn new(context: &Context) -> Result<Self, PrepareError> {
        let renderer = Renderer::new(context, &RendererDescriptor::default())?;
        let material = context.create_material(&MaterialAssets::default())?;
        let depth = context.device().create_texture(&wgpu::TextureDescriptor {
            label: Some("haze probe depth"),
            size: wgpu::Extent3d { width: SIZE.x, height: SIZE.y, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Depth32Float,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let sprite = |index: u32| Particle {
            position: Vec3::new(0.0, 0.0, -4.0 - 0.01 * index as f32),
            radius: 4.0,
            amount: 0.002,
            rotation: index as f32,
            ..Particle::default()
        };
        Ok(Self {
            renderer,
            material,
            depth: depth.create_view(&wgpu::TextureViewDescriptor::default()),
            view: View::new(Mat4::IDENTITY, perspective(std::f32::consts::FRAC_PI_2, 1.0, 0.1, 100.0), SIZE),
            particles: (0..SPRITES).map(sprite).collect(),
        })
    }

    /// Returns the workload of the last frame, which drew all sprites once.
    fn workload(&self) -> PathWorkload {
        let fragments = self.renderer.overdraw().fragments;
        PathWorkload::new(Settings::default().technique, SIZE, f64::from(SPRITES), fragments)
    }

    /// Measures one pass over all sprites by `raster` and by `tiled`, in seconds.
    fn seconds<E: From<PrepareError>>(
        &mut self,
        submit: &mut impl FnMut(wgpu::CommandEncoder) -> Result<(), E>,
    ) -> Result<[f64; 2], E> {
        let mut loops = [2; 2];
        for (path, loops) in PATHS.into_iter().zip(&mut loops) {
            // The first frame compiles pipelines and is not measured.
            self.frame(path, 1, submit)?;
            let enough = MIN_FRAME_TIME.max(MIN_TIME_FACTOR * self.frame(path, 1, submit)?);
            while *loops < MAX_LOOPS && self.shortest(path, *loops, submit)? < enough {
                *loops *= 2;
            }
        }
        let mut shortest = [[Duration::MAX; 2]; 2];
        for _ in 0..ROUNDS {
            for ((path, loops), shortest) in PATHS.into_iter().zip(loops).zip(&mut shortest) {
                for (times, shortest) in [loops, 1].into_iter().zip(shortest) {
                    *shortest = self.frame(path, times, submit)?.min(*shortest);
                }
            }
        }
        Ok([0, 1].map(|way| {
            let more = shortest[way][0].saturating_sub(shortest[way][1]);
            // The clock may be too coarse to advance.
            more.max(Duration::from_nanos(1)).as_secs_f64() / f64::from(loops[way] - 1)
        }))
    }

    /// Returns the time of the shortest of a few frames: a single delayed frame could pass for a long one.
    fn shortest<E: From<PrepareError>>(
        &mut self,
        path: RenderPath,
        loops: u32,
        submit: &mut impl FnMut(wgpu::CommandEncoder) -> Result<(), E>,
    ) -> Result<Duration, E> {
        let mut shortest = Duration::MAX;
        for _ in 0..SEARCH_ROUNDS {
            shortest = shortest.min(self.frame(path, loops, submit)?);
        }
        Ok(shortest)
    }

    /// Draws all sprites `loops` times. Returns the time from submission to completion.
    fn frame<E: From<PrepareError>>(
        &mut self,
        path: RenderPath,
        loops: u32,
        submit: &mut impl FnMut(wgpu::CommandEncoder) -> Result<(), E>,
    ) -> Result<Duration, E> {
        let mut settings = Settings { path, ..Settings::default() };
        settings.debug.draw_count = loops;
        settings.accumulate.downscale = 1;
        // Without early stops of the traversal, the time does not depend on the sprites' opacity.
        settings.accumulate.layers = Traversal::All;
        let mut encoder =
            self.renderer.context().device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        drop(begin_pass(&mut encoder, "haze probe", &[], Some(written_depth(&self.depth)), None));
        let systems = [ParticleSystem::new(0, Particles::Slice(&self.particles), &settings, &self.material)];
        let frame = FrameInput { systems: &systems, ..FrameInput::new(self.view, SceneDepth::Buffer(&self.depth)) };
        self.renderer.prepare(&mut encoder, &frame)?;
        let started = Instant::now();
        submit(encoder)?;
        Ok(started.elapsed())
    }
}
