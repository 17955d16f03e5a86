//! One visible system with fixed values, as Rust structs and as the bytes of the shaders' uniforms. Formulas that read
//! uniforms start from it and change single fields.

use std::sync::LazyLock;

use glam::{UVec2, Vec2, Vec4, vec3};
use haze::{Light, LightKind, MaterialAssets};
use haze_core::assets::image::Image;
use haze_core::assets::material_assets::MaterialInfo;
use haze_core::assets::ramp_steps::RampSteps;
use haze_core::assets::sprite::{Sprite, SpriteLayout};
use haze_core::formula::uniforms::LightUniform;
use haze_core::frame::MAX_LIGHTS;
use haze_core::settings::Settings;
use haze_core::view_setup::{AttachmentRole, ResolvedSettings, SpriteTrim, Support};
use haze_reference::accumulated::{AccumulatedTarget, AccumulatedTextures};
use haze_reference::visible_system::{VisibleSystem, place_systems};
use haze_reference::{FrameInput, ParticleSystem};

use super::inputs::{test_noise, test_ramp, test_sprite, test_sprite_sheet};
use crate::test_scene::TestScene;

/// Size of the view and of the accumulation target: that of the test ramp, which takes the place of every 2D texture.
pub const SIZE: UVec2 = UVec2::new(8, 4);

/// The test ramp as colors with alpha 1, as a texture lookup returns it.
pub static COLORS: LazyLock<Image<Vec4>> = LazyLock::new(|| {
    let ramp = test_ramp();
    let texels = (0..SIZE.x * SIZE.y).map(|i| ramp.texel(UVec2::new(i % SIZE.x, i / SIZE.x)).extend(1.0)).collect();
    Image { size: SIZE, texels }
});

/// Textures of every role, all with the test ramp.
static TEXTURES: LazyLock<AccumulatedTextures> = LazyLock::new(|| AttachmentRole::ALL.map(|_| Some(COLORS.clone())));

/// Red channel of the test ramp: the scene's depth buffer, and the reduced depth over the depth limit.
pub static DEPTHS: LazyLock<Image<f32>> =
    LazyLock::new(|| Image { size: SIZE, texels: COLORS.texels.iter().map(|texel| texel.x).collect() });

/// Images of the system: the test ramp, the test sprite and the test noise.
pub static MATERIAL: LazyLock<MaterialAssets> = LazyLock::new(|| {
    // Layers 1 and 2 of the test sprite: the six-way maps of a sprite with one frame.
    let maps = image::imageops::crop_imm(&test_sprite_sheet(), 8, 0, 16, 8).to_image();
    let layout = SpriteLayout { columns: 2, rows: 1, y_down: false };
    MaterialAssets {
        sprite: test_sprite(),
        detail: Some(test_sprite()),
        six_way: Some(Sprite::from_image("six_way".as_ref(), &maps, layout).unwrap()),
        noise: test_noise().clone(),
        diffuse_ramp: test_ramp(),
        backlight_ramp: test_ramp(),
        shadow_ramp: test_ramp(),
        soft_scatter_ramp: test_ramp(),
        specular_ramp: test_ramp(),
        motif: test_ramp(),
        coverage_ramp: test_ramp(),
        age_ramp: test_ramp(),
        heat_ramp: test_ramp(),
        fire_ramp: test_ramp(),
    }
});

/// The images without six-way maps, whose frames would have to match those of the sprite.
static WITHOUT_SIX_WAY: LazyLock<MaterialAssets> =
    LazyLock::new(|| MaterialAssets { six_way: None, ..MATERIAL.clone() });

static INFO: LazyLock<MaterialInfo> = LazyLock::new(|| WITHOUT_SIX_WAY.info());

/// Default settings.
pub static DEFAULTS: LazyLock<Settings> = LazyLock::new(Settings::default);

static SYSTEM: LazyLock<VisibleSystem<'static>> = LazyLock::new(|| {
    let mut scene = TestScene::new(SIZE);
    scene.lights.push(Light { kind: LightKind::Directional, direction: vec3(0.3, -1.0, -0.4), ..Light::default() });
    scene.settings.accumulate.downscale = 1;
    let scene: &'static TestScene = Box::leak(Box::new(scene));
    let systems = Box::leak(Box::new([ParticleSystem::new(&scene.particles, &scene.settings, &WITHOUT_SIX_WAY)]));
    let frame = FrameInput { lights: &scene.lights, systems, ..FrameInput::new(scene.view, &DEPTHS) };
    let (_, mut visible) = place_systems(&frame, SIZE).unwrap().visible.swap_remove(0);
    let system = &mut visible.system;
    system.target_origin = Vec2::ZERO;
    system.target_size = SIZE.as_vec2();
    system.frame_count = 3.0;
    system.sprite_size = 8.0;
    system.detail_lod = 0.0;
    visible.lights.iter_mut().zip([2.0, 0.0, 3.0, 1.0]).for_each(|(light, slot)| light.shadow_slot = slot);
    visible
});

/// Returns the bytes of the uniforms `view`, `system` and `lights`.
pub fn uniform_bytes() -> [Vec<u8>; 3] {
    let mut lights = [LightUniform::default(); MAX_LIGHTS];
    lights[..SYSTEM.lights.len()].copy_from_slice(&SYSTEM.lights);
    let view = bytemuck::bytes_of(&SYSTEM.view);
    let system = bytemuck::bytes_of(&SYSTEM.system);
    [view.to_vec(), system.to_vec(), bytemuck::cast_slice(&lights).to_vec()]
}

/// Returns the system with some settings. Its uniforms do not depend on them.
pub fn visible_system(settings: &Settings) -> VisibleSystem<'_> {
    let VisibleSystem { view, world_from_view, system, setup, bounds, .. } = *SYSTEM;
    VisibleSystem {
        view,
        world_from_view,
        system,
        setup,
        bounds,
        lights: SYSTEM.lights.clone(),
        particles: Vec::new(),
        trim: SpriteTrim::new(settings, &INFO),
        scene_depth: &DEPTHS,
        settings: ResolvedSettings::new(settings, 1.0, SIZE, system.frame_count, &RampSteps::default(), Support::ALL),
        material: &MATERIAL,
        optical_depths: None,
    }
}

/// Returns the finished target of a system. Every image of it is the test ramp.
pub fn accumulated_target<'a>(visible: &'a VisibleSystem<'a>, reduced_depth: &'a Image<f32>) -> AccumulatedTarget<'a> {
    AccumulatedTarget { visible, baked: &[], reduced_depth, textures: &TEXTURES, is_lit: false, lit: None }
}
