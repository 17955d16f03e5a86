//! Targets and images stay finite for every input.

use glam::{UVec2, Vec3, vec3};
use haze::{Bounds, Particle};
use haze_core::settings::RenderPath;

use super::SIZE;
use crate::gpu::{gpu, non_finite_texels};
use crate::test_host::Host;
use crate::test_scene::{BACKDROP, TestScene};

#[test]
fn no_builtin_preset_writes_nan_or_infinity_to_a_target() {
    for preset in haze_preset::builtin::PRESETS {
        let preset = haze_preset::Preset::load(preset.name).unwrap();
        for system in &preset.systems {
            let size = UVec2::new(320, 180);
            let mut scene = TestScene::new(size);
            scene.view = preset.camera.view(size);
            scene.lights.clone_from(&preset.lights);
            scene.settings = system.settings;
            scene.settings.path = RenderPath::Raster;
            scene.material = system.material.load(haze_preset::ImageSource::BuiltIn).unwrap();
            system.emitter.evaluate(preset.time, &mut scene.particles);
            assert_all_finite(&scene, &scene.on_gpu(gpu()), &preset.name);
        }
    }
}

fn assert_all_finite(scene: &TestScene, drawn: &crate::test_host::RenderedFrame, name: &str) {
    assert!(drawn.image.texels.iter().all(|texel| texel.is_finite()), "{name}");
    let targets = drawn.renderer.targets(0).unwrap();
    assert!(targets.size.cmple(scene.view.size).all());
    for view in targets.accumulation.iter().chain(targets.reduced_depth) {
        assert_eq!(non_finite_texels(gpu(), view, targets.size), 0, "{name}");
    }
}

#[test]
fn particles_with_non_finite_or_huge_values_in_a_host_buffer_are_not_drawn() {
    let mut scene = TestScene::new(SIZE);
    scene.bounds = Some(Bounds { min: vec3(-4.0, -3.0, -9.0), max: vec3(4.0, 3.0, -3.0) });
    let mut host = Host::new(gpu(), &scene).unwrap();
    let good = Particle { position: vec3(0.0, 0.0, -6.0), amount: 0.5, ..Particle::default() };
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30, -1e30];
    let mut particles = Vec::new();
    for x in bad {
        particles.extend([
            Particle { position: good.position.with_x(x), ..good },
            Particle { position: good.position.with_z(x), ..good },
            Particle { radius: x, ..good },
            Particle { rotation: x, ..good },
            Particle { frame: x, ..good },
        ]);
    }
    particles.push(Particle { amount: f32::NAN, ..good });
    host.draw_buffer(gpu(), &scene, &particles).unwrap();
    assert!(host.image(gpu()).unwrap().texels.iter().all(|&texel| texel == BACKDROP));
    let targets = host.renderer.targets(0).unwrap();
    assert_eq!(non_finite_texels(gpu(), &targets.accumulation[0], targets.size), 0);
}

#[test]
fn degenerate_sprites_write_no_nan_or_infinity_to_a_target() {
    let mut scene = TestScene::new(SIZE);
    let somewhere = vec3(0.0, 0.0, -6.0);
    scene.particles.extend([
        Particle { position: Vec3::ZERO, radius: 1.0, ..Particle::default() },
        Particle { position: vec3(0.0, 0.0, -0.1), radius: 1e-20, ..Particle::default() },
        Particle { position: somewhere, radius: 1e9, ..Particle::default() },
        Particle { position: somewhere, rotation: 1e30, frame: -1e30, ..Particle::default() },
        Particle { position: somewhere, frame: f32::MAX, ..Particle::default() },
    ]);
    scene.bounds = Some(Bounds { min: vec3(-4.0, -3.0, -9.0), max: vec3(4.0, 3.0, -3.0) });
    for contrast_power in [0.1, 16.0] {
        scene.settings.soft_fade.curve = haze_core::settings::FadeCurve::Contrast;
        scene.settings.soft_fade.contrast_power = contrast_power;
        scene.settings.soft_fade.fade_scale = 1000.0;
        assert_all_finite(&scene, &scene.on_gpu(gpu()), "degenerate sprites");
    }
}
