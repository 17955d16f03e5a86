//! Fire: whole frames on the GPU and on the CPU, and how smoke and fire hide each other.

use glam::{IVec2, UVec2, Vec3, Vec4, vec3};
use haze::{Light, MaterialAssets, Particle};
use haze_core::assets::image::Image;
use haze_core::assets::ramp::Ramp;
use haze_core::emitter::Emitter;
use haze_core::fire::FireLight;
use haze_core::settings::*;
use haze_preset::{ImageSource, MaterialSources};

use crate::gpu::{gpu, is_tiled_available};
use crate::psnr::psnr;
use crate::test_scene::{Change, TestScene, WAYS_TO_DRAW, assert_agreement_and_effect};

const SIZE: UVec2 = UVec2::new(160, 90);

/// The test cloud, burning. Particles have all ages.
fn burning() -> TestScene {
    let mut scene = TestScene::new(SIZE);
    scene.settings.specular_scatter.intensity = 0.0;
    scene.settings.fire.intensity = 3.0;
    let count = scene.particles.len() as f32;
    for (index, particle) in scene.particles.iter_mut().enumerate() {
        particle.age = (index as f32 * 0.618) % 1.0 * count / (count + 1.0);
    }
    scene
}

fn drawn(scene: &TestScene) -> Image<Vec4> {
    scene.on_gpu(gpu()).image
}

#[test]
fn gpu_and_cpu_draw_the_same_fire() {
    let changes: &[(&str, Change)] = &[
        ("with shadow", |s| s.settings.shadow.strength = 0.8),
        ("with shadow by depth, tiled", |s| {
            s.settings.shadow.strength = 0.8;
            s.settings.shadow.by_depth = true;
            s.settings.path = RenderPath::Tiled;
        }),
        ("spheres", |s| s.settings.technique = Technique::SphericalBillboard),
        ("volumetric", |s| s.settings.technique = Technique::VolumetricSoft),
        ("density", |s| s.settings.technique = Technique::Density),
        ("steps", |s| s.settings.ramp_filter = RampFilter::Nearest),
        ("exposed", |s| s.exposure = 0.4),
    ];
    for (name, change) in WAYS_TO_DRAW.iter().chain(changes) {
        let mut scene = burning();
        change(&mut scene);
        let needs_compute = scene.settings.path == RenderPath::Tiled || scene.settings.shadow.strength > 0.0;
        if needs_compute && !is_tiled_available() {
            continue;
        }
        assert_agreement_and_effect(name, scene, |s| s.settings.fire.intensity = 0.0, 35.0);
    }
}

#[test]
fn gpu_and_cpu_draw_the_same_colors_by_age() {
    let changes: &[(&str, Change)] = &[
        ("raster", |_| {}),
        ("forward", |s| s.settings.path = RenderPath::Forward),
        ("tiled", |s| s.settings.path = RenderPath::Tiled),
        ("six-way", |s| s.settings.lighting = Lighting::SixWay),
        ("weighted", |s| s.settings.accumulate.order = BlendOrder::Weighted),
        ("with fire", |s| s.settings.fire.intensity = 1.0),
        ("with fire and shadow, tiled", |s| {
            s.settings.fire.intensity = 1.0;
            s.settings.shadow.strength = 0.8;
            s.settings.path = RenderPath::Tiled;
        }),
        ("cubemap", |s| s.settings.diffuse.mode = DiffuseMode::Cubemap),
        ("lit per texel", |s| {
            s.settings.accumulate.downscale = 3;
            s.settings.accumulate.lighting_resolution = LightingResolution::Target;
        }),
        ("steps", |s| s.settings.ramp_filter = RampFilter::Nearest),
    ];
    for (name, change) in changes {
        let mut scene = burning();
        scene.settings.fire.intensity = 0.0;
        scene.settings.sprite.age_color = 0.9;
        change(&mut scene);
        if scene.settings.path == RenderPath::Tiled && !is_tiled_available() {
            continue;
        }
        assert_agreement_and_effect(name, scene, |s| s.settings.sprite.age_color = 0.0, 40.0);
    }
}

#[test]
fn sprites_in_front_hide_the_colors_behind_them() {
    let mut scene = burning();
    scene.settings.fire.intensity = 0.0;
    scene.settings.sprite.age_color = 1.0;
    scene.material.age_ramp = Ramp::from_linear(UVec2::new(2, 1), [vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0)]);
    let like = scene.particles[0];
    let reddest = |near: f32, far: f32| {
        let mut scene = scene.clone();
        scene.particles = vec![puff(-6.0, far, 0.8, &like), puff(-5.0, near, 0.8, &like)];
        scene.settings.boost = 4.0;
        scene.wall_everywhere = true;
        let seen = drawn(&scene).load(IVec2::new(SIZE.x as i32 / 2, SIZE.y as i32 / 2));
        seen.x / (seen.x + seen.y)
    };
    let red = reddest(0.0, 1.0);
    let green = reddest(1.0, 0.0);
    println!("{red} {green}");
    assert!(red > 0.7 && green < 0.3, "{red} {green}");
}

/// A puff in the middle of the image, at this depth.
fn puff(z: f32, age: f32, amount: f32, like: &Particle) -> Particle {
    Particle { position: vec3(0.0, 0.0, z), radius: 1.0, age, amount, rotation: 0.0, ..*like }
}

/// A scene in which nothing but fire gives light. Heat is 1 at birth and 0 from then on.
fn lit_by_fire() -> TestScene {
    let mut scene = burning();
    scene.lights.clear();
    scene.settings.soft_scatter.intensity = 0.0;
    scene.settings.boost = 1.0;
    scene.settings.accumulate.downscale = 1;
    scene.settings.fire.core = 0.0;
    let heat = |x| if x == 0 { Vec3::ONE } else { Vec3::ZERO };
    scene.material.heat_ramp = Ramp::from_linear(UVec2::new(64, 1), (0..64).map(heat));
    scene
}

/// Fire alone, and behind smoke of these amounts, as one system; the light that is not reflected.
fn seen_through(amounts: &[f32]) -> Vec3 {
    let mut scene = lit_by_fire();
    let fire = puff(-6.0, 0.0, 0.6, &scene.particles[0]);
    let smoke = amounts.iter().map(|amount| puff(-5.0, 1.0, *amount, &fire));
    scene.particles = [fire].into_iter().chain(smoke.clone()).collect();
    let with_fire = drawn(&scene);
    scene.settings.fire.intensity = 0.0;
    let without = drawn(&scene);
    let middle = IVec2::new(SIZE.x as i32 / 2, SIZE.y as i32 / 2);
    (with_fire.load(middle) - without.load(middle)).truncate()
}

#[test]
fn smoke_in_front_dims_a_fire_by_its_transmittance() {
    let alone = seen_through(&[]);
    assert!(alone.max_element() > 0.5, "{alone}");
    for layers in 1..=4 {
        let amounts = vec![0.5; layers];
        let seen = seen_through(&amounts);
        let expected = alone * 0.5_f32.powi(layers as i32);
        let error = ((seen - expected) / expected).abs().max_element();
        println!("{layers} layers: {seen}, expected {expected}, off by {:.1} %", 100.0 * error);
        // The alpha of the sprite's image is not exactly 1 in its middle.
        assert!(error < 0.1, "{layers} layers: {seen}, expected {expected}");
    }
}

#[test]
fn one_system_draws_what_fire_and_smoke_draw_in_separate_passes() {
    let mut scene = lit_by_fire();
    // One row: the light does not depend on the amount, which is another in one system.
    scene.material.fire_ramp = Ramp::from_linear(UVec2::new(2, 1), [Vec3::ZERO, vec3(1.0, 0.5, 0.2)]);
    let like = scene.particles[0];
    let at = |index: u32, z: f32, age: f32| {
        let turn = index as f32 * 2.4;
        let position = vec3(turn.cos(), turn.sin(), 0.0) * 0.4 * (index as f32).sqrt();
        Particle { position: position.with_z(z - 0.01 * index as f32), ..puff(z, age, 0.4, &like) }
    };
    let fire: Vec<_> = (0..12).map(|index| at(index, -6.5, 0.0)).collect();
    let smoke: Vec<_> = (0..12).map(|index| at(index + 5, -5.5, 1.0)).collect();
    for path in [RenderPath::Raster, RenderPath::Tiled] {
        if path == RenderPath::Tiled && !is_tiled_available() {
            continue;
        }
        scene.settings.path = path;
        let drawn_with = |particles: &[&[Particle]], others: &[Particle]| {
            let others = (!others.is_empty()).then(|| (others.to_vec(), scene.settings));
            drawn(&TestScene { particles: particles.concat(), others: others.into_iter().collect(), ..scene.clone() })
        };
        let one = drawn_with(&[&smoke, &fire], &[]);
        let two = drawn_with(&[&fire], &smoke);
        let fire_alone = drawn_with(&[&fire], &[]);
        let smoke_alone = drawn_with(&[&smoke], &[]);
        let agreement = psnr(&one, &two);
        // Each layer is rounded to half floats, in one system and in two at other positions.
        assert!(agreement >= 60.0, "{path:?}: {agreement}");
        let effect = psnr(&one, &fire_alone).max(psnr(&one, &smoke_alone));
        println!("{path:?}: {agreement:.1} dB; without one of them {effect:.1}");
        assert!(effect < 40.0, "{path:?}: {effect}");
    }
}

#[test]
fn cold_smoke_gives_no_light_and_strange_ages_are_harmless() {
    let mut scene = burning();
    scene.settings.fire.intensity = 1000.0;
    for (particle, age) in scene.particles.iter_mut().zip([f32::NAN, 1.0e30, -5.0, f32::INFINITY]) {
        particle.age = age;
    }
    let seen = drawn(&scene);
    assert!(seen.texels.iter().all(|texel| texel.is_finite()));
    let mut cold = burning();
    cold.material.heat_ramp = Ramp::from_linear(UVec2::new(2, 1), [Vec3::ZERO; 2]);
    let mut without = cold.clone();
    without.settings.fire.intensity = 0.0;
    assert!(psnr(&drawn(&cold), &drawn(&without)) > 70.0);
}

fn light(
    particles: &[Particle],
    particles_per_sample: u32,
    settings: &Settings,
    assets: &MaterialAssets,
) -> Option<Light> {
    FireLight { particles, particles_per_sample, settings, assets, time: 9.0, seed: 1 }.estimate()
}

/// Settings and images of a fire, without flicker.
fn steady_fire() -> (Settings, MaterialAssets) {
    let mut settings = Settings::default();
    settings.fire.intensity = 4.0;
    settings.fire.flicker = 0.0;
    (settings, MaterialSources::default().load(ImageSource::BuiltIn).unwrap())
}

#[test]
fn light_of_a_fire_is_where_it_burns() {
    let (settings, assets) = steady_fire();
    let emitter = Emitter { position: Vec3::new(3.0, 1.0, -2.0), ..Emitter::default() };
    let mut particles = Vec::new();
    emitter.evaluate(9.0, &mut particles);
    let found = light(&particles, 1, &settings, &assets).unwrap();
    assert!(found.position.distance(emitter.position) < 2.0 && found.intensity > 0.1, "{found:?}");
    assert!(found.color.x > found.color.y && found.color.y > found.color.z, "{found:?}");
    // Far fewer than half of the particles are hot: it is nearer to the source than their mean.
    let mean = particles.iter().map(|particle| particle.position.y).sum::<f32>() / particles.len() as f32;
    assert!(found.position.y < mean, "{} {mean}", found.position.y);
    // A sample has the same light, but for the chance by which it holds more or fewer of the hottest.
    let half: Vec<_> = particles.iter().copied().step_by(2).collect();
    let sampled = light(&half, 2, &settings, &assets).unwrap();
    assert!((sampled.intensity / found.intensity - 1.0).abs() < 0.15, "{sampled:?} {found:?}");
    // Cold smoke gives none.
    let cold: Vec<_> = particles.iter().map(|particle| Particle { age: 1.0, ..*particle }).collect();
    assert_eq!(light(&cold, 1, &settings, &assets), None);
    assert_eq!(light(&particles, 1, &Settings::default(), &assets), None);
}

#[test]
fn light_of_strange_particles_is_valid_or_none() {
    let (mut settings, assets) = steady_fire();
    settings.fire.intensity = 1000.0;
    let particle = Particle { position: Vec3::splat(1.0e8), ..Particle::default() };
    for strange in [
        particle,
        Particle { radius: 1.0e9, ..particle },
        Particle { age: f32::NAN, ..particle },
        Particle { age: -1.0e30, ..particle },
        Particle { radius: 1.0e-20, ..particle },
    ] {
        let particles = &[strange];
        let fire = FireLight {
            particles,
            particles_per_sample: 1,
            settings: &settings,
            assets: &assets,
            time: f64::MAX,
            seed: 3,
        };
        let Some(light) = fire.estimate() else { continue };
        assert!((0.0..=1.0e9).contains(&light.intensity) && (0.0..=1.0e4).contains(&light.radius), "{light:?}");
        assert!(light.position.is_finite() && light.color.is_finite() && light.range >= 0.01, "{light:?}");
    }
}
