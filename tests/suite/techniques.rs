//! Intersection of sprites with the scene under every technique: agreement of the renderers, and the documented
//! behavior of each.

mod flipbook;
mod intersection;
mod invalid_input;

use glam::camera::rh::proj::directx;
use glam::{Mat4, UVec2, Vec4, vec3};
use haze::{Bounds, Particle};
use haze_core::assets::image::Image;
use haze_core::settings::*;

pub use self::flipbook::flipbook;
use crate::gpu::gpu;
use crate::psnr::{MIN_PSNR, MIN_PSNR_WITH_STEPS, psnr};
use crate::test_host::Host;
use crate::test_scene::{DepthKind, TestScene};

const SIZE: UVec2 = UVec2::new(160, 90);

/// The test cloud with every input that a technique may read.
pub fn scene(technique: Technique) -> TestScene {
    let mut scene = TestScene::new(SIZE);
    scene.depth = DepthKind::Both;
    // Because a linear target is passed too, the depth buffer can be attached on every backend.
    scene.attach_depth = true;
    scene.settings.technique = technique;
    scene.settings.volumetric.noise_size = 1.5;
    for (index, particle) in (0..).zip(&mut scene.particles) {
        particle.age = index as f32 / 59.0;
    }
    scene
}

/// A single sprite straight ahead at `view_depth` metres.
fn one_sprite(technique: Technique, view_depth: f32) -> TestScene {
    let mut scene = scene(technique);
    scene.particles =
        vec![Particle { position: vec3(0.0, 0.0, -view_depth), amount: 0.8, radius: 0.7, ..Particle::default() }];
    scene.bounds = Some(Bounds { min: vec3(-3.0, -3.0, -12.0), max: vec3(3.0, 3.0, 3.0) });
    scene.settings.soft_fade.near_fade_end = 0.0;
    scene.settings.accumulate.downscale = 1;
    scene.debug_view = DebugView::Amount;
    scene
}

fn assert_agreement(name: &str, scene: &TestScene) {
    let psnr = psnr(&scene.on_gpu(gpu()).image, &scene.on_cpu());
    println!("{name}: {psnr:.1} dB");
    let least = if scene.settings.debug.checkerboard { MIN_PSNR_WITH_STEPS } else { MIN_PSNR };
    assert!(psnr >= least, "{name}: {psnr:.1} dB");
}

#[test]
fn every_technique_fades_to_nothing_at_the_near_plane() {
    for near in [0.1, 0.3] {
        for &technique in Technique::ALL {
            let scene_at = |view_depth: f32| {
                let mut scene = one_sprite(technique, view_depth);
                scene.view.clip_from_view = directx::perspective(0.8, 16.0 / 9.0, near, 80.0);
                scene
            };
            let amount = |image: &Image<Vec4>| image.texels.iter().map(|texel| texel.x).fold(0.0, f32::max);
            // Bisects for the depth at which the sprite disappears.
            let mut hidden = near - 1.5;
            let mut shown = near + 1.5;
            assert!(amount(&scene_at(shown).on_cpu()) > 0.3, "{}", technique.name());
            while shown - hidden > 1.0e-4 {
                let middle = 0.5 * (hidden + shown);
                if amount(&scene_at(middle).on_cpu()) > 0.0 {
                    shown = middle;
                } else {
                    hidden = middle;
                }
            }
            let millimetre_later = scene_at(shown + 1.0e-3);
            for image in [millimetre_later.on_cpu(), millimetre_later.on_gpu(gpu()).image] {
                let found = amount(&image);
                assert!(found < 0.02, "{}, near plane {near} m: {found} after a millimetre", technique.name());
            }
        }
    }
}

#[test]
fn gpu_and_cpu_agree_on_every_technique_and_path() {
    for &technique in Technique::ALL {
        for path in [RenderPath::Raster, RenderPath::Forward] {
            let mut scene = scene(technique);
            scene.settings.path = path;
            assert_agreement(&format!("{} {}", technique.name(), path.name()), &scene);
            if path == RenderPath::Raster {
                let mut weighted = scene.clone();
                weighted.settings.accumulate.order = BlendOrder::Weighted;
                assert_agreement(&format!("{} weighted", technique.name()), &weighted);
            }
            scene.settings.soft_fade.curve = FadeCurve::Always;
            assert_agreement(&format!("{} {} always", technique.name(), path.name()), &scene);
        }
        let mut scene = scene(technique);
        scene.settings.accumulate.depth_source = DepthSource::Host;
        scene.settings.accumulate.downscale = 1;
        assert_agreement(&format!("{} host depth", technique.name()), &scene);
        let mut scene = self::scene(technique);
        scene.view.clip_from_view = directx::orthographic(-4.0, 4.0, -2.25, 2.25, 0.1, 80.0);
        assert_agreement(&format!("{} orthographic", technique.name()), &scene);
        // Off-center projection, and a rotated and translated camera: noise and sphere bounds depend on them.
        let mut scene = self::scene(technique);
        scene.view.clip_from_view = directx::frustum(-0.06, 0.03, -0.02, 0.03, 0.1, 80.0);
        let turn = Mat4::from_rotation_y(0.4) * Mat4::from_translation(vec3(1.0, -2.0, 3.0));
        scene.view.view_from_world *= turn;
        scene.particles.iter_mut().for_each(|p| p.position = turn.inverse().transform_point3(p.position));
        scene.lights.iter_mut().for_each(|l| l.position = turn.inverse().transform_point3(l.position));
        assert_agreement(&format!("{} off center", technique.name()), &scene);
    }
}

#[test]
fn border_texels_are_covered_at_every_size() {
    // If the image size is no multiple of the scale, the last texel extends beyond the image.
    for technique in [Technique::Soft, Technique::SphericalBillboard, Technique::VolumetricSoft] {
        for (size, scale) in [(UVec2::new(161, 91), 2), (UVec2::new(161, 91), 4), (UVec2::new(169, 97), 8)] {
            let mut scene = scene(technique);
            let sized = TestScene::new(size);
            scene.view = sized.view;
            scene.settings.accumulate.downscale = scale;
            // Moves sprites across the right and lower borders.
            scene.particles.iter_mut().for_each(|p| p.position += vec3(3.0, -1.5, 0.0));
            assert_agreement(&format!("{} {size} scale {scale}", technique.name()), &scene);
        }
    }
}

#[test]
fn switching_the_depth_input_keeps_the_targets() {
    let mut scene = scene(Technique::Soft);
    let mut host = Host::new(gpu(), &scene).unwrap();
    host.draw(gpu(), &scene).unwrap();
    let before = host.renderer.targets(0).unwrap().accumulation.to_vec();
    scene.settings.technique = Technique::SoftLinear;
    host.draw(gpu(), &scene).unwrap();
    assert_eq!(before, host.renderer.targets(0).unwrap().accumulation);
}

#[test]
fn freezing_the_animation_stops_the_noise() {
    let at = |time: f64, freeze_animation: bool| {
        let mut scene = scene(Technique::VolumetricSoft);
        scene.time = time;
        scene.settings.debug.freeze_animation = freeze_animation;
        scene.on_gpu(gpu()).image
    };
    assert_eq!(at(0.0, true), at(7.3, true));
    assert!(psnr(&at(0.0, false), &at(7.3, false)) < MIN_PSNR);
    // After a scroll by one whole tile the image is the same.
    let mut scene = scene(Technique::VolumetricSoft);
    scene.settings.volumetric.scroll_speed = 0.25;
    let seconds_per_tile = scene.settings.volumetric.noise_size / 0.25;
    let first = scene.on_gpu(gpu()).image;
    scene.time += f64::from(seconds_per_tile);
    assert!(psnr(&first, &scene.on_gpu(gpu()).image) > 60.0);
}
