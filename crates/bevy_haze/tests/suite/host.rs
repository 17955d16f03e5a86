//! Bevy without a window: renders a scene into an image and reads it.

use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use bevy::asset::{AssetPlugin, RenderAssetUsages};
use bevy::camera::{Exposure, Hdr, RenderTarget};
use bevy::core_pipeline::tonemapping::{DebandDither, Tonemapping};
use bevy::light::NotShadowCaster;
use bevy::log::LogPlugin;
use bevy::prelude::*;
use bevy::render::diagnostic::RenderDiagnosticsPlugin;
use bevy::render::pipelined_rendering::PipelinedRenderingPlugin;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat, TextureUsages};
use bevy::render::renderer::RenderAdapter;
use bevy::render::view::Msaa;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};
use bevy::render::{RenderApp, RenderPlugin};
use bevy::time::TimeUpdateStrategy;
use bevy::window::ExitCondition;
use bevy::winit::WinitPlugin;
use bevy_haze::haze::preset::Preset;
use bevy_haze::{Smoke, SmokeAsset, SmokeClock, SmokePlugin};

use crate::picture::Picture;

pub const SIZE: UVec2 = UVec2::new(320, 180);
/// Time of the smoke, seconds.
pub const SECONDS: f64 = 12.0;
/// Smallest exposure value at which a lamp of some thousand lumens looks well lit.
pub const EXPOSURE: Exposure = Exposure { ev100: 7.0 };
pub const CAMERA: Vec3 = Vec3::new(0.6, 1.8, 7.0);
pub const TARGET: Vec3 = Vec3::new(0.3, 1.6, 0.0);

/// Boxes of the scene: center, size, color of their own light.
pub const BOXES: [(Vec3, Vec3, [f32; 3]); 2] = [
    (Vec3::new(0.0, -0.1, 0.0), Vec3::new(12.0, 0.2, 12.0), [0.18, 0.17, 0.16]),
    (Vec3::new(0.9, 0.6, 0.7), Vec3::new(0.9, 1.2, 0.9), [0.12, 0.22, 0.14]),
];
pub const BACKGROUND: [f32; 3] = [0.02, 0.03, 0.05];

/// Smoke of the tests: a plume that built-in presets do not change.
pub fn plume() -> SmokeAsset {
    let preset = Preset::parse("plume.json".as_ref(), include_str!("plume.json")).unwrap();
    let mut asset = SmokeAsset::builtin("column").unwrap();
    asset.systems[0].images = preset.load_materials("plume.json".as_ref()).unwrap().remove(0);
    asset.systems[0].preset = preset.systems.into_iter().next().unwrap();
    asset.animation.clear();
    asset
}

/// App that draws into [`Host::target`].
pub struct Host {
    pub app: App,
    pub target: Handle<Image>,
}

/// Bevy, with assets from this folder. No time passes.
pub fn host(assets: &std::path::Path) -> Host {
    let mut app = App::new();
    app.add_plugins(
        DefaultPlugins
            .build()
            .disable::<WinitPlugin>()
            .disable::<LogPlugin>()
            .disable::<PipelinedRenderingPlugin>()
            .set(AssetPlugin { file_path: assets.to_string_lossy().into_owned(), ..default() })
            .set(WindowPlugin { primary_window: None, exit_condition: ExitCondition::DontExit, ..default() })
            .set(RenderPlugin { synchronous_pipeline_compilation: true, ..default() }),
    );
    app.add_plugins((SmokePlugin, RenderDiagnosticsPlugin));
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO));
    let [r, g, b] = BACKGROUND;
    app.insert_resource(ClearColor(Color::linear_rgb(r, g, b)));
    while app.plugins_state() == bevy::app::PluginsState::Adding {
        bevy::tasks::tick_global_task_pools_on_main_thread();
    }
    app.finish();
    app.cleanup();
    let target = app.world_mut().resource_mut::<Assets<Image>>().add(half_image());
    Host { app, target }
}

/// Image that holds linear light.
fn half_image() -> Image {
    let size = Extent3d { width: SIZE.x, height: SIZE.y, depth_or_array_layers: 1 };
    let mut image =
        Image::new_fill(size, TextureDimension::D2, &[0; 8], TextureFormat::Rgba16Float, RenderAssetUsages::default());
    image.texture_descriptor.usage =
        TextureUsages::TEXTURE_BINDING | TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC;
    image
}

impl Host {
    /// Another image to draw into.
    pub fn new_target(&mut self) -> Handle<Image> {
        self.app.world_mut().resource_mut::<Assets<Image>>().add(half_image())
    }

    /// Camera of the scene, HDR and not tonemapped.
    pub fn camera(&mut self) -> Entity {
        let target = RenderTarget::Image(self.target.clone().into());
        let transform = Transform::from_translation(CAMERA).looking_at(TARGET, Vec3::Y);
        let camera = (Camera3d::default(), Hdr, target, transform, EXPOSURE, Tonemapping::None, Msaa::Off);
        self.app.world_mut().spawn((camera, DebandDither::Disabled)).id()
    }

    /// Boxes that shine by themselves, so that both renderers know their color.
    pub fn boxes(&mut self) {
        for (center, size, [r, g, b]) in BOXES {
            let material = StandardMaterial { base_color: Color::linear_rgb(r, g, b), unlit: true, ..default() };
            let world = self.app.world_mut();
            let mesh = world.resource_mut::<Assets<Mesh>>().add(Cuboid::from_size(size));
            let material = world.resource_mut::<Assets<StandardMaterial>>().add(material);
            world.spawn((Mesh3d(mesh), MeshMaterial3d(material), Transform::from_translation(center)));
        }
    }

    /// A lamp on the left, a spot on the right, a faint sun.
    pub fn lights(&mut self) {
        let world = self.app.world_mut();
        let (position, color, intensity) = LAMP;
        let lamp = PointLight { color: linear(color), intensity, range: RANGE, radius: RADIUS, ..default() };
        world.spawn((lamp, Transform::from_translation(position)));
        let (position, color, intensity) = SPOT;
        let [inner_angle, outer_angle] = SPOT_ANGLES;
        let color = linear(color);
        let range = RANGE;
        let radius = RADIUS;
        let spot = SpotLight { color, intensity, range, radius, inner_angle, outer_angle, ..default() };
        world.spawn((spot, Transform::from_translation(position).looking_at(TARGET, Vec3::Y)));
        let (position, illuminance) = SUN;
        let sun = DirectionalLight { illuminance, ..default() };
        world.spawn((sun, Transform::from_translation(position).looking_at(Vec3::ZERO, Vec3::Y)));
        world.insert_resource(GlobalAmbientLight { brightness: AMBIENT, ..default() });
    }

    /// Plume at the origin, held at [`SECONDS`]. It does not shade meshes: the boxes shine by themselves.
    pub fn smoke(&mut self) -> Entity {
        let world = self.app.world_mut();
        let asset = world.resource_mut::<Assets<SmokeAsset>>().add(plume());
        world.spawn((Smoke::from(asset), SmokeClock::paused_at(SECONDS), NotShadowCaster)).id()
    }

    /// Scene with one camera. Returns camera and smoke.
    pub fn scene(&mut self) -> [Entity; 2] {
        let camera = self.camera();
        self.boxes();
        self.lights();
        [camera, self.smoke()]
    }

    /// True if the device can draw with so many samples. Mesa's lavapipe has 1 and 4.
    pub fn supports(&self, msaa: Msaa) -> bool {
        let adapter = self.app.sub_app(RenderApp).world().resource::<RenderAdapter>();
        let flags = adapter.get_texture_format_features(TextureFormat::Rgba16Float).flags;
        flags.sample_count_supported(msaa.samples())
    }

    pub fn update(&mut self, frames: u32) {
        (0..frames).for_each(|_| self.app.update());
    }

    /// Renders some frames, for assets to arrive and depths to settle, and reads the last.
    pub fn picture(&mut self) -> Picture {
        self.update(4);
        let (sender, receiver) = channel();
        let shot = Screenshot::image(self.target.clone());
        self.app.world_mut().spawn(shot).observe(move |captured: On<ScreenshotCaptured>| {
            let bytes = captured.image.data.clone().unwrap_or_default();
            // The receiver waits until it has the picture.
            let _ = sender.send(bytes);
        });
        let picture = Picture::from_half(SIZE.x, SIZE.y, &self.wait_for(&receiver));
        save(&picture);
        picture
    }

    fn wait_for<T>(&mut self, receiver: &Receiver<T>) -> T {
        let started = Instant::now();
        while started.elapsed() < Duration::from_secs(60) {
            self.app.update();
            if let Ok(value) = receiver.try_recv() {
                return value;
            }
        }
        panic!("no picture after a minute");
    }
}

/// Lamp: position, color, lumens.
pub const LAMP: (Vec3, [f32; 3], f32) = (Vec3::new(-3.0, 3.0, 2.5), [1.0, 0.7, 0.45], 60_000.0);
/// Spot: position, color, lumens. It shines at [`TARGET`].
pub const SPOT: (Vec3, [f32; 3], f32) = (Vec3::new(3.5, 4.0, 2.0), [0.5, 0.7, 1.0], 90_000.0);
/// Half angles of the spot's core and edge, radians.
pub const SPOT_ANGLES: [f32; 2] = [0.2, 0.5];
/// Sun: position from which it shines at the origin, lux.
pub const SUN: (Vec3, f32) = (Vec3::new(1.0, 3.0, -2.0), 80.0);
/// Ambient light, cd/m².
pub const AMBIENT: f32 = 20.0;
pub const RANGE: f32 = 30.0;
pub const RADIUS: f32 = 0.1;

fn linear([r, g, b]: [f32; 3]) -> Color {
    Color::linear_rgb(r, g, b)
}

/// With `BEVY_HAZE_PICTURES=FOLDER`, saves every picture as displayed, numbered within its test.
fn save(picture: &Picture) {
    static NUMBER: AtomicU32 = AtomicU32::new(0);
    let Some(folder) = std::env::var_os("BEVY_HAZE_PICTURES") else { return };
    let number = NUMBER.fetch_add(1, Ordering::Relaxed);
    let thread = std::thread::current();
    let name = thread.name().unwrap_or("picture").replace("::", ".");
    picture.save(&std::path::Path::new(&folder).join(format!("{name}.{number:02}.png")));
}
