//! Frames of any size, without smoke, and with many lights.

use glam::camera::rh::proj::directx;
use glam::{UVec2, Vec3, vec3};
use haze::{Light, Particle, read_only_depth_is_supported};
use haze_core::settings::{DepthSource, DiffuseMode, RenderPath, Upsample};

use super::SIZE;
use crate::gpu::gpu;
use crate::psnr::{MIN_PSNR, psnr};
use crate::test_host::Host;
use crate::test_scene::{BACKDROP, TestScene};

#[test]
fn no_smoke_leaves_the_scene_untouched() {
    let untouched = |scene: &TestScene| {
        let drawn = scene.on_gpu(gpu());
        drawn.image.texels.iter().all(|&texel| texel == BACKDROP)
            && scene.on_cpu().texels.iter().all(|&t| t == BACKDROP)
    };
    let mut scene = TestScene::new(SIZE);
    assert!(!untouched(&scene));
    let particles = std::mem::take(&mut scene.particles);
    assert!(untouched(&scene));
    // Sprites that cannot be drawn are ignored.
    scene.particles = vec![
        Particle { position: Vec3::NAN, ..Particle::default() },
        Particle { radius: 0.0, position: vec3(0.0, 0.0, -6.0), ..Particle::default() },
        Particle { amount: 0.0, position: vec3(0.0, 0.0, -6.0), ..Particle::default() },
        Particle { radius: f32::INFINITY, ..Particle::default() },
        // Behind the camera.
        Particle { position: vec3(0.0, 0.0, 6.0), ..Particle::default() },
    ];
    assert!(untouched(&scene));
    // A valid cloud, but behind the camera.
    scene.particles =
        particles.iter().map(|p| Particle { position: p.position + vec3(0.0, 0.0, 20.0), ..*p }).collect();
    assert!(untouched(&scene));
    for path in [RenderPath::Raster, RenderPath::Forward] {
        scene.settings.path = path;
        scene.settings.accumulate.opacity = 0.0;
        scene.particles.clone_from(&particles);
        assert!(untouched(&scene));
    }
}

#[test]
fn odd_sizes_and_every_scale_match_the_reference() {
    for size in [UVec2::ONE, UVec2::new(1, 97), UVec2::new(641, 359), UVec2::new(3, 2)] {
        for scale in 1..=16 {
            let mut scene = TestScene::new(size);
            scene.settings.accumulate.downscale = scale;
            let drawn = scene.on_gpu(gpu());
            gpu().check().unwrap();
            assert!(drawn.image.texels.iter().all(|texel| texel.is_finite()), "{size} scale {scale}");
            // Hardware snaps corners to a grid of 1/256 pixel. That moves a sprite smaller than a pixel by a
            // considerable part of its size, so the two renderers no longer draw the same sprite.
            if size.min_element() > 64 {
                let psnr = psnr(&drawn.image, &scene.on_cpu());
                assert!(psnr >= MIN_PSNR, "{size} scale {scale}: {psnr:.1} dB");
            }
        }
    }
}

#[test]
fn size_and_settings_may_change_every_frame() {
    let mut scene = TestScene::new(SIZE);
    let mut host = Host::new(gpu(), &scene).unwrap();
    for step in 0..24_u32 {
        let size = UVec2::new(64 + 37 * (step % 5), 48 + 29 * (step % 7));
        let next = TestScene::new(size);
        scene.view = next.view;
        scene.particles = next.particles;
        let accumulate = &mut scene.settings.accumulate;
        accumulate.downscale = 1 + step % 6;
        accumulate.upsample = Upsample::ALL[step as usize % Upsample::ALL.len()];
        let tested = accumulate.downscale == 1 && read_only_depth_is_supported(&gpu().device);
        accumulate.depth_source = if tested { DepthSource::Host } else { DepthSource::Reduced };
        scene.settings.diffuse.mode = DiffuseMode::ALL[step as usize % DiffuseMode::ALL.len()];
        scene.settings.path = if step % 11 == 10 { RenderPath::Forward } else { RenderPath::Auto };
        // The renderer is kept; the host's textures are new.
        let mut resized = Host::with_context(gpu(), &scene, Some(host.renderer.context())).unwrap();
        std::mem::swap(&mut resized.renderer, &mut host.renderer);
        std::mem::swap(&mut resized, &mut host);
        host.draw(gpu(), &scene).unwrap();
        gpu().check().unwrap();
        let psnr = psnr(&host.image(gpu()).unwrap(), &scene.on_cpu());
        // A whole texel at a sprite's edge may differ, which is 36 pixels at scale 6 in a small image: 53 dB were
        // measured.
        assert!(psnr >= 50.0, "step {step}: {psnr:.1} dB");
    }
}

#[test]
fn max_side_limits_the_size_of_the_target() {
    let mut scene = TestScene::new(UVec2::new(641, 359));
    scene.settings.accumulate.downscale = 1;
    scene.settings.accumulate.max_side = 100;
    let drawn = scene.on_gpu(gpu());
    let targets = drawn.renderer.targets(0).unwrap();
    assert_eq!(targets.scale, 7);
    assert!(targets.size.max_element() <= 100);
    assert!(psnr(&drawn.image, &scene.on_cpu()) >= MIN_PSNR);
}

#[test]
fn reported_lit_depth_is_measured_from_the_hosts_viewer() {
    let aspect = SIZE.x as f32 / SIZE.y as f32;
    // Its near plane is behind the viewer, so haze internally moves the viewer back.
    let orthographic = directx::orthographic(-4.0, 4.0, -2.25, 2.25, -5.0, 80.0);
    for projection in [directx::perspective(0.8, aspect, 0.1, 80.0), orthographic] {
        let mut scene = TestScene::new(SIZE);
        scene.view.clip_from_view = projection;
        scene.particles = vec![Particle { position: vec3(0.0, 0.0, -6.0), ..Particle::default() }];
        let lit = scene.on_gpu(gpu()).renderer.targets(0).unwrap().lit_depth;
        assert!((lit - 6.0).abs() < 1e-3, "{lit}");
    }
}

#[test]
fn largest_light_count_matches_the_reference_and_one_more_light_is_rejected() {
    let mut scene = TestScene::new(SIZE);
    let light = |i: usize| Light {
        position: vec3((i % 16) as f32 - 8.0, (i / 16) as f32 - 4.0, -4.0),
        color: vec3((i % 3) as f32, (i % 5) as f32, (i % 7) as f32) * 0.1,
        range: 4.0,
        specular_scatter: 0.0,
        ..Light::default()
    };
    scene.lights = (0..haze_core::frame::MAX_LIGHTS).map(light).collect();
    assert!(psnr(&scene.on_gpu(gpu()).image, &scene.on_cpu()) >= MIN_PSNR);
    scene.lights.push(light(0));
    let Err(error) = scene.try_on_gpu(gpu()) else { panic!("129 lights were accepted") };
    assert_eq!(error.to_string(), "lights: 129 lights are too many; expected at most 128");
}
