//! Light by six-way maps: both renderers, everywhere it can be; and where it cannot.

use glam::{UVec2, Vec3, Vec4, vec3};
use haze::picture::Picture;
use haze::settings::*;
use haze::sprite::{Sprite, SpriteLayout};
use haze::{Light, LightKind, wgpu};
use haze_demo::headless::Headless;

use crate::common::{AGREEMENT, gpu, has_tiles, psnr};
use crate::stage::{Stage, six_way_of};
use crate::tiled;

fn stage() -> Stage {
    let mut stage = Stage::new(UVec2::new(160, 90));
    (stage.settings.lighting, stage.settings.path) = (Lighting::SixWay, Path::Raster);
    stage.settings.boost = 1.0;
    for (index, particle) in (0..).zip(&mut stage.particles) {
        particle.rotation = index as f32 * 0.7;
    }
    stage
}

fn agreement(name: &str, stage: &Stage) {
    let (on_gpu, on_cpu) = (stage.on_gpu(gpu()).picture, stage.on_cpu());
    let psnr = psnr(&on_gpu, &on_cpu);
    println!("{name}: {psnr:.1} dB");
    assert!(psnr >= AGREEMENT, "{name}: {psnr:.1} dB");
}

type Change = fn(&mut Settings);

/// Ways to accumulate, and to light what is accumulated.
const WAYS: &[(&str, Change)] = &[
    ("sorted", |_| {}),
    ("weighted", |s| s.accumulate.order = Order::Weighted),
    ("weighted and biased", |s| {
        (s.accumulate.order, s.accumulate.encoding) = (Order::Weighted, NormalEncoding::Biased);
    }),
    ("scale 1", |s| s.accumulate.scale = 1),
    ("lit at the target's resolution", |s| s.accumulate.lighting_resolution = LightingResolution::Target),
    ("host depth", |s| (s.accumulate.depth_source, s.accumulate.scale) = (DepthSource::Host, 1)),
    ("anisotropy", |s| s.diffuse.six_way_anisotropy = 0.7),
    ("colour", |s| s.diffuse.six_way_colour = vec3(0.2, 0.5, 1.0)),
    // What bakes light by normal has nothing to do here.
    ("cubemap", |s| s.diffuse.mode = DiffuseMode::Cubemap),
];

fn changed(change: Change) -> Stage {
    let mut stage = stage();
    change(&mut stage.settings);
    // OpenGL cannot test the depth buffer and read it.
    stage.depth = crate::stage::DepthKind::Both;
    stage
}

/// Under a technique, of several frames.
fn flipbook(technique: Technique) -> Stage {
    let mut stage = changed(|_| {});
    stage.settings.technique = technique;
    stage.settings.volumetric.noise_size = 1.5;
    (stage.material.sprite, stage.material.detail, stage.material.six_way) = crate::techniques::flipbook();
    (0..).zip(&mut stage.particles).for_each(|(index, particle)| particle.frame = index as f32 * 0.37);
    stage
}

#[test]
fn both_renderers_agree_however_sprites_are_accumulated() {
    for (name, change) in WAYS {
        agreement(name, &changed(*change));
    }
    agreement("forward", &changed(|s| s.path = Path::Forward));
    agreement(
        "8 bits",
        &changed(|s| {
            (s.accumulate.format, s.accumulate.encoding) = (AccumulationFormat::Rgba8Unorm, NormalEncoding::Biased);
        }),
    );
    for &technique in Technique::ALL {
        let mut stage = flipbook(technique);
        agreement(technique.name(), &stage);
        stage.settings.path = Path::Forward;
        agreement(&format!("{} forward", technique.name()), &stage);
    }
    let mut stage = stage();
    stage.shade_tree = ShadeTree::Normals;
    agreement("normals", &stage);
}

#[test]
fn tiles_are_lit_as_well() {
    if !has_tiles() {
        return;
    }
    for (name, change) in WAYS {
        tiled::agreement(name, &changed(*change));
    }
    for &technique in Technique::ALL {
        tiled::agreement(technique.name(), &flipbook(technique));
    }
    // Where there is something, the maps say, not the sprite.
    let mut elsewhere = changed(|_| {});
    let dot =
        image::RgbaImage::from_fn(64, 64, |x, y| image::Rgba([128, 128, 255, if (x, y) == (9, 9) { 255 } else { 0 }]));
    elsewhere.material.sprite = Sprite::from_picture("dot".as_ref(), &dot, SpriteLayout::default()).unwrap();
    tiled::agreement("the sprite is clear", &elsewhere);
    // Half of the light is rounded to 8 bits, once: raster rounds all of it, layer by layer, and is no measure. One step of 255 is 48 dB.
    let mut bytes = changed(|s| {
        (s.path, s.accumulate.encoding) = (Path::Tiled, NormalEncoding::Biased);
        s.accumulate.format = AccumulationFormat::Rgba8Unorm;
    });
    let eight = bytes.on_gpu(gpu()).picture;
    bytes.settings.accumulate.format = AccumulationFormat::Rgba16Float;
    let apart = psnr(&eight, &bytes.on_gpu(gpu()).picture);
    println!("8 bits: {apart:.1} dB of 16");
    assert!((40.0..80.0).contains(&apart), "{apart}");
}

#[test]
fn smoke_hides_as_much_whatever_lights_it() {
    let alpha = |picture: &Picture<Vec4>| picture.texels.iter().map(|texel| texel.w).collect::<Vec<_>>();
    let six_way = stage();
    let mut normals = six_way.clone();
    normals.settings.lighting = Lighting::Normals;
    let pictures = [&six_way, &normals].map(|stage| stage.on_gpu(gpu()).picture);
    let apart = alpha(&pictures[0]).iter().zip(alpha(&pictures[1])).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(apart < 1.0 / 255.0, "{apart}");
    assert!(psnr(&pictures[0], &pictures[1]) < 40.0, "the same light");
}

/// Mean light of smoke of one sprite under one sun, whose light comes *from* a side.
fn light_from(side: Vec3, rotation: f32) -> f32 {
    let mut stage = stage();
    stage.particles.truncate(1);
    (stage.particles[0].position, stage.particles[0].rotation) = (vec3(0.0, 0.0, -6.0), rotation);
    stage.lights = vec![Light { kind: LightKind::Directional, direction: -side, intensity: 1.0, ..Light::default() }];
    (stage.settings.soft_scatter.intensity, stage.settings.specular_scatter.intensity) = (0.0, 0.0);
    // Symmetric, so that it covers the same wherever it is turned; what it is lit by is not.
    let ball = Sprite::from_picture(
        "ball".as_ref(),
        &image::RgbaImage::from_fn(64, 64, |x, y| {
            let inside = 1.0 - (glam::vec2(x as f32, y as f32) - 31.5).length() / 30.0;
            image::Rgba([160, 110, 230, (inside.max(0.0) * 255.0) as u8])
        }),
        SpriteLayout::default(),
    )
    .unwrap();
    (stage.material.six_way, stage.material.sprite) = (Some(six_way_of(&ball)), ball);
    let empty = Stage { particles: Vec::new(), ..stage.clone() };
    let sum = |stage: &Stage| stage.on_gpu(gpu()).picture.texels.iter().map(|texel| texel.x).sum::<f32>();
    // What hides the backdrop is the same under every light.
    let dark = Stage { lights: Vec::new(), ..stage.clone() };
    assert!(sum(&empty) > 0.0);
    sum(&stage) - sum(&dark)
}

#[test]
fn light_turns_with_a_sprite_and_comes_from_its_side() {
    let quarter = std::f32::consts::FRAC_PI_2;
    let from = |side, rotation| light_from(side, rotation);
    let [right, top, left, bottom] = [Vec3::X, Vec3::Y, Vec3::NEG_X, Vec3::NEG_Y].map(|side| from(side, 0.0));
    let all = [right, top, left, bottom];
    let apart = |a: f32, b: f32| (a - b).abs();
    assert!((0..4).all(|i| (0..i).all(|j| apart(all[i], all[j]) > 0.5)), "{all:?}");
    // A quarter turn to the left brings what was on the right to the top.
    for (turns, expected) in [(1.0, [bottom, right, top, left]), (2.0, [left, bottom, right, top])] {
        let turned = [Vec3::X, Vec3::Y, Vec3::NEG_X, Vec3::NEG_Y].map(|side| from(side, turns * quarter));
        assert!(turned.iter().zip(expected).all(|(&a, b)| apart(a, b) < 0.01), "{turns}: {turned:?} for {expected:?}");
    }
}

#[test]
fn a_device_that_blends_one_target_keeps_to_normals() {
    let limits = wgpu::Limits { max_color_attachment_bytes_per_sample: 8, ..wgpu::Limits::default() };
    let gpu = Headless::with(limits, wgpu::Features::empty()).unwrap();
    let six_way = stage();
    let mut normals = six_way.clone();
    normals.settings.lighting = Lighting::Normals;
    assert_eq!(six_way.on_gpu(&gpu).picture, normals.on_gpu(&gpu).picture);
}

#[test]
fn what_cannot_be_lit_so_is_refused_by_name() {
    let refused = |change: fn(&mut Stage)| {
        let mut stage = stage();
        change(&mut stage);
        stage.try_on_gpu(gpu()).map(|_| ()).unwrap_err().to_string()
    };
    let said = refused(|stage| stage.material.six_way = None);
    assert!(said.contains("systems[0].settings.lighting: \"six_way\"") && said.contains("haze sprite bake"), "{said}");
    let said = refused(|stage| stage.material.six_way = Some(stage.material.sprite.clone()));
    assert!(
        said.contains("material.six_way: 1 frames of 64 texels is not valid; expected twice the sprite's frames, 2"),
        "{said}"
    );
}
