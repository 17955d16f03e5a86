//! What light depends on, and what it must not.

use glam::{UVec2, Vec3, Vec4, vec3};
use haze::picture::Picture;
use haze::settings::{DiffuseMode, Path, ShadeTree, Technique};
use haze::{Light, LightKind, Particle};
use haze_reference::{Frame, System};

use crate::common::{AGREEMENT, gpu, psnr};
use crate::stage::{BACKDROP, Stage};

const SIZE: UVec2 = UVec2::new(96, 64);

fn largest_difference(a: &Picture<Vec4>, b: &Picture<Vec4>) -> f32 {
    a.texels.iter().zip(&b.texels).map(|(a, b)| (*a - *b).abs().max_element()).fold(0.0, f32::max)
}

#[test]
fn what_cannot_be_seen_lights_nothing_anew() {
    let alone = Stage::new(SIZE);
    let dead = Particle { position: vec3(-1000.0, -1000.0, -1000.0), ..Particle::default() };
    for unseen in
        [Particle { radius: 0.0, ..dead }, Particle { amount: 0.0, ..dead }, Particle { amount: -1.0, ..dead }]
    {
        let mut beside = alone.clone();
        beside.particles.push(unseen);
        assert_eq!(largest_difference(&alone.on_cpu(), &beside.on_cpu()), 0.0, "{unseen:?}");
    }
}

#[test]
fn an_ember_far_behind_lights_nothing_anew() {
    let alone = Stage::new(SIZE);
    let mut beside = alone.clone();
    let ember = Particle { position: vec3(1.9, 0.5, -12.0), radius: 0.02, amount: 0.01, ..Particle::default() };
    beside.particles.push(ember);
    let difference = largest_difference(&alone.on_cpu(), &beside.on_cpu());
    assert!(difference < 0.004, "{difference}");
}

#[test]
fn a_sprite_that_is_born_comes_slowly() {
    let alone = Stage::new(SIZE);
    let step = |amount| {
        let mut beside = alone.clone();
        // In front of all others, and twice their size.
        beside.particles.push(Particle { position: vec3(0.0, 0.0, -3.0), radius: 1.0, amount, ..Particle::default() });
        largest_difference(&alone.on_cpu(), &beside.on_cpu())
    };
    // A new sprite changes what is seen as its own amount does.
    assert!(step(0.001) < 0.004, "{}", step(0.001));
    assert!(step(0.1) > 0.02, "{}", step(0.1));
}

#[test]
fn a_depth_that_is_no_number_is_refused_by_name() {
    let stage = Stage::new(SIZE);
    let system = System { depth: Some(f32::NAN), ..System::new(&stage.particles, &stage.settings, &stage.material) };
    let depth = stage.ndc_depth();
    let frame = Frame { systems: &[system], ..Frame::new(stage.view, &depth) };
    let error = haze_reference::render(&frame, &mut Picture::new(SIZE, Vec4::ZERO)).unwrap_err();
    assert_eq!(error.to_string(), "systems[0].depth: NaN is not valid; expected a finite number of metres, or None");
}

#[test]
fn a_glow_fades_out_at_the_range_of_its_light() {
    let glow = |range: f32| {
        let mut stage = Stage::new(SIZE);
        stage.shade_tree = ShadeTree::SpecularScatter;
        stage.lights.remove(0);
        stage.lights[0].range = range;
        let picture = stage.on_cpu();
        Picture { size: SIZE, texels: picture.texels.iter().map(|texel| *texel - BACKDROP).collect() }
    };
    let brightest = largest_difference(&glow(f32::INFINITY), &glow(0.01));
    assert!(brightest > 0.1, "{brightest}");
    // 5 cm a step.
    for step in 0..120 {
        let range = 0.1 + 0.05 * step as f32;
        let change = largest_difference(&glow(range), &glow(range + 0.05));
        assert!(change < 0.1 * brightest, "{range}: {change} of {brightest}");
    }
}

/// Share of the pixels whose brightest channel differs by more than a hundredth of itself.
fn share_apart(a: &Picture<Vec4>, b: &Picture<Vec4>) -> f32 {
    let apart = |(a, b): (&Vec4, &Vec4)| {
        let (a, b) = (a.truncate(), b.truncate());
        (a - b).abs().max_element() > 0.01 * a.max(b).max_element().max(0.05)
    };
    a.texels.iter().zip(&b.texels).filter(|pair| apart(*pair)).count() as f32 / a.texels.len() as f32
}

#[test]
fn lights_of_every_strength_agree() {
    let sun = Light { kind: LightKind::Directional, direction: vec3(-1.0, -1.0, -0.5), ..Light::default() };
    let lamp = Light { position: vec3(0.5, 0.3, -8.5), range: f32::INFINITY, radius: 0.0, ..Light::default() };
    for &mode in DiffuseMode::ALL {
        for path in [Path::Raster, Path::Forward] {
            for intensity in [1.0, 1.0e3, 1.2e5, 1.0e9] {
                let mut stage = Stage::new(SIZE);
                stage.lights = vec![Light { intensity, ..sun }, Light { intensity, ..lamp }];
                (stage.settings.diffuse.mode, stage.settings.path) = (mode, path);
                let (on_gpu, on_cpu) = (stage.on_gpu(gpu()).picture, stage.on_cpu());
                assert!(on_gpu.texels.iter().all(|texel| texel.is_finite()), "{} {intensity}", mode.name());
                let apart = share_apart(&on_gpu, &on_cpu);
                println!("{} {} {intensity:e}: {apart:.4}", mode.name(), path.name());
                assert!(apart < 0.01, "{} {} {intensity:e}: {apart}", mode.name(), path.name());
            }
        }
    }
}

/// Smoke with noise in it, and the camera, moved away from the world's origin.
fn moved(by: Vec3) -> Stage {
    let mut stage = Stage::new(SIZE);
    stage.settings.technique = Technique::VolumetricSoft;
    (stage.settings.volumetric.noise_size, stage.settings.volumetric.noise_octaves) = (1.5, 3);
    for particle in &mut stage.particles {
        // Places that f32 has there, too.
        particle.position = (particle.position * 128.0).round() / 128.0 + by;
    }
    for light in &mut stage.lights {
        light.position += by;
    }
    stage.view.view_from_world *= glam::Mat4::from_translation(-by);
    stage
}

#[test]
fn noise_is_as_fine_far_from_the_origin() {
    // Whole tiles, 49 km.
    let by = vec3(49_152.0, -24_576.0, 49_152.0);
    let (here, there) = (moved(Vec3::ZERO), moved(by));
    let (on_cpu, on_gpu) = (psnr(&here.on_cpu(), &there.on_cpu()), psnr(&here.on_cpu(), &there.on_gpu(gpu()).picture));
    println!("49 km away: {on_cpu:.1} dB, on the GPU {on_gpu:.1} dB");
    assert!(on_cpu > 90.0 && on_gpu > AGREEMENT, "{on_cpu} {on_gpu}");
}

#[test]
fn noise_rises_along_up() {
    let risen = |up: Vec3, time: f32| {
        let mut stage = moved(Vec3::ZERO);
        (stage.up, stage.time, stage.settings.volumetric.scroll_speed) = (up, time, 0.25);
        stage.on_cpu()
    };
    let still = risen(Vec3::Y, 0.0);
    assert!(psnr(&risen(Vec3::Y, 1.0), &risen(Vec3::Z, 1.0)) < 60.0);
    // A tile of 1.5 m, at 0.25 m a second.
    for up in [Vec3::Y, Vec3::Z * 7.0, Vec3::NEG_X] {
        assert!(psnr(&still, &risen(up, 6.0)) > 80.0, "{up}");
        assert!(psnr(&still, &risen(up, 3.0)) < 60.0, "{up}");
    }
}
