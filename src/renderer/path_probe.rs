//! What the two ways to accumulate take on a device, measured by a few small frames.

use std::path::Path as FilePath;
use std::time::{Duration, Instant};

use glam::camera::rh::proj::directx::perspective;
use glam::{Mat4, UVec2, Vec3};

use super::Renderer;
use super::auto::{PathCosts, PathLoad, PathModel};
use super::context::Context;
use super::descriptor::Descriptor;
use super::gpu::record::{begin_pass, written_depth};
use crate::error::Error;
use crate::frame::{Frame, Material, Particle, Particles, SceneDepth, System, View};
use crate::preset::MaterialNames;
use crate::settings::{Layers, Path, Settings};

/// What is drawn: sprites one behind the other, each as large as the picture.
const SIZE: UVec2 = UVec2::splat(256);
const SPRITES: u32 = 16;
/// Against which a clock's and a queue's own unsteadiness is small; and so many times what a frame takes in which all is drawn once.
const LONG_ENOUGH: Duration = Duration::from_millis(4);
const MORE_THAN_ONCE: u32 = 2;
/// Times that all sprites are drawn, at the most.
const MOST_LOOPS: u32 = 4096;
/// Times that each is measured; the shortest counts, as what disturbs only lengthens. Many short ones find a quiet moment.
const ROUNDS: u32 = 8;
/// And before that, to find how often it must be drawn.
const FEW: u32 = 3;

impl Context {
    /// Measures what the two ways to accumulate take on this device, for the path `auto`, and sets it as its
    /// [`path_model`](Self::path_model): some fifty small frames, a fifth of a second on a GPU, and two or three seconds where a CPU draws.
    /// Do it when the program starts, or keep what it found from run to run. A device without the path `tiled` keeps what it has.
    ///
    /// haze never submits: `submit` does, and waits until the device is done.
    ///
    /// # Errors
    /// As [`Renderer::prepare`], and those of `submit`.
    pub fn measure_paths(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        mut submit: impl FnMut(wgpu::CommandEncoder) -> Result<(), Error>,
    ) -> Result<PathModel, Error> {
        if self.shared().tiles().is_none() {
            return Ok(self.path_model());
        }
        let class = PathModel::of_class(device.adapter_info().device_type);
        let mut bench = Bench::new(self, device, queue)?;
        let seconds = bench.seconds(&mut submit)?;
        let load = bench.load();
        let times = |costs: PathCosts, seconds: f64| {
            // Of a pass over all sprites, without what comes once a frame.
            let expected = costs.milliseconds(&load, 1.0)
                - costs.milliseconds(&PathLoad { fragments: 0.0, sprites: 0.0, ..load }, 1.0);
            (1.0e3 * seconds) as f32 / expected
        };
        let model = class.probed([times(class.raster, seconds[0]), times(class.tiled, seconds[1])]);
        self.set_path_model(model)?;
        Ok(model)
    }
}

const PATHS: [Path; 2] = [Path::Raster, Path::Tiled];

/// What draws.
struct Bench<'a> {
    device: &'a wgpu::Device,
    queue: &'a wgpu::Queue,
    renderer: Renderer,
    material: Material,
    depth: wgpu::TextureView,
    view: View,
    particles: Vec<Particle>,
}

impl<'a> Bench<'a> {
    fn new(context: &Context, device: &'a wgpu::Device, queue: &'a wgpu::Queue) -> Result<Self, Error> {
        let descriptor = Descriptor { context: Some(context), ..Descriptor::default() };
        let renderer = Renderer::new(device, queue, &descriptor)?;
        let material = renderer.create_material(device, queue, &MaterialNames::default().load(FilePath::new(""))?)?;
        let depth = device.create_texture(&wgpu::TextureDescriptor {
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
            device,
            queue,
            renderer,
            material,
            depth: depth.create_view(&wgpu::TextureViewDescriptor::default()),
            view: View::new(Mat4::IDENTITY, perspective(std::f32::consts::FRAC_PI_2, 1.0, 0.1, 100.0), SIZE),
            particles: (0..SPRITES).map(sprite).collect(),
        })
    }

    /// Of the last frame, in which all sprites were drawn once.
    fn load(&self) -> PathLoad {
        PathLoad {
            technique: Settings::default().technique,
            sprites: f64::from(SPRITES),
            fragments: self.renderer.overdraw().fragments,
            size: SIZE,
            optical_depth: 0.0,
            lookups: 0.0,
            is_assumed: false,
        }
    }

    /// Seconds of a pass over all sprites, by either path.
    fn seconds(
        &mut self,
        submit: &mut impl FnMut(wgpu::CommandEncoder) -> Result<(), Error>,
    ) -> Result<[f64; 2], Error> {
        let mut loops = [2; 2];
        for (path, loops) in PATHS.into_iter().zip(&mut loops) {
            // The first frame compiles.
            self.frame(path, 1, submit)?;
            let enough = LONG_ENOUGH.max(MORE_THAN_ONCE * self.frame(path, 1, submit)?);
            while *loops < MOST_LOOPS && self.shortest(path, *loops, submit)? < enough {
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
            // A clock may stand still.
            more.max(Duration::from_nanos(1)).as_secs_f64() / f64::from(loops[way] - 1)
        }))
    }

    /// Of a few frames: one that something held up would look long enough.
    fn shortest(
        &mut self,
        path: Path,
        loops: u32,
        submit: &mut impl FnMut(wgpu::CommandEncoder) -> Result<(), Error>,
    ) -> Result<Duration, Error> {
        let mut shortest = Duration::MAX;
        for _ in 0..FEW {
            shortest = shortest.min(self.frame(path, loops, submit)?);
        }
        Ok(shortest)
    }

    /// Draws all sprites so many times, and tells how long that took.
    fn frame(
        &mut self,
        path: Path,
        loops: u32,
        submit: &mut impl FnMut(wgpu::CommandEncoder) -> Result<(), Error>,
    ) -> Result<Duration, Error> {
        let mut settings = Settings { path, ..Settings::default() };
        settings.sprite.debug_loop = loops;
        settings.accumulate.scale = 1;
        // What shines through is all the same to a walk that does not stop.
        settings.accumulate.layers = Layers::All;
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        drop(begin_pass(&mut encoder, "haze probe", &[], Some(written_depth(&self.depth)), None));
        let systems = [System::new(Particles::Slice(&self.particles), &settings, &self.material)];
        let frame = Frame { systems: &systems, ..Frame::new(self.view, SceneDepth::Buffer(&self.depth)) };
        self.renderer.prepare(self.device, self.queue, &mut encoder, &frame)?;
        let started = Instant::now();
        submit(encoder)?;
        Ok(started.elapsed())
    }
}
