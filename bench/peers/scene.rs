//! Scene and measurement that all peers share, so that only the particles differ. Compiled into each peer, with its version
//! of Bevy.
//!
//! Squares that face the camera, larger than the image: each is one layer of fragments over every pixel. Each has an amount
//! of 0.1 or less and a normal map. Behind them are opaque boxes; the target holds half floats. Lamps light all of it,
//! without shadow.

use std::time::Duration;

use bevy::app::Plugins;
use bevy::asset::RenderAssetUsages;
use bevy::camera::{Hdr, RenderTarget};
use bevy::core_pipeline::tonemapping::{DebandDither, Tonemapping};
use bevy::diagnostic::DiagnosticsStore;
use bevy::ecs::system::RunSystemOnce;
use bevy::log::LogPlugin;
use bevy::prelude::*;
use bevy::render::diagnostic::RenderDiagnosticsPlugin;
use bevy::render::pipelined_rendering::PipelinedRenderingPlugin;
use bevy::render::render_resource::{Extent3d, PollType, TextureDimension, TextureFormat, TextureUsages};
use bevy::render::renderer::{RenderAdapterInfo, RenderDevice};
use bevy::render::view::Msaa;
use bevy::render::{RenderApp, RenderPlugin};
use bevy::time::TimeUpdateStrategy;
use bevy::window::ExitCondition;
use bevy::winit::WinitPlugin;

/// Numbers of layers that are measured; a layer costs the difference over their number.
pub const LAYERS: [u32; 2] = [16, 64];
/// Numbers of lamps.
pub const LIGHTS: [u32; 3] = [1, 8, 16];
/// Texels on a side of the sprite.
pub const SPRITE_SIZE: u32 = 128;
/// Half the side of each square, metres. At the distance of the farthest, 8 m, an image of 16 to 9 is 11.8 m wide.
pub const RADIUS: f32 = 6.2;
/// Frames after a change, until timestamps of the last case have been read and pipelines compiled.
const SETTLE: u32 = 12;
/// Frames that are measured in each round.
const FRAMES: u32 = 10;

/// Case of a peer: `variant` is its own.
#[derive(Clone, Copy, PartialEq)]
pub struct Case {
    pub variant: &'static str,
    pub layers: u32,
    pub lights: u32,
}

/// Command line: `[WIDTHxHEIGHT] [ROUNDS]`.
pub struct Options {
    pub size: UVec2,
    pub rounds: u32,
}

impl Options {
    pub fn from_arguments() -> Result<Self, String> {
        let mut this = Self { size: UVec2::new(1920, 1080), rounds: 5 };
        for (index, text) in std::env::args().skip(1).enumerate() {
            let error = || format!("{text}: expected WIDTHxHEIGHT, then the number of rounds");
            match index {
                0 => {
                    let (width, height) = text.split_once('x').ok_or_else(error)?;
                    let number = |text: &str| text.parse().ok().filter(|number| (16..=8192).contains(number));
                    let size = number(width).zip(number(height)).ok_or_else(error)?;
                    this.size = size.into();
                }
                1 => this.rounds = text.parse().ok().filter(|rounds| (1..=1000).contains(rounds)).ok_or_else(error)?,
                _ => return Err(error()),
            }
        }
        Ok(this)
    }
}

/// Bevy without a window, with the plugins of a peer, and a camera that draws into an image.
pub fn app<M>(options: &Options, plugins: impl Plugins<M>) -> (App, Entity) {
    let mut app = App::new();
    app.add_plugins(
        DefaultPlugins
            .build()
            .disable::<WinitPlugin>()
            .disable::<LogPlugin>()
            .disable::<PipelinedRenderingPlugin>()
            .set(WindowPlugin { primary_window: None, exit_condition: ExitCondition::DontExit, ..default() })
            .set(RenderPlugin { synchronous_pipeline_compilation: true, ..default() }),
    );
    app.add_plugins(RenderDiagnosticsPlugin).add_plugins(plugins);
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO));
    app.insert_resource(GlobalAmbientLight { brightness: 0.0, ..default() });
    while app.plugins_state() == bevy::app::PluginsState::Adding {
        bevy::tasks::tick_global_task_pools_on_main_thread();
    }
    app.finish();
    app.cleanup();

    let extent = Extent3d { width: options.size.x, height: options.size.y, depth_or_array_layers: 1 };
    let format = TextureFormat::Rgba16Float;
    let usages = RenderAssetUsages::default();
    let mut image = Image::new_fill(extent, TextureDimension::D2, &[0; 8], format, usages);
    image.texture_descriptor.usage = TextureUsages::TEXTURE_BINDING | TextureUsages::RENDER_ATTACHMENT;
    let target = app.world_mut().resource_mut::<Assets<Image>>().add(image);
    let target = RenderTarget::Image(target.into());
    let camera = (Camera3d::default(), Hdr, Msaa::Off, Tonemapping::None, DebandDither::Disabled, target);
    let camera = app.world_mut().spawn(camera).id();
    for (index, depth) in [-9.0, -11.0, -14.0].into_iter().enumerate() {
        let at = Transform::from_xyz(3.0 * (index as f32 - 1.0), -1.0, depth);
        let world = app.world_mut();
        let mesh = world.resource_mut::<Assets<Mesh>>().add(Cuboid::new(2.5, 3.0, 1.0));
        let material = world.resource_mut::<Assets<StandardMaterial>>().add(StandardMaterial::default());
        world.spawn((Mesh3d(mesh), MeshMaterial3d(material), at));
    }
    (app, camera)
}

/// Centers of the squares, far to near.
pub fn centers(layers: u32) -> impl Iterator<Item = Vec3> {
    (0..layers).map(move |index| Vec3::new(0.0, 0.0, -8.0 + 2.0 * index as f32 / layers as f32))
}

/// Normal (0 to 1 in each direction) and amount of a texel of the sprite: bumps in a sheet that is nowhere clear.
pub fn texel(index: u32) -> ([u8; 3], u8) {
    let [u, v] = [index % SPRITE_SIZE, index / SPRITE_SIZE].map(|at| (at as f32 + 0.5) / SPRITE_SIZE as f32);
    let x = 0.4 * (19.0 * u).cos();
    let y = 0.4 * (23.0 * v).sin();
    let normal = Vec3::new(x, y, (1.0 - x * x - y * y).sqrt());
    let byte = |value: f32| (value * 255.0).round() as u8;
    let amount = 0.07 + 0.03 * (13.0 * u).sin() * (11.0 * v).cos();
    ((0.5 * normal + 0.5).to_array().map(byte), byte(amount))
}

/// Lamps in a ring before the squares. Together, they have the light of one.
fn light(app: &mut App, count: u32) {
    let world = app.world_mut();
    let old: Vec<_> = world.query_filtered::<Entity, With<PointLight>>().iter(world).collect();
    for lamp in old {
        world.despawn(lamp);
    }
    for index in 0..count {
        let angle = 2.4 * index as f32;
        let at = Transform::from_xyz(3.0 * angle.cos(), 2.0 * angle.sin(), -4.0);
        let lamp = PointLight { intensity: 2.0e6 / count as f32, range: 60.0, radius: 0.1, ..default() };
        world.spawn((lamp, at));
    }
}

/// Measures all cases in turn, round by round. `change` places the squares of a case. `spans`: names of the peer's passes,
/// whose GPU times are added up.
pub fn measure(
    mut app: App,
    options: &Options,
    variants: &[&'static str],
    spans: &[&str],
    mut change: impl FnMut(&mut App, Case),
) -> Result<(), String> {
    let cases: Vec<_> = variants
        .iter()
        .flat_map(|&variant| LIGHTS.map(|lights| LAYERS.map(|layers| Case { variant, layers, lights })))
        .flatten()
        .collect();
    let mut times = vec![Vec::new(); cases.len()];
    // The first round warms up.
    for round in 0..=options.rounds {
        for (case, times) in cases.iter().zip(&mut times) {
            light(&mut app, case.lights);
            change(&mut app, *case);
            for frame in 0..SETTLE + FRAMES {
                app.update();
                // Without a window, nothing else waits for the GPU: times would arrive frames later, or never.
                let device = app.sub_app(RenderApp).world().resource::<RenderDevice>();
                if let Err(error) = device.poll(PollType::wait_indefinitely()) {
                    return Err(format!("the device does not finish a frame: {error}"));
                }
                let time = app
                    .world_mut()
                    .run_system_once_with(pass_time, spans.iter().map(|name| name.to_string()).collect());
                if let (true, Ok(Some(time))) = (round > 0 && frame >= SETTLE, time) {
                    times.push(time);
                }
            }
        }
    }

    if let Some(index) = times.iter().position(Vec::is_empty) {
        let Case { variant, layers, lights } = cases[index];
        return Err(format!(
            "{variant}, {lights} lights, {layers} layers: no GPU times; the device needs timestamps in passes"
        ));
    }
    let adapter = app.sub_app(RenderApp).world().resource::<RenderAdapterInfo>();
    let UVec2 { x: width, y: height } = options.size;
    println!("{} ({}), {width}x{height}, {} rounds", adapter.name, adapter.driver_info, options.rounds);
    println!(
        "{:<14} {:>6} {:>6} {:>10} {:>18} {:>6}",
        "variant", "lights", "layers", "median ms", "quartiles ms", "frames"
    );
    let mut medians = Vec::new();
    for (case, times) in cases.iter().zip(&mut times) {
        times.sort_by(f64::total_cmp);
        let at = |fraction: f64| {
            times.get((fraction * times.len().saturating_sub(1) as f64) as usize).copied().unwrap_or(f64::NAN)
        };
        let Case { variant, layers, lights } = case;
        let quartiles = format!("{:.4} to {:.4}", at(0.25), at(0.75));
        println!("{variant:<14} {lights:>6} {layers:>6} {:>10.4} {quartiles:>18} {:>6}", at(0.5), times.len());
        medians.push(at(0.5));
    }
    println!("\nGPU time of one more layer, microseconds, and of a frame before the first layer, milliseconds:");
    for (pair, cases) in medians.chunks_exact(2).zip(cases.chunks_exact(2)) {
        let layer = (pair[1] - pair[0]) / f64::from(LAYERS[1] - LAYERS[0]);
        let first = pair[0] - layer * f64::from(LAYERS[0]);
        println!("{:<14} {:>6} {:>10.2} {:>10.4}", cases[0].variant, cases[0].lights, 1000.0 * layer, first);
    }
    Ok(())
}

/// GPU time of the passes with these names in a recent frame, milliseconds.
fn pass_time(In(spans): In<Vec<String>>, store: Res<DiagnosticsStore>) -> Option<f64> {
    let time = |span: &String| {
        let ending = format!("/{span}/elapsed_gpu");
        store.iter().find(|diagnostic| diagnostic.path().as_str().ends_with(&ending))?.value()
    };
    spans.iter().map(time).sum()
}
