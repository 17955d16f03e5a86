//! A small test scene in memory: camera, lights, sprites, and a wall and a post as scene depth. `test_host.rs` draws it on
//! the GPU.

use std::sync::LazyLock;

use glam::camera::rh;
use glam::{Mat4, UVec2, UVec3, Vec2, Vec3, Vec4, vec3};
use haze::{Bounds, FieldError, Light, MaterialAssets, Particle, ShadowProjection, View};
use haze_author::noise_recipe::NoiseRecipe;
use haze_author::sprite::six_way::six_way_layout;
use haze_core::assets::image::Image;
use haze_core::assets::noise::{NoiseVolume, pcg3d, unit};
use haze_core::assets::ramp::Ramp;
use haze_core::assets::sprite::{Sprite, SpriteLayout};
use haze_core::settings::*;

use crate::gpu::gpu;
use crate::psnr::{MIN_PSNR, psnr};
use crate::test_host::HostKind;

/// All inputs of a frame, in memory.
#[derive(Clone)]
pub struct TestScene {
    pub view: View,
    /// Viewing direction along z of view space: -1 or 1.
    pub view_direction_z: f32,
    pub lights: Vec<Light>,
    pub shadow_maps: Vec<TestShadowMap>,
    /// Shades the backdrop by the smoke, with this ambient light.
    pub scene_ambient: Option<Vec3>,
    pub particles: Vec<Particle>,
    /// Particles and settings of further systems.
    pub others: Vec<(Vec<Particle>, Settings)>,
    pub bounds: Option<Bounds>,
    pub settings: Settings,
    pub material: MaterialAssets,
    pub world_from_particles: Mat4,
    pub exposure: f32,
    pub time: f64,
    pub up: Vec3,
    /// Debug view that is drawn.
    pub debug_view: DebugView,
    /// Debug views that the renderer prepares; only the one that is drawn if `None`.
    pub debug_views: Option<&'static [DebugView]>,
    /// Kind of scene depth that the renderer gets.
    pub depth: DepthKind,
    /// The wall covers the whole image, without the post.
    pub wall_everywhere: bool,
    /// The linear depth target is empty: sky everywhere.
    pub empty_linear: bool,
    /// Attaches the depth buffer to the host's pass that draws the smoke.
    pub attach_depth: bool,
    /// Formats and layout of the host's pass and targets on the GPU.
    pub host: HostKind,
}

/// Shadow map of a light, in memory.
#[derive(Clone)]
pub struct TestShadowMap {
    pub light: usize,
    pub layers: Vec<Image<f32>>,
    pub clip_from_world: Vec<Mat4>,
    pub reversed: bool,
}

impl TestShadowMap {
    pub fn projection(&self) -> ShadowProjection<'_> {
        let Self { light, clip_from_world, reversed, .. } = self;
        ShadowProjection { light: *light, clip_from_world, reversed: *reversed, bias: 0.0 }
    }
}

/// Kinds of scene depth that a host can pass to the renderer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthKind {
    Buffer,
    /// For hosts with several samples.
    Multisampled,
    Linear,
    Both,
}

/// Scene color behind the smoke: far from the color of any lit sprite, exact in f16, and translucent, so that the
/// smoke's own alpha shows.
pub const BACKDROP: Vec4 = Vec4::new(0.125, 0.25, 0.5, 0.25);

pub fn perspective(size: UVec2) -> Mat4 {
    rh::proj::directx::perspective(0.8, size.x as f32 / size.y as f32, 0.1, 80.0)
}

/// A soft ball off the sprite's center. `y_down` is the convention that the sprite declares for its normals.
pub fn ball_sprite(y_down: bool) -> Sprite {
    let image = image::RgbaImage::from_fn(64, 64, |x, y| {
        let p = (Vec2::new(x as f32, 63.0 - y as f32) + 0.5) / 32.0 - 1.0;
        // Off-center and tilted, so that a rotated or flipped sprite looks different.
        let p = p - Vec2::new(0.1, 0.05);
        let inside = (1.0 - p.length_squared() * 1.4).max(0.0);
        let normal = (p * 1.5 + Vec2::new(0.2, -0.1)).extend(inside.sqrt().max(0.05)).normalize() * 0.5 + 0.5;
        let channel = |value: f32| (value * 255.0).round() as u8;
        image::Rgba([channel(normal.x), channel(normal.y), channel(normal.z), channel(inside.sqrt())])
    });
    Sprite::from_image(std::path::Path::new("ball"), &image, SpriteLayout { y_down, ..SpriteLayout::default() })
        .unwrap()
}

/// Detail map that bulges in the middle and moves to the upper right.
fn ball_detail() -> Sprite {
    let image = image::RgbaImage::from_fn(32, 32, |x, y| {
        let p = (Vec2::new(x as f32, 31.0 - y as f32) + 0.5) / 16.0 - 1.0;
        let inside = (1.0 - 1.2 * p.length_squared()).max(0.0);
        image::Rgba([(128.0 + 100.0 * inside) as u8, 168, 88, (inside * 255.0) as u8])
    });
    Sprite::from_image(std::path::Path::new("ball.detail"), &image, SpriteLayout::default()).unwrap()
}

/// Six-way maps of a sprite: lit along its normals, a little from behind, and more strongly from the left.
pub fn six_way_of(sprite: &Sprite) -> Sprite {
    let size = sprite.size();
    let frames = sprite.frame_count();
    let image = image::RgbaImage::from_fn(size, 2 * frames * size, |x, y| {
        let texel = sprite.texel(0, y / size % frames, x, y % size);
        let normal = texel.truncate() * 2.0 - 1.0;
        let light = if y / size < frames { normal } else { normal * vec3(-1.3, -0.8, -1.0) + vec3(0.0, 0.0, 0.3) };
        let code = (light * 0.5 + 0.1).clamp(Vec3::ZERO, Vec3::ONE).map(f32::sqrt);
        image::Rgba(code.extend(texel.w).to_array().map(|channel| (channel * 255.0).round() as u8))
    });
    let layout = six_way_layout(SpriteLayout { rows: frames, ..SpriteLayout::default() });
    Sprite::from_image(std::path::Path::new("six_way"), &image, layout).unwrap()
}

fn recipe_noise() -> NoiseVolume {
    let recipe = NoiseRecipe { version: 1, seed: 3, size: 16, cells: 2, octaves: 3, gain: 0.5 };
    NoiseVolume::from_image(std::path::Path::new("noise"), &recipe.bake().unwrap()).unwrap()
}

/// Material of the test cloud. Baked once, because most tests use it.
pub fn material() -> MaterialAssets {
    static MATERIAL: LazyLock<MaterialAssets> = LazyLock::new(baked_material);
    MATERIAL.clone()
}

fn baked_material() -> MaterialAssets {
    let line =
        |from: Vec3, to: Vec3| Ramp::from_linear(UVec2::new(16, 1), (0..16).map(|i| from.lerp(to, i as f32 / 15.0)));
    let glow = |i: u32| Vec3::splat((1.0 - (i % 16) as f32 / 15.0) * (i / 16) as f32 / 7.0);
    let dim = |i: u32| vec3(0.9, 0.7, 0.5).powf(0.4 * (i % 16) as f32) * (1.0 - (i / 16) as f32 / 8.0);
    let rim = |i: u32| vec3(0.8, 0.5, 0.3) * (1.2 - (i % 16) as f32 / 15.0) * (1.0 - (i / 16) as f32 / 4.0);
    MaterialAssets {
        sprite: ball_sprite(false),
        detail: Some(ball_detail()),
        six_way: Some(six_way_of(&ball_sprite(false))),
        noise: recipe_noise(),
        diffuse_ramp: line(Vec3::splat(0.05), Vec3::ONE),
        backlight_ramp: Ramp::from_linear(UVec2::new(16, 4), (0..64).map(rim)),
        shadow_ramp: Ramp::from_linear(UVec2::new(16, 4), (0..64).map(dim)),
        soft_scatter_ramp: line(Vec3::splat(0.3), Vec3::ZERO),
        specular_ramp: Ramp::from_linear(UVec2::new(16, 8), (0..128).map(glow)),
        motif: line(Vec3::ZERO, Vec3::ONE),
        coverage_ramp: Ramp::from_linear(UVec2::new(16, 1), (0..16).map(|i| Vec3::splat((i as f32 / 15.0).powi(3)))),
        age_ramp: line(vec3(1.0, 0.2, 0.1), vec3(0.2, 0.4, 1.0)),
        heat_ramp: line(Vec3::ONE, Vec3::splat(0.05)),
        fire_ramp: line(Vec3::ZERO, vec3(2.0, 1.2, 0.3)),
    }
}

impl TestScene {
    /// A cloud of 60 sprites around (0, 0, -6), lit from the left and from behind.
    pub fn new(size: UVec2) -> Self {
        let particle = |i: u32| {
            let a = pcg3d(UVec3::new(i, 0, 5));
            let b = pcg3d(UVec3::new(i, 1, 5));
            Particle {
                position: (vec3(unit(a.x), unit(a.y), unit(a.z)) - 0.5) * vec3(4.0, 2.4, 2.0) + vec3(0.0, 0.0, -6.0),
                radius: 0.3 + 0.6 * unit(b.x),
                rotation: unit(b.y) * 6.0,
                amount: 0.1 + 0.4 * unit(b.z),
                frame: 0.0,
                age: 0.5,
                ..Particle::default()
            }
        };
        Self {
            view: View::new(Mat4::IDENTITY, perspective(size), size),
            view_direction_z: -1.0,
            lights: vec![
                Light {
                    position: vec3(-4.0, 2.0, -4.0),
                    color: vec3(1.0, 0.6, 0.3),
                    intensity: 20.0,
                    ..Light::default()
                },
                Light { position: vec3(0.5, 0.3, -8.5), intensity: 3.0, ..Light::default() },
            ],
            shadow_maps: Vec::new(),
            scene_ambient: None,
            particles: (0..60).map(particle).collect(),
            others: Vec::new(),
            bounds: None,
            // Fixed, because the choice of `auto` depends on the device.
            settings: Settings { path: RenderPath::Raster, boost: 1.5, ..Settings::default() },
            material: material(),
            world_from_particles: Mat4::IDENTITY,
            exposure: 1.0,
            time: 1.0,
            up: Vec3::Y,
            debug_view: DebugView::Final,
            debug_views: None,
            depth: DepthKind::Buffer,
            wall_everywhere: false,
            empty_linear: false,
            // OpenGL cannot sample a depth buffer that the same pass tests.
            attach_depth: haze::read_only_depth_is_supported(&gpu().device),
            host: HostKind::default(),
        }
    }

    /// View depth of the scene at a pixel, metres: a narrow post at 5 m, and on the left half a wall at 6.2 m that the
    /// cloud reaches into. `None` elsewhere.
    fn view_depth(&self, at: UVec2) -> Option<f32> {
        if self.wall_everywhere {
            return Some(6.2);
        }
        let uv = (at.as_vec2() + 0.5) / self.view.size.as_vec2();
        let post = (uv.x - 0.6).abs() < 0.03;
        if post { Some(5.0) } else { (uv.x < 0.5).then_some(6.2) }
    }

    /// Depth-buffer value of a surface at a view depth in metres.
    /// True if the depth buffer stores the near plane as 1.
    pub fn is_reversed(&self) -> bool {
        self.ndc_of(1.0) > self.ndc_of(2.0)
    }

    fn ndc_of(&self, view_depth: f32) -> f32 {
        self.view.clip_from_view.project_point3(vec3(0.0, 0.0, self.view_direction_z * view_depth)).z
    }

    /// Contents of the depth buffer.
    pub fn ndc_depth(&self) -> Image<f32> {
        let mut image = Image::new(self.view.size, if self.is_reversed() { 0.0 } else { 1.0 });
        image.for_each(|at, texel| {
            if let Some(depth) = self.view_depth(at) {
                *texel = self.ndc_of(depth);
            }
        });
        image
    }

    /// Contents of the linear depth target: view depth, metres.
    pub fn linear_depth(&self) -> Image<f32> {
        let mut linear = Image::new(self.view.size, 0.0);
        let seen = |at| self.view_depth(at).filter(|_| !self.empty_linear);
        linear.for_each(|at, texel| *texel = seen(at).unwrap_or(haze_core::formula::depth::SKY_VIEW_DEPTH));
        linear
    }

    /// Image of the host before the smoke: black if it shows the amount.
    pub fn backdrop(&self) -> Vec4 {
        if self.debug_view == DebugView::Amount { Vec4::ZERO } else { BACKDROP }
    }

    pub fn on_cpu(&self) -> Image<Vec4> {
        self.try_on_cpu().unwrap()
    }

    pub fn try_on_cpu(&self) -> Result<Image<Vec4>, FieldError> {
        let mut image = Image::new(self.view.size, self.backdrop());
        let system = |particles, settings| haze_reference::ParticleSystem::new(particles, settings, &self.material);
        let mut systems = vec![haze_reference::ParticleSystem {
            world_from_particles: self.world_from_particles,
            bounds: self.bounds,
            ..system(&self.particles, &self.settings)
        }];
        systems.extend(self.others.iter().map(|(particles, settings)| system(particles, settings)));
        let shadow_maps: Vec<_> = self
            .shadow_maps
            .iter()
            .map(|map| haze_reference::ShadowMap { layers: &map.layers, projection: map.projection() })
            .collect();
        let frame = haze_reference::FrameInput {
            shadow_maps: &shadow_maps,
            scene_ambient: self.scene_ambient,
            view: self.view,
            scene_depth: &self.ndc_depth(),
            lights: &self.lights,
            systems: &systems,
            exposure: self.exposure,
            time: self.time,
            up: self.up,
            debug_view: self.debug_view,
        };
        let frame = haze_reference::PreparedFrame::new(&frame, image.size)?;
        frame.shade_scene(&mut image);
        frame.render(&mut image);
        Ok(image)
    }
}

/// A change of a scene.
pub type Change = fn(&mut TestScene);

/// Paths, lightings, orders and resolutions that draw the same smoke.
pub const WAYS_TO_DRAW: &[(&str, Change)] = &[
    ("raster", |_| {}),
    ("forward", |s| s.settings.path = RenderPath::Forward),
    ("tiled", |s| s.settings.path = RenderPath::Tiled),
    ("six-way", |s| s.settings.lighting = Lighting::SixWay),
    ("six-way, tiled", |s| (s.settings.lighting, s.settings.path) = (Lighting::SixWay, RenderPath::Tiled)),
    ("weighted", |s| s.settings.accumulate.order = BlendOrder::Weighted),
    ("weighted, tiled", |s| {
        s.settings.accumulate.order = BlendOrder::Weighted;
        s.settings.path = RenderPath::Tiled;
    }),
    ("lit per texel", |s| {
        s.settings.accumulate.downscale = 3;
        s.settings.accumulate.lighting_resolution = LightingResolution::Target;
    }),
    ("guided", |s| (s.settings.accumulate.downscale, s.settings.accumulate.upsample) = (3, Upsample::Guided)),
];

/// Both renderers draw the same, and something else after `turn_off`: `most` dB alike.
pub fn assert_agreement_and_effect(name: &str, mut scene: TestScene, turn_off: Change, most: f32) {
    let seen = scene.on_gpu(gpu()).image;
    let reference = scene.on_cpu();
    let same = psnr(&seen, &reference);
    turn_off(&mut scene);
    let effect = psnr(&scene.on_gpu(gpu()).image, &seen);
    println!("{name}: {same:.1} dB, turned off {effect:.1} dB");
    assert!(same >= MIN_PSNR, "{name}: {same:.1} dB");
    assert!(effect < most, "{name}: turned off {effect:.1} dB");
}
