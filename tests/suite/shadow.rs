//! Shadow of smoke on smoke: whole frames on the GPU and on the CPU, and what must not change.

use glam::camera::rh;
use glam::{Mat4, UVec2, Vec3, Vec4, vec3};
use haze::{AttachmentRole, Bounds, Light, LightKind, Particle, Particles};
use haze_core::assets::image::Image;
use haze_core::settings::*;

use crate::gpu::{gpu, is_tiled_available};
use crate::psnr::{MIN_PSNR, psnr};
use crate::resource_counter;
use crate::test_host::Host;
use crate::test_scene::{
    BACKDROP, Change, DepthKind, TestScene, TestShadowMap, WAYS_TO_DRAW, assert_agreement_and_effect,
};

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

/// Without the path `tiled` where the device does not have it.
fn available<'a>(changes: &'a [(&'a str, Change)]) -> impl Iterator<Item = &'a (&'a str, Change)> {
    changes.iter().filter(|(name, _)| is_tiled_available() || !name.contains("tiled"))
}

/// Paths that the device has.
fn available_paths() -> impl Iterator<Item = RenderPath> {
    let paths = [RenderPath::Raster, RenderPath::Tiled, RenderPath::Forward];
    paths.into_iter().filter(|path| is_tiled_available() || *path != RenderPath::Tiled)
}

fn drawn(scene: &TestScene) -> Image<Vec4> {
    scene.on_gpu(gpu()).image
}

#[test]
fn gpu_and_cpu_draw_the_same_shadow() {
    let changes: &[(&str, Change)] = &[
        ("six-way, weighted", |s| {
            s.settings.accumulate.order = BlendOrder::Weighted;
            s.settings.lighting = Lighting::SixWay;
        }),
        ("spheres", |s| s.settings.technique = Technique::SphericalBillboard),
        ("fine", |s| s.settings.shadow.resolution = 64),
        ("coarse", |s| s.settings.shadow.resolution = 4),
        ("dense", |s| s.settings.shadow.density = 16.0),
        ("own space", |s| {
            s.world_from_particles = Mat4::from_rotation_y(0.7) * Mat4::from_scale(Vec3::splat(0.8));
        }),
        ("steps", |s| s.settings.ramp_filter = RampFilter::Nearest),
        ("many lights", |s| {
            let light = |i: u32| Light { position: vec3(i as f32 - 3.0, 1.0, -4.0), ..Light::default() };
            s.lights.extend((0..6).map(light));
        }),
    ];
    for (name, change) in available(WAYS_TO_DRAW).chain(available(changes)) {
        let mut scene = shaded();
        change(&mut scene);
        assert_agreement_and_effect(name, scene, |s| s.settings.shadow.strength = 0.0, 40.0);
    }
}

/// Keeps one particle, in the middle of the image.
fn keep_one_particle(scene: &mut TestScene) {
    scene.particles.truncate(1);
    scene.particles[0].position = vec3(-0.5, 0.0, -5.0);
    scene.particles[0].amount = 0.5;
}

#[test]
fn shadow_of_unusual_smoke_is_right_or_none() {
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
    for (name, change) in available(changes) {
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
    scene.material.shadow_ramp =
        haze_preset::builtin::find(haze_preset::builtin::RAMPS, "shadow_neutral").unwrap().ramp().unwrap();
    let seen = drawn(&scene);
    scene.settings.shadow.strength = 0.0;
    let same = psnr(&seen, &drawn(&scene));
    assert!(same >= 45.0, "one particle shades itself: {same:.1} dB");
}

#[test]
fn shadow_falls_on_the_far_side_of_the_smoke() {
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
        scene.settings.shadow.density = 0.08;
        scene.settings.soft_scatter.intensity = 0.0;
        scene.wall_everywhere = true;
        let shadowed = drawn(&scene);
        scene.settings.shadow.strength = 0.0;
        let plain = drawn(&scene);
        // 21 pixels to the left and right of the middle.
        let sum = |image: &Image<Vec4>, column: u32| -> f32 {
            let place = |i: u32| UVec2::new(column - 4 + i % 8, 40 + i / 8).as_ivec2();
            (0..80).map(|i| image.load(place(i)).truncate().element_sum()).sum()
        };
        [59, 101].map(|column| sum(&shadowed, column) / sum(&plain, column))
    };
    let [lit, dark] = brightness(true);
    let [dark_too, lit_too] = brightness(false);
    println!("{lit} {dark}, {dark_too} {lit_too}");
    assert!(dark < 0.9 * lit && dark_too < 0.9 * lit_too, "{lit} {dark}, {dark_too} {lit_too}");
}

#[test]
fn smoke_of_one_system_shades_another() {
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
    let brightness = |image: &Image<Vec4>| {
        let place = |i: u32| UVec2::new(60 + i % 40, 20 + i / 40).as_ivec2();
        (0..40 * 50).map(|i| image.load(place(i)).truncate().element_sum()).sum::<f32>()
    };
    let before = brightness(&alone);
    let after = brightness(&shaded);
    assert!(after < 0.97 * before, "{before} {after}");
}

#[test]
fn shadow_is_the_same_from_run_to_run_and_steady_frames_create_nothing() {
    for path in available_paths() {
        let mut scene = shaded();
        scene.settings.path = path;
        assert!(drawn(&scene) == drawn(&scene), "{}", path.name());
        let mut host = Host::new(gpu(), &scene).unwrap();
        (0..3).for_each(|_| host.draw(gpu(), &scene).unwrap());
        let created = resource_counter::count(|| host.draw(gpu(), &scene).unwrap());
        assert_eq!(created, 0, "{}", path.name());
        let held = host.renderer.memory_use().shadow;
        // Eight bytes of optical depths for each cell, and the uniforms.
        let cells = density_bytes(&scene) + 8 * u64::from(scene.settings.shadow.resolution).pow(3);
        assert!((cells..cells + 1024).contains(&held), "{held}");
        // Released after 120 frames without shadow.
        scene.settings.shadow.strength = 0.0;
        (0..125).for_each(|_| host.draw(gpu(), &scene).unwrap());
        assert_eq!(host.renderer.memory_use().shadow, 0);
    }
}

/// A scene whose first light, a sun from above, has a shadow map: half of the smoke is in the shadow of something above it.
fn under_a_roof() -> TestScene {
    let mut scene = shaded();
    scene.lights = vec![Light { kind: LightKind::Directional, direction: Vec3::NEG_Y, ..Light::default() }];
    scene.settings.shadow.by_depth = true;
    let mut layer = Image::new(UVec2::new(64, 32), 1.0);
    // In the map's upper left: a surface above the smoke.
    layer.for_each(|at, depth| *depth = if at.x < 32 { 0.2 } else { 1.0 });
    let view = rh::view::look_at_mat4(vec3(0.0, 10.0, -6.0), vec3(0.0, 0.0, -6.0), Vec3::NEG_Z);
    let clip_from_world = rh::proj::directx::orthographic(-4.0, 4.0, -4.0, 4.0, 0.0, 20.0) * view;
    let map = TestShadowMap { light: 0, layers: vec![layer], clip_from_world: vec![clip_from_world], reversed: false };
    scene.shadow_maps.push(map);
    scene
}

#[test]
fn gpu_and_cpu_draw_the_same_shadow_of_the_scene() {
    let changes: &[(&str, Change)] = &[
        ("forward, spheres", |s| {
            s.settings.path = RenderPath::Forward;
            s.settings.technique = Technique::SphericalBillboard;
        }),
        ("reversed", |s| {
            let map = &mut s.shadow_maps[0];
            map.reversed = true;
            map.layers[0].texels.iter_mut().for_each(|depth| *depth = 1.0 - *depth);
            let flip = Mat4::from_cols_array(&[1., 0., 0., 0., 0., 1., 0., 0., 0., 0., -1., 0., 0., 0., 1., 1.]);
            map.clip_from_world[0] = flip * map.clip_from_world[0];
        }),
        ("cascades", |s| {
            // The first covers the right half of the smoke, and is dark there.
            let map = &mut s.shadow_maps[0];
            let near = Mat4::from_translation(vec3(-1.0, 0.0, 0.0)) * map.clip_from_world[0];
            map.layers.insert(0, Image::new(UVec2::new(64, 32), 0.1));
            map.clip_from_world.insert(0, near);
        }),
        ("a lamp inside the smoke", |s| {
            s.lights.push(Light { position: vec3(0.3, 0.2, -6.0), intensity: 2.0, ..Light::default() });
        }),
    ];
    for (name, change) in available(WAYS_TO_DRAW).chain(available(changes)) {
        let mut scene = under_a_roof();
        change(&mut scene);
        assert_agreement_and_effect(name, scene, |s| s.shadow_maps.clear(), 45.0);
    }
}

#[test]
fn gpu_and_cpu_draw_the_same_views_of_shadow() {
    for view in [DebugView::Shadow, DebugView::ShadowSlice] {
        for path in available_paths().filter(|path| *path != RenderPath::Forward) {
            let mut scene = under_a_roof();
            scene.debug_view = view;
            scene.settings.path = path;
            let name = format!("{}, {}", view.name(), path.name());
            assert_agreement_and_effect(&name, scene, |s| s.settings.shadow.strength = 0.0, 40.0);
        }
    }
}

/// Lamps around the smoke, all of which smoke shades, and a sun. The first has the shadow map.
fn under_many_lights() -> TestScene {
    let mut scene = under_a_roof();
    scene.settings.shadow.lights = 15;
    scene.lights.extend((0..9).map(|i: u32| {
        let (sine, cosine) = (i as f32 * 0.7).sin_cos();
        Light { position: vec3(2.5 * cosine, 1.5 * sine, -6.0 + sine), intensity: 0.8, ..Light::default() }
    }));
    scene
}

#[test]
fn gpu_and_cpu_draw_the_same_shadow_of_many_lights() {
    let changes: &[(&str, Change)] = &[
        ("raster", |_| {}),
        ("forward", |s| s.settings.path = RenderPath::Forward),
        ("tiled", |s| s.settings.path = RenderPath::Tiled),
        ("six-way", |s| s.settings.lighting = Lighting::SixWay),
        ("without maps", |s| s.shadow_maps.clear()),
        ("with ambient light", |s| s.settings.ambient.intensity = 1.0),
        ("lit per texel", |s| {
            s.settings.accumulate.downscale = 3;
            s.settings.accumulate.lighting_resolution = LightingResolution::Target;
        }),
        ("large lamps", |s| s.lights.iter_mut().for_each(|light| light.radius = 2.0)),
    ];
    for (name, change) in available(changes) {
        let mut scene = under_many_lights();
        change(&mut scene);
        assert_agreement_and_effect(name, scene, |s| s.settings.shadow.lights = 3, 40.0);
    }
}

/// A further light is shaded at the mean depth of the smoke, not at its sprites.
#[test]
fn smoke_shades_a_further_light_nearly_as_one_of_the_first_three() {
    let green = |scene: &TestScene| -> Vec<f32> { drawn(scene).texels.iter().map(|texel| texel.y).collect() };
    let sun = Light {
        kind: LightKind::Directional,
        direction: vec3(-0.8, -0.5, -0.2),
        color: vec3(0.0, 1.0, 0.0),
        ..Light::default()
    };
    let mut scene = shaded();
    scene.settings.shadow.by_depth = true;
    scene.settings.shadow.lights = 4;
    scene.settings.soft_scatter.intensity = 0.0;
    scene.lights = vec![sun];
    let first = green(&scene);
    // Three lights of another color that are brighter.
    let red = Light { color: vec3(6.0, 0.0, 0.0), ..sun };
    scene.lights = vec![red, red, red, sun];
    let further = green(&scene);
    scene.settings.shadow.lights = 3;
    let unshaded = green(&scene);
    let error = |other: &[f32]| {
        let difference: f32 = first.iter().zip(other).map(|(a, b)| (a - b).abs()).sum();
        difference / first.iter().sum::<f32>()
    };
    println!("difference from a first light: {}, unshaded {}", error(&further), error(&unshaded));
    assert!(error(&unshaded) > 0.1, "{}", error(&unshaded));
    assert!(error(&further) < 0.1 * error(&unshaded), "{} {}", error(&further), error(&unshaded));
}

/// An image of the scene that the smoke darkens.
fn over_a_lit_scene() -> TestScene {
    let mut scene = under_a_roof();
    scene.lights.push(Light { position: vec3(-2.0, 1.0, -4.5), intensity: 4.0, ..Light::default() });
    scene.scene_ambient = Some(vec3(0.1, 0.15, 0.2));
    scene
}

#[test]
fn gpu_and_cpu_shade_the_scene_alike() {
    let changes: &[(&str, Change)] = &[
        ("depth buffer", |_| {}),
        ("linear depth", |s| (s.depth, s.attach_depth) = (DepthKind::Linear, false)),
        // OpenGL cannot read multisampled depth.
        ("multisampled, as for tiled", |s| (s.depth, s.host.samples) = (DepthKind::Multisampled, 4)),
        ("without maps", |s| s.shadow_maps.clear()),
        ("no ambient light", |s| s.scene_ambient = Some(Vec3::ZERO)),
        ("forward", |s| s.settings.path = RenderPath::Forward),
        ("many lights", |s| {
            s.settings.shadow.lights = 15;
            let light = |i: u32| Light { position: vec3(i as f32 - 3.0, 1.0, -4.0), ..Light::default() };
            s.lights.extend((0..6).map(light));
        }),
    ];
    for (name, change) in available(changes) {
        let mut scene = over_a_lit_scene();
        change(&mut scene);
        assert_agreement_and_effect(name, scene, |s| s.scene_ambient = None, 45.0);
    }
}

#[test]
fn a_rejected_frame_does_not_shade_the_scene() {
    let scene = over_a_lit_scene();
    let mut host = Host::new(gpu(), &scene).unwrap();
    host.draw(gpu(), &scene).unwrap();
    assert!(host.image(gpu()).unwrap().texels.iter().any(|texel| *texel != BACKDROP));
    let rejected = TestScene { exposure: f32::NAN, ..scene };
    let mut encoder = gpu().device.create_command_encoder(&Default::default());
    host.prepare(&mut encoder, &rejected, Particles::Slice(&rejected.particles)).unwrap_err();
    host.render(&mut encoder, &rejected);
    gpu().submit(encoder).unwrap();
    assert!(host.image(gpu()).unwrap().texels.iter().all(|texel| *texel == BACKDROP));
}

#[test]
fn under_one_light_the_scene_keeps_what_comes_through_the_smoke() {
    let mut scene = over_a_lit_scene();
    scene.lights.truncate(1);
    scene.shadow_maps.clear();
    scene.wall_everywhere = true;
    scene.lights[0].direction = vec3(0.1, -0.2, -1.0);
    let depth = scene.ndc_depth();
    let systems = [haze_reference::ParticleSystem::new(&scene.particles, &scene.settings, &scene.material)];
    let frame = haze_reference::FrameInput {
        lights: &scene.lights,
        systems: &systems,
        scene_ambient: Some(Vec3::ZERO),
        ..haze_reference::FrameInput::new(scene.view, &depth)
    };
    let frame = haze_reference::PreparedFrame::new(&frame, SIZE).unwrap();
    let mut image = Image::new(SIZE, Vec4::ONE);
    frame.shade_scene(&mut image);
    let shadow = frame.scene_shadow().unwrap();
    let world_from_clip = (scene.view.clip_from_view * scene.view.view_from_world).inverse();
    let mut darkest = 1.0_f32;
    image.clone().for_each(|at, texel| {
        let uv = (at.as_vec2() + 0.5) / SIZE.as_vec2();
        let ndc = vec3(uv.x * 2.0 - 1.0, 1.0 - uv.y * 2.0, depth.load(at.as_ivec2()));
        let expected = shadow.haze_transmittance(world_from_clip.project_point3(ndc), 0);
        assert!((texel.truncate() - expected).abs().max_element() < 1e-2, "{at}: {texel} {expected}");
    });
    image.texels.iter().for_each(|texel| darkest = darkest.min(texel.y));
    assert!(darkest < 0.7, "{darkest}");
}

/// Fractions of a light that smoke in a box takes away at positions, of the first light.
fn darkness(scene: &TestScene, light: Light, bounds: Bounds, positions: impl Iterator<Item = Vec3>) -> Vec<f32> {
    let depth = Image::new(SIZE, 1.0);
    let lights = [light];
    let systems = [haze_reference::ParticleSystem {
        bounds: Some(bounds),
        ..haze_reference::ParticleSystem::new(&scene.particles, &scene.settings, &scene.material)
    }];
    let frame = haze_reference::FrameInput {
        lights: &lights,
        systems: &systems,
        ..haze_reference::FrameInput::new(scene.view, &depth)
    };
    let frame = haze_reference::PreparedFrame::new(&frame, SIZE).unwrap();
    let shadow = frame.scene_shadow().unwrap();
    positions.map(|position| 1.0 - shadow.haze_transmittance(position, 0).y).collect()
}

fn darkest(fractions: &[f32]) -> f32 {
    fractions.iter().copied().fold(0.0, f32::max)
}

#[test]
fn a_larger_lamp_casts_a_softer_shadow() {
    let mut scene = shaded();
    keep_one_particle(&mut scene);
    scene.particles[0].amount = 0.3;
    scene.settings.shadow.resolution = 64;
    // Makes room for the cone of the light in the grid.
    let bounds = Bounds { min: vec3(-2.0, -2.0, -7.0), max: vec3(1.0, 1.0, -4.0) };
    let center = scene.particles[0].position;
    let fractions = |radius| {
        let position = center + vec3(0.0, 3.0, 0.0);
        let light = Light { position, radius, range: f32::INFINITY, ..Light::default() };
        darkness(&scene, light, bounds, (0..60).map(|i| center + vec3(i as f32 * 0.05 - 1.5, -1.5, 0.0)))
    };
    let small = fractions(0.0);
    let large = fractions(1.5);
    let width = |fractions: &[f32]| fractions.iter().sum::<f32>() / darkest(fractions);
    println!("darkest {} {}, width {} {}", darkest(&small), darkest(&large), width(&small), width(&large));
    assert!(darkest(&large) < 0.8 * darkest(&small) && width(&large) > 1.3 * width(&small));
}

#[test]
fn shadow_on_the_scene_is_steady_while_the_box_grows() {
    let mut scene = shaded();
    keep_one_particle(&mut scene);
    let center = scene.particles[0].position;
    let light = Light { kind: LightKind::Directional, direction: vec3(1.0, -0.3, 0.17), ..Light::default() };
    // Grows toward the shadow by a tenth of a cell per step, and keeps the cells: it is as high as before.
    let fractions = |step: u32| {
        let right = 1.0 + 0.01 * step as f32;
        let bounds = Bounds { min: center + vec3(-1.0, -1.6, -1.0), max: center + vec3(right, 1.6, 1.0) };
        darkness(&scene, light, bounds, (0..60).map(|i| center + vec3(3.0, i as f32 * 0.05 - 2.0, 0.5)))
    };
    let steps: Vec<_> = (0..40).map(fractions).collect();
    let change = |pair: &[Vec<f32>]| {
        let changes = pair[0].iter().zip(&pair[1]).map(|(before, after)| (before - after).abs());
        changes.fold(0.0, f32::max)
    };
    let largest = steps.windows(2).map(change).fold(0.0, f32::max);
    let darkest = darkest(&steps[0]);
    println!("largest change {largest}, darkest {darkest}");
    // 0.0024 of it; 0.02 if marches end at the last cell.
    assert!(darkest > 0.2 && largest < 0.006 * darkest, "{largest} {darkest}");
}

#[test]
fn further_lights_do_not_shade_smoke_without_its_depth() {
    let mut scene = under_many_lights();
    scene.settings.shadow.by_depth = false;
    let many = drawn(&scene);
    scene.settings.shadow.lights = 3;
    assert_eq!(many.texels, drawn(&scene).texels);
}

#[test]
fn gpu_and_cpu_draw_the_same_ambient_light() {
    let changes: &[(&str, Change)] = &[
        ("without shadow", |s| s.settings.shadow.strength = 0.0),
        ("cubemap", |s| (s.settings.shadow.strength, s.settings.diffuse.mode) = (0.0, DiffuseMode::Cubemap)),
        ("raster", |_| {}),
        ("not by depth", |s| s.settings.shadow.by_depth = false),
        ("forward", |s| s.settings.path = RenderPath::Forward),
        ("tiled", |s| s.settings.path = RenderPath::Tiled),
        ("six-way", |s| s.settings.lighting = Lighting::SixWay),
        ("lit per texel", |s| {
            s.settings.accumulate.downscale = 3;
            s.settings.accumulate.lighting_resolution = LightingResolution::Target;
        }),
        ("another up", |s| s.up = vec3(0.5, -0.7, 0.3)),
        ("exposed", |s| s.exposure = 1.7),
    ];
    for (name, change) in available(changes) {
        for has_map in [false, true] {
            let mut scene = under_a_roof();
            scene.settings.ambient.intensity = 1.0;
            change(&mut scene);
            if !has_map {
                scene.shadow_maps.clear();
            }
            assert_agreement_and_effect(name, scene, |s| s.settings.ambient.intensity = 0.0, 45.0);
        }
    }
}

#[test]
fn sky_lights_the_top_of_smoke_and_not_its_inside() {
    let mut scene = under_a_roof();
    scene.shadow_maps = Vec::new();
    scene.lights = Vec::new();
    scene.settings.soft_scatter.intensity = 0.0;
    scene.settings.ambient = Ambient { intensity: 1.0, sky_color: Vec3::ONE, ground_color: Vec3::ZERO };
    // A dense column in the middle of the image.
    let puff = |index: u32| Particle {
        position: vec3(0.1 * (index % 3) as f32, 0.15 * (index / 3) as f32 - 1.0, -5.0),
        radius: 0.4,
        amount: 0.8,
        ..scene.particles[0]
    };
    scene.particles = (0..42).map(puff).collect();
    scene.settings.shadow.density = 4.0;
    let row = |image: &Image<Vec4>, y: i32| (76..84).map(|x| image.load(glam::IVec2::new(x, y)).x).sum::<f32>();
    let shaded = drawn(&scene);
    scene.settings.shadow.by_depth = false;
    let open = drawn(&scene);
    let [top, middle] = [18, 45].map(|y| row(&shaded, y) / row(&open, y));
    println!("{top} {middle}");
    // Smoke scatters light onwards: by the ramp, its inside keeps more than half.
    assert!(top > 0.8 && middle < 0.65, "{top}, {middle}");
}

#[test]
fn smoke_under_a_roof_is_dark() {
    let mut scene = under_a_roof();
    scene.settings.soft_scatter.intensity = 0.0;
    scene.wall_everywhere = false;
    let light = |image: &Image<Vec4>, left: bool| {
        let half = |index: usize| ((index as u32 % SIZE.x) < SIZE.x / 2) == left;
        let seen = image.texels.iter().enumerate().filter(|(index, _)| half(*index));
        seen.map(|(_, texel)| f64::from(texel.x)).sum::<f64>()
    };
    let roofed = drawn(&scene);
    scene.shadow_maps.clear();
    let open = drawn(&scene);
    let [left, right] = [true, false].map(|left| light(&roofed, left) / light(&open, left));
    // The backdrop, which shows through, is as bright in both.
    assert!(left < 0.7 && right > 0.95, "{left}, {right}");
}

#[test]
fn shadow_maps_that_do_not_fit_are_refused_by_name() {
    let changes: &[(&str, Change)] = &[
        ("shadow_maps[0].projection.light: 3", |s| s.shadow_maps[0].light = 3),
        ("shadow_maps[1].projection.light: 0 has a map already", |s| s.shadow_maps.push(s.shadow_maps[0].clone())),
        ("shadow_maps[0].projection.clip_from_world: has 0 layers", |s| s.shadow_maps[0].clip_from_world.clear()),
        ("shadow_maps[0].projection.clip_from_world", |s| s.shadow_maps[0].clip_from_world[0].x_axis.x = f32::NAN),
    ];
    for (expected, change) in changes {
        let mut scene = under_a_roof();
        change(&mut scene);
        let refused =
            [scene.try_on_gpu(gpu()).map(|_| ()).unwrap_err().to_string(), scene.try_on_cpu().unwrap_err().to_string()];
        for error in refused {
            assert!(error.starts_with(expected), "{error}");
        }
    }
    let mut scene = under_a_roof();
    let matrix = scene.shadow_maps[0].clip_from_world[0];
    scene.shadow_maps[0].clip_from_world.extend([matrix; 2]);
    let error = scene.try_on_gpu(gpu()).map(|_| ()).unwrap_err().to_string();
    assert!(error.starts_with("shadow_maps[0].depth: has"), "{error}");
}

#[test]
fn casting_shadow_first_draws_the_same_frame() {
    for depth in [DepthKind::Buffer, DepthKind::Linear] {
        let mut scene = under_a_roof();
        scene.depth = depth;
        let alone = drawn(&scene);
        let mut host = Host::new(gpu(), &scene).unwrap();
        host.casts_first = true;
        for frame in 0..3 {
            host.draw(gpu(), &scene).unwrap();
            assert!(host.image(gpu()).unwrap() == alone, "frame {frame}");
        }
        assert_eq!(host.renderer.shadowed_lights().count(), 1);
        // Commands that were dropped are recorded again.
        let mut dropped = gpu().device.create_command_encoder(&Default::default());
        host.prepare_shadow(&mut dropped, &scene).unwrap();
        drop(dropped);
        host.casts_first = false;
        host.draw(gpu(), &scene).unwrap();
        assert!(host.image(gpu()).unwrap() == alone);
    }
}

#[test]
fn steady_frames_with_shadow_maps_create_nothing() {
    let scene = under_a_roof();
    let mut host = Host::new(gpu(), &scene).unwrap();
    host.casts_first = true;
    (0..3).for_each(|_| host.draw(gpu(), &scene).unwrap());
    assert_eq!(resource_counter::count(|| host.draw(gpu(), &scene).unwrap()), 0);
    let held = host.renderer.memory_use().shadow;
    let cells = density_bytes(&scene) + 16 * u64::from(scene.settings.shadow.resolution).pow(3);
    assert!((cells..cells + 2048).contains(&held), "{held}");
}

/// Bytes of the density of a scene's grid: four for each cell on the CPU; on the GPU eight, and eight in its texture, which has
/// one empty cell around the grid.
fn density_bytes(scene: &TestScene) -> u64 {
    let side = u64::from(scene.settings.shadow.resolution);
    if is_tiled_available() { 8 * side.pow(3) + 8 * (side + 2).pow(3) } else { 4 * side.pow(3) }
}

/// Smoke to the right of the view, before a sun that shines to the left.
fn beside_hidden_smoke(path: RenderPath) -> TestScene {
    let mut scene = shaded();
    scene.settings.path = path;
    scene.lights = vec![Light { kind: LightKind::Directional, direction: Vec3::NEG_X, ..Light::default() }];
    let mut hidden = scene.particles.clone();
    hidden.iter_mut().for_each(|particle| particle.position.x += 14.0);
    scene.others.push((hidden, scene.settings));
    scene
}

#[test]
fn smoke_out_of_sight_casts_shadow() {
    for path in available_paths() {
        let mut scene = beside_hidden_smoke(path);
        let seen = drawn(&scene);
        let reference = scene.on_cpu();
        let same = psnr(&seen, &reference);
        let mut host = Host::new(gpu(), &scene).unwrap();
        (0..3).for_each(|_| host.draw(gpu(), &scene).unwrap());
        assert_eq!(host.renderer.counts().systems, 1, "only one system is in sight");
        assert_eq!(resource_counter::count(|| host.draw(gpu(), &scene).unwrap()), 0, "{}", path.name());
        scene.others.clear();
        let effect = psnr(&drawn(&scene), &seen);
        println!("{}: {same:.1} dB, without {effect:.1} dB", path.name());
        assert!(same >= MIN_PSNR && effect < 45.0, "{}: {same:.1} dB, without {effect:.1} dB", path.name());
    }
}

#[test]
fn mean_depth_of_the_smoke_is_in_a_texture_of_the_target() {
    let modes = [(1.0, DiffuseMode::Ramp), (0.0, DiffuseMode::Ramp), (0.0, DiffuseMode::Cubemap)];
    let paths = available_paths().filter(|path| *path != RenderPath::Forward);
    for (path, (strength, mode)) in paths.flat_map(|path| modes.map(|mode| (path, mode))) {
        let mut scene = shaded();
        scene.settings.shadow.strength = strength;
        scene.settings.diffuse.mode = mode;
        scene.settings.path = path;
        scene.settings.shadow.by_depth = true;
        scene.wall_everywhere = true;
        let puff = |x: f32, z: f32| Particle { position: vec3(x, 0.0, z), radius: 0.8, ..scene.particles[0] };
        scene.particles = vec![puff(-1.5, -6.0), puff(1.5, -4.0)];
        let frame = scene.on_gpu(gpu());
        let targets = frame.renderer.targets(0).unwrap();
        let slot = targets.roles.slot(AttachmentRole::Depth).unwrap();
        let texels = gpu().read_rgba16float(targets.accumulation[slot].texture()).unwrap();
        let width = targets.accumulation[slot].texture().width();
        let [near, far] = targets.smoke_depths.unwrap();
        for particle in &scene.particles {
            let ndc = scene.view.clip_from_view.project_point3(particle.position).truncate();
            let pixel = (ndc * glam::vec2(0.5, -0.5) + 0.5) * SIZE.as_vec2();
            let texel = (pixel / targets.scale as f32).floor().as_ivec2() - targets.origin;
            let depth = texels[texel.y as usize * width as usize + texel.x as usize];
            let mean = near + (far - near) * depth.x / depth.w;
            assert!(
                (mean + particle.position.z).abs() < 0.05,
                "{path:?}, {strength}, {mode:?}: {mean} at {}",
                particle.position
            );
        }
    }
}
