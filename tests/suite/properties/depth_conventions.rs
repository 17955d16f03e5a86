//! Depth conventions, and cameras inside the bounds of the smoke.

use glam::camera::rh::proj::directx;
use glam::{Mat4, Vec3, Vec4, vec3, vec4};
use haze::{Bounds, wgpu};
use haze_core::settings::{DebugView, DiffuseMode, RenderPath};

use super::SIZE;
use crate::gpu::gpu;
use crate::psnr::{MIN_PSNR, psnr};
use crate::test_scene::{BACKDROP, DepthKind, TestScene};

fn reversed(projection: Mat4) -> Mat4 {
    let flip = Mat4::from_cols(Vec4::X, Vec4::Y, vec4(0.0, 0.0, -1.0, 0.0), vec4(0.0, 0.0, 1.0, 1.0));
    flip * projection
}

#[test]
fn every_depth_convention_gives_the_same_image() {
    let fov = 0.8;
    let aspect = SIZE.x as f32 / SIZE.y as f32;
    let perspective = directx::perspective(fov, aspect, 0.1, 80.0);
    let orthographic = directx::orthographic(-4.0, 4.0, -2.25, 2.25, 0.1, 80.0);
    let families = [
        vec![
            perspective,
            reversed(perspective),
            directx::perspective_infinite(fov, aspect, 0.1),
            directx::perspective_infinite_reverse(fov, aspect, 0.1),
        ],
        vec![orthographic, reversed(orthographic)],
    ];
    for family in families {
        let mut standard = None;
        for clip_from_view in family {
            for depth in [DepthKind::Buffer, DepthKind::Linear] {
                let mut scene = TestScene::new(SIZE);
                scene.view.clip_from_view = clip_from_view;
                scene.depth = depth;
                let image = scene.on_gpu(gpu()).image;
                let reference = psnr(&image, &scene.on_cpu());
                assert!(reference >= MIN_PSNR, "{clip_from_view}: {reference:.1} dB from the reference");
                let standard = standard.get_or_insert_with(|| image.clone());
                // Depth buffers of different conventions round differently; 90 dB were measured.
                let psnr = psnr(&image, standard);
                assert!(psnr >= 85.0, "{clip_from_view}, {depth:?}: {psnr:.1} dB from standard");
            }
        }
    }
}

#[test]
fn pass_without_a_depth_attachment_gives_the_same_image() {
    let mut scene = TestScene::new(SIZE);
    let tested = scene.on_gpu(gpu()).image;
    scene.attach_depth = false;
    for path in [RenderPath::Raster, RenderPath::Forward] {
        scene.settings.path = path;
        let image = scene.on_gpu(gpu()).image;
        let reference = psnr(&image, &scene.on_cpu());
        assert!(reference >= MIN_PSNR, "{path:?}: {reference:.1} dB");
        // Without a depth attachment the box is not depth-tested; only the soft fade hides smoke behind the scene.
        assert!(path == RenderPath::Forward || psnr(&image, &tested) >= 85.0);
    }
}

#[test]
fn webgl2_limits_are_enough_for_the_raster_and_forward_paths() {
    let webgl2 =
        haze_demo::headless::Headless::with(wgpu::Limits::downlevel_webgl2_defaults(), wgpu::Features::empty())
            .unwrap();
    let mut scene = TestScene::new(SIZE);
    for mode in DiffuseMode::ALL {
        scene.settings.diffuse.mode = *mode;
        let psnr = psnr(&scene.on_gpu(&webgl2).image, &scene.on_cpu());
        assert!(psnr >= MIN_PSNR, "{mode:?}: {psnr:.1} dB");
    }
    scene.settings.path = RenderPath::Forward;
    assert!(psnr(&scene.on_gpu(&webgl2).image, &scene.on_cpu()) >= MIN_PSNR);
    webgl2.check().unwrap();
}

#[test]
fn near_plane_cuts_no_hole_when_the_camera_enters_the_bounds() {
    // The camera moves from in front of the box through its front face and past its middle.
    for step in 0..=20 {
        let mut scene = TestScene::new(SIZE);
        let forward = 3.0 + 0.2 * step as f32;
        scene.view.view_from_world = Mat4::from_translation(vec3(0.0, 0.0, forward));
        scene.bounds = Some(Bounds { min: vec3(-5.0, -4.0, -8.0), max: vec3(5.0, 4.0, -4.0) });
        scene.debug_view = DebugView::ReducedDepth;
        scene.view.clip_from_view = directx::perspective(0.8, 16.0 / 9.0, 0.5, 80.0);
        let image = scene.on_gpu(gpu()).image;
        // From here on the box fills the view, and this debug view draws every pixel of the box.
        if forward >= 3.5 {
            assert!(image.texels.iter().all(|&texel| texel != BACKDROP), "{forward}: a hole");
        }
        scene.debug_view = DebugView::Final;
        // Only until the camera has passed the smoke.
        if forward < 6.3 {
            let psnr = psnr(&scene.on_gpu(gpu()).image, &scene.on_cpu());
            assert!(psnr >= MIN_PSNR, "{forward}: {psnr:.1} dB");
        }
    }
}

#[test]
fn bounds_beyond_the_far_plane_cut_no_hole() {
    let mut scene = TestScene::new(SIZE);
    scene.view.clip_from_view = directx::perspective(0.8, 16.0 / 9.0, 0.5, 20.0);
    scene.bounds = Some(Bounds { min: Vec3::splat(-50.0), max: Vec3::splat(50.0) });
    assert!(psnr(&scene.on_gpu(gpu()).image, &scene.on_cpu()) >= MIN_PSNR);
}
