//! Shadow of smoke on smoke: whole frames on the GPU and on the CPU, and what must not change.

use glam::{UVec2, Vec3, Vec4, vec3};
use haze::image::Image;
use haze::settings::*;
use haze::{Bounds, Light, LightKind, Particle};

use crate::gpu::{gpu, is_tiled_available};
use crate::psnr::{MIN_PSNR, psnr};
use crate::resource_counter;
use crate::test_host::Host;
use crate::test_scene::{BACKDROP, TestScene};

const SIZE: UVec2 = UVec2::new(160, 90);

/// The test cloud with shadow, under a sun as well.
fn shaded() -> TestScene {
    let mut scene = TestScene::new(SIZE);
    scene.settings.shadow.strength = 0.9;
    scene.settings.specular_scatter.intensity = 0.0;
    scene.lights.push(Light {
        kind: LightKind::Directional,
        direction: vec3(-0.3, -1.0, -0.2),
        intensity: 0.7,
        ..Light::default()
    });
    scene
}

fn drawn(scene: &TestScene) -> Image<Vec4> {
    scene.on_gpu(gpu()).picture
}

#[test]
fn gpu_and_cpu_draw_the_same_shadow() {
    if !is_tiled_available() {
        return;
    }
    type Change = fn(&mut TestScene);
    let changes: &[(&str, Change)] = &[
        ("raster", |_| {}),
        ("forward", |s| s.settings.path = RenderPath::Forward),
        ("tiled", |s| s.settings.path = RenderPath::Tiled),
        ("six-way", |s| s.settings.lighting = Lighting::SixWay),
        ("six-way, tiled", |s| (s.settings.lighting, s.settings.path) = (Lighting::SixWay, RenderPath::Tiled)),
        ("weighted", |s| s.settings.accumulate.order = BlendOrder::Weighted),
        ("weighted, tiled", |s| {
            (s.settings.accumulate.order, s.settings.path) = (BlendOrder::Weighted, RenderPath::Tiled);
        }),
        ("six-way, weighted", |s| {
            (s.settings.accumulate.order, s.settings.lighting) = (BlendOrder::Weighted, Lighting::SixWay);
        }),
        ("lit per texel", |s| {
            (s.settings.accumulate.scale, s.settings.accumulate.lighting_resolution) = (3, LightingResolution::Target);
        }),
        ("guided", |s| (s.settings.accumulate.scale, s.settings.accumulate.upsample) = (3, Upsample::Guided)),
        ("spheres", |s| s.settings.technique = Technique::SphericalBillboard),
        ("fine", |s| s.settings.shadow.resolution = 64),
        ("coarse", |s| s.settings.shadow.resolution = 4),
        ("dense", |s| s.settings.shadow.density = 16.0),
        ("own space", |s| {
            s.world_from_particles = glam::Mat4::from_rotation_y(0.7) * glam::Mat4::from_scale(Vec3::splat(0.8));
        }),
        ("steps", |s| s.settings.ramp_filter = RampFilter::Nearest),
        ("many lights", |s| {
            let light = |i: u32| Light { position: vec3(i as f32 - 3.0, 1.0, -4.0), ..Light::default() };
            s.lights.extend((0..6).map(light));
        }),
    ];
    for (name, change) in changes {
        let mut scene = shaded();
        change(&mut scene);
        let (seen, reference) = (drawn(&scene), scene.on_cpu());
        let same = psnr(&seen, &reference);
        scene.settings.shadow.strength = 0.0;
        let effect = psnr(&drawn(&scene), &seen);
        println!("{name}: {same:.1} dB, without shadow {effect:.1} dB");
        assert!(same >= MIN_PSNR, "{name}: {same:.1} dB");
        assert!(effect < 40.0, "{name}: without shadow {effect:.1} dB");
    }
}

/// Keeps one particle, in the middle of the picture.
fn keep_one_particle(scene: &mut TestScene) {
    scene.particles.truncate(1);
    (scene.particles[0].position, scene.particles[0].amount) = (vec3(-0.5, 0.0, -5.0), 0.5);
}

#[test]
fn shadow_of_unusual_smoke_is_right_or_none() {
    if !is_tiled_available() {
        return;
    }
    type Change = fn(&mut TestScene);
    let changes: &[(&str, Change)] = &[
        ("one particle", keep_one_particle),
        ("a particle 1000 km away", |s| s.particles[7].position.x = 1.0e6),
        ("a particle that is not a number", |s| s.particles[3].position.y = f32::NAN),
        ("a light in the densest place", |s| s.lights[0].position = vec3(0.0, 0.0, -6.0)),
        ("a light at the camera", |s| s.lights[0].position = Vec3::ZERO),
        ("a box around the viewer", |s| {
            s.bounds = Some(Bounds { min: Vec3::splat(-20.0), max: Vec3::splat(20.0) });
        }),
        ("no density", |s| s.settings.shadow.density = 0.0),
        ("no lights", |s| s.lights.clear()),
    ];
    for (name, change) in changes {
        let mut scene = shaded();
        change(&mut scene);
        let seen = drawn(&scene);
        gpu().check().unwrap();
        assert!(seen.texels.iter().all(|texel| texel.is_finite()), "{name}");
        let same = psnr(&seen, &scene.on_cpu());
        println!("{name}: {same:.1} dB");
        assert!(same >= MIN_PSNR, "{name}: {same:.1} dB");
    }
    for (name, clear) in [("no particles", false), ("clear particles", true)] {
        let mut scene = shaded();
        match clear {
            true => scene.particles.iter_mut().for_each(|particle| particle.amount = 0.0),
            false => scene.particles.clear(),
        }
        assert!(drawn(&scene).texels.iter().all(|texel| *texel == BACKDROP), "{name}");
    }
    // A ramp that is white in full light leaves a single particle as it is without shadow.
    let mut scene = shaded();
    keep_one_particle(&mut scene);
    scene.material.shadow_ramp = haze::builtin::find(haze::builtin::RAMPS, "shadow_neutral").unwrap().ramp().unwrap();
    let seen = drawn(&scene);
    scene.settings.shadow.strength = 0.0;
    let same = psnr(&seen, &drawn(&scene));
    assert!(same >= 45.0, "one particle shades itself: {same:.1} dB");
}

#[test]
fn shadow_falls_on_the_far_side_of_the_smoke() {
    if !is_tiled_available() {
        return;
    }
    // Two clouds side by side, and a sun from the left or from the right.
    let brightness = |from_left: bool| {
        let mut scene = shaded();
        let cloud = |index: u32, x: f32| Particle {
            position: vec3(x + 0.1 * (index % 3) as f32, 0.2 * (index / 3) as f32 - 0.5, -5.0),
            radius: 0.5,
            amount: 0.5,
            ..scene.particles[0]
        };
        scene.particles = (0..15).flat_map(|index| [cloud(index, -1.0), cloud(index, 1.0)]).collect();
        let direction = if from_left { Vec3::X } else { Vec3::NEG_X };
        scene.lights = vec![Light { kind: LightKind::Directional, direction, ..Light::default() }];
        // Thin enough that the clouds hardly shade themselves.
        (scene.settings.shadow.density, scene.settings.soft_scatter.intensity) = (0.08, 0.0);
        scene.wall_everywhere = true;
        let shadowed = drawn(&scene);
        scene.settings.shadow.strength = 0.0;
        let plain = drawn(&scene);
        // 21 pixels to the left and right of the middle.
        let sum = |picture: &Image<Vec4>, column: u32| -> f32 {
            let place = |i: u32| UVec2::new(column - 4 + i % 8, 40 + i / 8).as_ivec2();
            (0..80).map(|i| picture.load(place(i)).truncate().element_sum()).sum()
        };
        [59, 101].map(|column| sum(&shadowed, column) / sum(&plain, column))
    };
    let ([lit, dark], [dark_too, lit_too]) = (brightness(true), brightness(false));
    println!("{lit} {dark}, {dark_too} {lit_too}");
    assert!(dark < 0.9 * lit && dark_too < 0.9 * lit_too, "{lit} {dark}, {dark_too} {lit_too}");
}

#[test]
fn smoke_of_one_system_shades_another() {
    if !is_tiled_available() {
        return;
    }
    let scene = shaded();
    let near = |index: u32| Particle {
        position: vec3(-2.6, 0.9 - 0.2 * index as f32, -5.0),
        radius: 0.6,
        amount: 0.6,
        ..scene.particles[0]
    };
    let other: Vec<_> = (0..8).map(near).collect();
    let alone = drawn(&scene);
    // The second system casts shadow and receives none.
    let settings = Settings { shadow: Shadow::default(), ..scene.settings };
    let both = TestScene { others: vec![(other, settings)], ..scene };
    let shaded = drawn(&both);
    let same = psnr(&shaded, &both.on_cpu());
    assert!(same >= MIN_PSNR, "{same:.1} dB");
    // Right of the second system, which covers the left edge.
    let brightness = |picture: &Image<Vec4>| {
        let place = |i: u32| UVec2::new(60 + i % 40, 20 + i / 40).as_ivec2();
        (0..40 * 50).map(|i| picture.load(place(i)).truncate().element_sum()).sum::<f32>()
    };
    let (before, after) = (brightness(&alone), brightness(&shaded));
    assert!(after < 0.97 * before, "{before} {after}");
}

#[test]
fn shadow_is_the_same_from_run_to_run_and_steady_frames_create_nothing() {
    if !is_tiled_available() {
        return;
    }
    for path in [RenderPath::Raster, RenderPath::Tiled, RenderPath::Forward] {
        let mut scene = shaded();
        scene.settings.path = path;
        assert!(drawn(&scene) == drawn(&scene), "{}", path.name());
        let mut host = Host::new(gpu(), &scene).unwrap();
        (0..3).for_each(|_| host.draw(gpu(), &scene).unwrap());
        let created = resource_counter::count(|| host.draw(gpu(), &scene).unwrap());
        assert_eq!(created, 0, "{}", path.name());
        let held = host.renderer.memory_use().shadow;
        // Eight bytes of density and eight of optical depths for each cell, and the uniforms.
        let cells = u64::from(scene.settings.shadow.resolution).pow(3);
        assert!((16 * cells..16 * cells + 1024).contains(&held), "{held}");
        // Released after 120 frames without shadow.
        scene.settings.shadow.strength = 0.0;
        (0..125).for_each(|_| host.draw(gpu(), &scene).unwrap());
        assert_eq!(host.renderer.memory_use().shadow, 0);
    }
}
