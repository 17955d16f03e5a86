//! Six-way lighting: agreement of the renderers wherever it is supported, and errors where it is not.

use glam::{UVec2, Vec3, Vec4, vec3};
use haze::{Light, LightKind, wgpu};
use haze_core::assets::image::Image;
use haze_core::assets::sprite::{Sprite, SpriteLayout};
use haze_core::settings::*;
use haze_demo::headless::Headless;

use crate::gpu::{gpu, is_tiled_available};
use crate::psnr::{MIN_PSNR, psnr};
use crate::test_scene::{TestScene, six_way_of};
use crate::tiled;

fn scene() -> TestScene {
    let mut scene = TestScene::new(UVec2::new(160, 90));
    scene.settings.lighting = Lighting::SixWay;
    scene.settings.path = RenderPath::Raster;
    scene.settings.boost = 1.0;
    for (index, particle) in (0..).zip(&mut scene.particles) {
        particle.rotation = index as f32 * 0.7;
    }
    scene
}

fn assert_agreement(name: &str, scene: &TestScene) {
    let on_gpu = scene.on_gpu(gpu()).image;
    let on_cpu = scene.on_cpu();
    let psnr = psnr(&on_gpu, &on_cpu);
    println!("{name}: {psnr:.1} dB");
    assert!(psnr >= MIN_PSNR, "{name}: {psnr:.1} dB");
}

type Change = fn(&mut Settings);

/// Ways to accumulate sprites and to light the result.
const MODES: &[(&str, Change)] = &[
    ("sorted", |_| {}),
    ("weighted", |s| s.accumulate.order = BlendOrder::Weighted),
    ("weighted and biased", |s| {
        s.accumulate.order = BlendOrder::Weighted;
        s.accumulate.encoding = NormalEncoding::Biased;
    }),
    ("scale 1", |s| s.accumulate.downscale = 1),
    ("lit at the target's resolution", |s| s.accumulate.lighting_resolution = LightingResolution::Target),
    ("host depth", |s| (s.accumulate.depth_source, s.accumulate.downscale) = (DepthSource::Host, 1)),
    ("anisotropy", |s| s.diffuse.six_way_anisotropy = 0.7),
    ("color", |s| s.diffuse.six_way_color = vec3(0.2, 0.5, 1.0)),
    // Modes that bake light by normal have no effect here.
    ("cubemap", |s| s.diffuse.mode = DiffuseMode::Cubemap),
];

fn changed(change: Change) -> TestScene {
    let mut scene = scene();
    change(&mut scene.settings);
    // OpenGL cannot sample a depth buffer that the same pass tests.
    scene.depth = crate::test_scene::DepthKind::Both;
    scene
}

/// The scene with a technique and sprites of several frames.
fn flipbook(technique: Technique) -> TestScene {
    let mut scene = changed(|_| {});
    scene.settings.technique = technique;
    scene.settings.volumetric.noise_size = 1.5;
    (scene.material.sprite, scene.material.detail, scene.material.six_way) = crate::techniques::flipbook();
    (0..).zip(&mut scene.particles).for_each(|(index, particle)| particle.frame = index as f32 * 0.37);
    scene
}

#[test]
fn gpu_and_cpu_agree_in_every_accumulation_mode() {
    for (name, change) in MODES {
        assert_agreement(name, &changed(*change));
    }
    assert_agreement("forward", &changed(|s| s.path = RenderPath::Forward));
    assert_agreement(
        "8 bits",
        &changed(|s| {
            s.accumulate.format = AccumulationFormat::Rgba8Unorm;
            s.accumulate.encoding = NormalEncoding::Biased;
        }),
    );
    for &technique in Technique::ALL {
        let mut scene = flipbook(technique);
        assert_agreement(technique.name(), &scene);
        scene.settings.path = RenderPath::Forward;
        assert_agreement(&format!("{} forward", technique.name()), &scene);
    }
    let mut scene = scene();
    scene.debug_view = DebugView::Normals;
    assert_agreement("normals", &scene);
}

#[test]
fn tiled_path_agrees_on_six_way_lighting() {
    if !is_tiled_available() {
        return;
    }
    for (name, change) in MODES {
        tiled::assert_agreement(name, &changed(*change));
    }
    for &technique in Technique::ALL {
        tiled::assert_agreement(technique.name(), &flipbook(technique));
    }
    // The alpha of the six-way maps decides where there is smoke, not the sprite's.
    let mut elsewhere = changed(|_| {});
    let dot =
        image::RgbaImage::from_fn(64, 64, |x, y| image::Rgba([128, 128, 255, if (x, y) == (9, 9) { 255 } else { 0 }]));
    elsewhere.material.sprite = Sprite::from_image("dot".as_ref(), &dot, SpriteLayout::default()).unwrap();
    tiled::assert_agreement("the sprite is clear", &elsewhere);
    // The tiled path rounds one of the two light textures to 8 bits, once. Raster rounds both after every layer, so it
    // is no reference. One step of 255 is 48 dB.
    let mut bytes = changed(|s| {
        s.path = RenderPath::Tiled;
        s.accumulate.encoding = NormalEncoding::Biased;
        s.accumulate.format = AccumulationFormat::Rgba8Unorm;
    });
    let eight = bytes.on_gpu(gpu()).image;
    bytes.settings.accumulate.format = AccumulationFormat::Rgba16Float;
    let apart = psnr(&eight, &bytes.on_gpu(gpu()).image);
    println!("8 bits against 16 bits: {apart:.1} dB");
    assert!((40.0..80.0).contains(&apart), "8 bits against 16 bits: {apart} dB");
}

#[test]
fn six_way_lighting_does_not_change_alpha() {
    let alpha = |image: &Image<Vec4>| image.texels.iter().map(|texel| texel.w).collect::<Vec<_>>();
    let six_way = scene();
    let mut normals = six_way.clone();
    normals.settings.lighting = Lighting::Normals;
    let images = [&six_way, &normals].map(|scene| scene.on_gpu(gpu()).image);
    let apart = alpha(&images[0]).iter().zip(alpha(&images[1])).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(apart < 1.0 / 255.0, "alpha differs by {apart}");
    assert!(psnr(&images[0], &images[1]) < 40.0, "six-way lighting has no effect");
}

/// Summed light that one sprite, rotated by `rotation` radians, shows under a directional light that comes from `side`.
fn light_from(side: Vec3, rotation: f32) -> f32 {
    let mut scene = scene();
    scene.particles.truncate(1);
    scene.particles[0].position = vec3(0.0, 0.0, -6.0);
    scene.particles[0].rotation = rotation;
    scene.lights = vec![Light { kind: LightKind::Directional, direction: -side, intensity: 1.0, ..Light::default() }];
    scene.settings.soft_scatter.intensity = 0.0;
    scene.settings.specular_scatter.intensity = 0.0;
    // The alpha is symmetric, so that rotation does not change coverage; the light maps are not.
    let ball = Sprite::from_image(
        "ball".as_ref(),
        &image::RgbaImage::from_fn(64, 64, |x, y| {
            let inside = 1.0 - (glam::vec2(x as f32, y as f32) - 31.5).length() / 30.0;
            image::Rgba([160, 110, 230, (inside.max(0.0) * 255.0) as u8])
        }),
        SpriteLayout::default(),
    )
    .unwrap();
    scene.material.six_way = Some(six_way_of(&ball));
    scene.material.sprite = ball;
    let empty = TestScene { particles: Vec::new(), ..scene.clone() };
    let sum = |scene: &TestScene| scene.on_gpu(gpu()).image.texels.iter().map(|texel| texel.x).sum::<f32>();
    // Subtracted: the backdrop as far as the smoke hides it, which does not depend on lights.
    let dark = TestScene { lights: Vec::new(), ..scene.clone() };
    assert!(sum(&empty) > 0.0);
    sum(&scene) - sum(&dark)
}

#[test]
fn six_way_light_follows_the_sprites_rotation() {
    let quarter = std::f32::consts::FRAC_PI_2;
    let from = |side, rotation| light_from(side, rotation);
    let [right, top, left, bottom] = [Vec3::X, Vec3::Y, Vec3::NEG_X, Vec3::NEG_Y].map(|side| from(side, 0.0));
    let all = [right, top, left, bottom];
    let apart = |a: f32, b: f32| (a - b).abs();
    assert!(
        (0..4).all(|i| (0..i).all(|j| apart(all[i], all[j]) > 0.5)),
        "light from right, top, left, bottom: {all:?}"
    );
    // A quarter turn counter-clockwise moves the sprite's right side to the top.
    for (turns, expected) in [(1.0, [bottom, right, top, left]), (2.0, [left, bottom, right, top])] {
        let turned = [Vec3::X, Vec3::Y, Vec3::NEG_X, Vec3::NEG_Y].map(|side| from(side, turns * quarter));
        assert!(
            turned.iter().zip(expected).all(|(&a, b)| apart(a, b) < 0.01),
            "{turns} quarter turns: {turned:?}, expected {expected:?}"
        );
    }
}

#[test]
fn device_that_blends_only_one_target_falls_back_to_normals() {
    let limits = wgpu::Limits { max_color_attachment_bytes_per_sample: 8, ..wgpu::Limits::default() };
    let gpu = Headless::with(limits, wgpu::Features::empty()).unwrap();
    let six_way = scene();
    let mut normals = six_way.clone();
    normals.settings.lighting = Lighting::Normals;
    assert_eq!(six_way.on_gpu(&gpu).image, normals.on_gpu(&gpu).image);
}

#[test]
fn missing_or_mismatched_maps_are_errors_that_name_the_field() {
    let refused = |change: fn(&mut TestScene)| {
        let mut scene = scene();
        change(&mut scene);
        scene.try_on_gpu(gpu()).map(|_| ()).unwrap_err().to_string()
    };
    let said = refused(|scene| scene.material.six_way = None);
    assert!(said.contains("systems[0].settings.lighting: \"six_way\"") && said.contains("haze sprite bake"), "{said}");
    let said = refused(|scene| scene.material.six_way = Some(scene.material.sprite.clone()));
    assert!(
        said.contains(
            "material.six_way: the number of frames is 1, each of 64 texels; expected 2, two for each of the sprite"
        ),
        "{said}"
    );
}
