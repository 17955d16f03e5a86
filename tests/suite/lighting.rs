//! Dependence of lighting on other particles, light range and intensity, the world's origin and the up vector.

use glam::{Mat4, UVec2, Vec3, Vec4, vec3};
use haze::{Light, LightKind, Particle, SpriteExtent, particle_bounds};
use haze_core::assets::image::Image;
use haze_core::formula::lighting::cone_attenuation;
use haze_core::settings::{DebugView, DiffuseMode, RenderPath, Technique};
use haze_reference::{FrameInput, ParticleSystem};

use crate::gpu::gpu;
use crate::psnr::{MIN_PSNR, psnr};
use crate::test_scene::{BACKDROP, TestScene};

const SIZE: UVec2 = UVec2::new(96, 64);

fn largest_difference(a: &Image<Vec4>, b: &Image<Vec4>) -> f32 {
    a.texels.iter().zip(&b.texels).map(|(a, b)| (*a - *b).abs().max_element()).fold(0.0, f32::max)
}

#[test]
fn invisible_particles_do_not_change_the_image() {
    let original = TestScene::new(SIZE);
    let dead = Particle { position: vec3(-1000.0, -1000.0, -1000.0), ..Particle::default() };
    for unseen in
        [Particle { radius: 0.0, ..dead }, Particle { amount: 0.0, ..dead }, Particle { amount: -1.0, ..dead }]
    {
        let mut with_particle = original.clone();
        with_particle.particles.push(unseen);
        assert_eq!(largest_difference(&original.on_cpu(), &with_particle.on_cpu()), 0.0, "{unseen:?}");
    }
}

#[test]
fn tiny_particle_far_behind_barely_changes_the_image() {
    let original = TestScene::new(SIZE);
    let mut with_particle = original.clone();
    let ember = Particle { position: vec3(1.9, 0.5, -12.0), radius: 0.02, amount: 0.01, ..Particle::default() };
    with_particle.particles.push(ember);
    let difference = largest_difference(&original.on_cpu(), &with_particle.on_cpu());
    assert!(difference < 0.004, "the image changes by {difference}");
}

#[test]
fn new_sprite_changes_the_image_in_proportion_to_its_amount() {
    let original = TestScene::new(SIZE);
    let step = |amount| {
        let mut with_particle = original.clone();
        // In front of all other sprites, and larger than any other.
        with_particle.particles.push(Particle {
            position: vec3(0.0, 0.0, -3.0),
            radius: 1.0,
            amount,
            ..Particle::default()
        });
        largest_difference(&original.on_cpu(), &with_particle.on_cpu())
    };
    // The image changes about as much as the new sprite's amount.
    assert!(step(0.001) < 0.004, "amount 0.001 changes the image by {}", step(0.001));
    assert!(step(0.1) > 0.02, "amount 0.1 changes the image by {}", step(0.1));
}

#[test]
fn nan_depth_is_an_error_that_names_the_field() {
    let scene = TestScene::new(SIZE);
    let system = ParticleSystem {
        depth: Some(f32::NAN),
        ..ParticleSystem::new(&scene.particles, &scene.settings, &scene.material)
    };
    let depth = scene.ndc_depth();
    let frame = FrameInput { systems: &[system], ..FrameInput::new(scene.view, &depth) };
    let error = haze_reference::render(&frame, &mut Image::new(SIZE, Vec4::ZERO)).unwrap_err();
    assert_eq!(error.to_string(), "systems[0].depth: NaN is not valid; expected a finite number of metres, or None");
}

#[test]
fn glow_changes_continuously_with_the_lights_range() {
    let glow = |range: f32| {
        let mut scene = TestScene::new(SIZE);
        scene.debug_view = DebugView::SpecularScatter;
        scene.lights.remove(0);
        scene.lights[0].range = range;
        let image = scene.on_cpu();
        Image { size: SIZE, texels: image.texels.iter().map(|texel| *texel - BACKDROP).collect() }
    };
    let brightest = largest_difference(&glow(f32::INFINITY), &glow(0.01));
    assert!(brightest > 0.1, "the glow adds at most {brightest}");
    // The range grows by 5 cm per step.
    for step in 0..120 {
        let range = 0.1 + 0.05 * step as f32;
        let change = largest_difference(&glow(range), &glow(range + 0.05));
        assert!(change < 0.1 * brightest, "range {range} m: the glow changes by {change} of {brightest}");
    }
}

#[test]
fn the_glow_of_a_spot_is_what_it_sends_to_the_viewer() {
    let mut scene = TestScene::new(SIZE);
    scene.debug_view = DebugView::SpecularScatter;
    scene.lights.remove(0);
    let lamp = scene.lights[0];
    let viewer = scene.view.view_from_world.inverse().transform_point3(Vec3::ZERO);
    let mut images_of = |light: Light| {
        scene.lights = vec![light];
        [scene.on_cpu(), scene.on_gpu(gpu()).image]
    };
    let brightest = |image: &Image<Vec4>| {
        image.texels.iter().map(|texel| (*texel - BACKDROP).truncate().max_element()).fold(0.0, f32::max)
    };
    let spot = |direction| Light { kind: LightKind::Spot, direction, ..lamp };
    let of_lamp = images_of(lamp);
    let towards = images_of(spot(viewer - lamp.position));
    let away = images_of(spot(lamp.position - viewer));
    for renderer in 0..2 {
        assert!(brightest(&of_lamp[renderer]) > 0.1);
        let apart = largest_difference(&of_lamp[renderer], &towards[renderer]);
        assert!(apart < 1.0e-3, "towards the viewer, a spot glows like a lamp, not {apart} apart");
        let rest = brightest(&away[renderer]);
        assert!(rest < 1.0e-3, "a spot that shines away glows by {rest}");
    }
}

#[test]
fn with_falloff_equal_light_on_the_smoke_glows_equally() {
    let mut scene = TestScene::new(SIZE);
    scene.debug_view = DebugView::SpecularScatter;
    scene.lights.remove(0);
    let lamp = Light { radius: 0.0, range: f32::INFINITY, ..scene.lights[0] };
    let center = particle_bounds(&scene.particles, SpriteExtent::from_settings(&scene.settings)).center();
    let brightest = |scene: &TestScene| {
        [scene.on_cpu(), scene.on_gpu(gpu()).image].map(|image| {
            image.texels.iter().map(|texel| (*texel - BACKDROP).truncate().max_element()).fold(0.0, f32::max)
        })
    };
    // The lamp moves away from the smoke and is as much stronger as its light on the smoke needs.
    let mut glows = |distance: f32, falloff: f32| {
        let position = center + (lamp.position - center) * distance;
        scene.lights = vec![Light { position, intensity: lamp.intensity * distance * distance, ..lamp }];
        scene.settings.specular_scatter.falloff = falloff;
        brightest(&scene)
    };
    for renderer in 0..2 {
        let [near, far] = [1.0, 2.0].map(|distance| glows(distance, 1.0)[renderer]);
        assert!((far / near - 1.0).abs() < 0.2, "{near} and {far}");
        let [near, far] = [1.0, 2.0].map(|distance| glows(distance, 0.0)[renderer]);
        assert!(far / near > 3.0, "{near} and {far}");
    }
}

#[test]
fn narrow_spots_are_as_bright_on_their_axis_as_wide_ones() {
    for outer_angle in [0.02_f32, 0.5, 0.8, 1.0, 35.0] {
        let spot = Light {
            kind: LightKind::Spot,
            direction: vec3(0.3, -0.2, -1.0),
            inner_angle: 0.8 * outer_angle,
            outer_angle,
            ..Light::default()
        };
        let uniform = spot.uniform(&Mat4::IDENTITY);
        let aside = uniform.direction.any_orthonormal_vector();
        for fraction in [0.0, 0.7, 0.85, 0.95, 1.05] {
            let angle = f64::from(fraction * outer_angle).to_radians();
            let direction = uniform.direction * angle.cos() as f32 + aside * angle.sin() as f32;
            let [inner, outer] = [0.8, 1.0].map(|fraction| (fraction * f64::from(outer_angle)).to_radians().cos());
            let law = ((angle.cos() - outer) / (inner - outer)).clamp(0.0, 1.0).powi(2) as f32;
            let found = cone_attenuation(&uniform, direction);
            assert!((found - law).abs() < 2.0e-3, "{outer_angle}° at {fraction} of it: {found}, not {law}");
        }
    }
}

/// Fraction of pixels in which a channel differs by more than 1 % of the pixel's brightest channel.
fn differing_fraction(a: &Image<Vec4>, b: &Image<Vec4>) -> f32 {
    let apart = |(a, b): (&Vec4, &Vec4)| {
        let a = a.truncate();
        let b = b.truncate();
        (a - b).abs().max_element() > 0.01 * a.max(b).max_element().max(0.05)
    };
    a.texels.iter().zip(&b.texels).filter(|pair| apart(*pair)).count() as f32 / a.texels.len() as f32
}

#[test]
fn gpu_and_cpu_agree_for_lights_of_every_intensity() {
    let sun = Light { kind: LightKind::Directional, direction: vec3(-1.0, -1.0, -0.5), ..Light::default() };
    let lamp = Light { position: vec3(0.5, 0.3, -8.5), range: f32::INFINITY, radius: 0.0, ..Light::default() };
    for &mode in DiffuseMode::ALL {
        for path in [RenderPath::Raster, RenderPath::Forward] {
            for intensity in [1.0, 1.0e3, 1.2e5, 1.0e9] {
                let mut scene = TestScene::new(SIZE);
                scene.lights = vec![Light { intensity, ..sun }, Light { intensity, ..lamp }];
                scene.settings.diffuse.mode = mode;
                scene.settings.path = path;
                let on_gpu = scene.on_gpu(gpu()).image;
                let on_cpu = scene.on_cpu();
                assert!(on_gpu.texels.iter().all(|texel| texel.is_finite()), "{} {intensity}: not finite", mode.name());
                let apart = differing_fraction(&on_gpu, &on_cpu);
                println!("{} {} {intensity:e}: {apart:.4} of the pixels differ", mode.name(), path.name());
                assert!(apart < 0.01, "{} {} {intensity:e}: {apart} of the pixels differ", mode.name(), path.name());
            }
        }
    }
}

/// Volumetric smoke, lights and camera, all translated by `by`, metres.
fn moved(by: Vec3) -> TestScene {
    let mut scene = TestScene::new(SIZE);
    scene.settings.technique = Technique::VolumetricSoft;
    scene.settings.volumetric.noise_size = 1.5;
    scene.settings.volumetric.noise_octaves = 3;
    // Wider than the image: rounding of the light's position moves a small glow visibly.
    scene.settings.specular_scatter.size = 1800.0;
    for particle in &mut scene.particles {
        // Multiples of 1/128 m stay exact in f32 after the translation.
        particle.position = (particle.position * 128.0).round() / 128.0 + by;
    }
    for light in &mut scene.lights {
        light.position += by;
    }
    scene.view.view_from_world *= Mat4::from_translation(-by);
    scene
}

#[test]
fn noise_keeps_its_precision_far_from_the_origin() {
    // Whole multiples of the 1.5 m noise tile, so the image must be the same; 49 km.
    let by = vec3(49_152.0, -24_576.0, 49_152.0);
    let here = moved(Vec3::ZERO);
    let there = moved(by);
    let on_cpu = psnr(&here.on_cpu(), &there.on_cpu());
    let on_gpu = psnr(&here.on_cpu(), &there.on_gpu(gpu()).image);
    println!("49 km away: {on_cpu:.1} dB, on the GPU {on_gpu:.1} dB");
    assert!(on_cpu > 90.0 && on_gpu > MIN_PSNR, "CPU {on_cpu} dB, GPU {on_gpu} dB");
}

#[test]
fn noise_scrolls_along_the_up_vector() {
    let scrolled = |up: Vec3, time: f64| {
        let mut scene = moved(Vec3::ZERO);
        scene.up = up;
        scene.time = time;
        scene.settings.volumetric.scroll_speed = 0.25;
        scene.on_cpu()
    };
    let still = scrolled(Vec3::Y, 0.0);
    assert!(psnr(&scrolled(Vec3::Y, 1.0), &scrolled(Vec3::Z, 1.0)) < 60.0);
    // A noise tile of 1.5 m that scrolls by 0.25 m/s repeats every 6 s.
    for up in [Vec3::Y, Vec3::Z * 7.0, Vec3::NEG_X] {
        assert!(psnr(&still, &scrolled(up, 6.0)) > 80.0, "up {up}: differs after 6 s");
        assert!(psnr(&still, &scrolled(up, 3.0)) < 60.0, "up {up}: the same after 3 s");
    }
}

#[test]
fn exposure_multiplies_all_light_of_the_smoke() {
    for (path, mode) in [
        (RenderPath::Raster, DiffuseMode::Ramp),
        (RenderPath::Raster, DiffuseMode::Cubemap),
        (RenderPath::Raster, DiffuseMode::SphericalHarmonics),
        (RenderPath::Forward, DiffuseMode::Ramp),
    ] {
        let mut scene = TestScene::new(SIZE);
        scene.settings.path = path;
        scene.settings.diffuse.mode = mode;
        let mut brighter = scene.clone();
        brighter.lights.iter_mut().for_each(|light| light.intensity *= 3.0);
        brighter.settings.soft_scatter.scatter_color *= 3.0;
        brighter.settings.soft_scatter.ambient_color *= 3.0;
        scene.exposure = 3.0;
        let on_cpu = scene.on_cpu();
        let on_gpu = scene.on_gpu(gpu()).image;
        assert!(largest_difference(&on_cpu, &brighter.on_cpu()) < 1.0e-4, "{mode:?}");
        assert!(psnr(&on_cpu, &on_gpu) > MIN_PSNR, "{path:?} {mode:?}");
    }
}
