//! Every depth convention, and the camera in the smoke.

use glam::camera::rh::proj::directx;
use glam::{Mat4, Vec3, Vec4, vec3, vec4};
use haze::settings::{DiffuseMode, Path, ShadeTree};
use haze::{Bounds, wgpu};

use super::SIZE;
use crate::common::{AGREEMENT, gpu, psnr};
use crate::stage::{BACKDROP, DepthKind, Stage};

fn reversed(projection: Mat4) -> Mat4 {
    let flip = Mat4::from_cols(Vec4::X, Vec4::Y, vec4(0.0, 0.0, -1.0, 0.0), vec4(0.0, 0.0, 1.0, 1.0));
    flip * projection
}

#[test]
fn every_depth_convention_gives_the_same_picture() {
    let (fov, aspect) = (0.8, SIZE.x as f32 / SIZE.y as f32);
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
                let mut stage = Stage::new(SIZE);
                stage.view.clip_from_view = clip_from_view;
                stage.depth = depth;
                let picture = stage.on_gpu(gpu()).picture;
                let reference = psnr(&picture, &stage.on_cpu());
                assert!(reference >= AGREEMENT, "{clip_from_view}: {reference:.1} dB from the reference");
                let standard = standard.get_or_insert_with(|| picture.clone());
                // Depth buffers of different conventions round differently: 90 dB were found.
                let psnr = psnr(&picture, standard);
                assert!(psnr >= 85.0, "{clip_from_view}, {depth:?}: {psnr:.1} dB from standard");
            }
        }
    }
}

#[test]
fn a_pass_without_depth_gives_the_same_picture() {
    let mut stage = Stage::new(SIZE);
    let tested = stage.on_gpu(gpu()).picture;
    stage.attach_depth = false;
    for path in [Path::Raster, Path::Forward] {
        stage.settings.path = path;
        let picture = stage.on_gpu(gpu()).picture;
        let reference = psnr(&picture, &stage.on_cpu());
        assert!(reference >= AGREEMENT, "{path:?}: {reference:.1} dB");
        // The box is not tested then, and the fade alone hides what is behind the scene.
        assert!(path == Path::Forward || psnr(&picture, &tested) >= 85.0);
    }
}

#[test]
fn the_limits_of_webgl2_are_enough() {
    let webgl2 =
        haze_demo::headless::Headless::with(wgpu::Limits::downlevel_webgl2_defaults(), wgpu::Features::empty())
            .unwrap();
    let mut stage = Stage::new(SIZE);
    for mode in DiffuseMode::ALL {
        stage.settings.diffuse.mode = *mode;
        let psnr = psnr(&stage.on_gpu(&webgl2).picture, &stage.on_cpu());
        assert!(psnr >= AGREEMENT, "{mode:?}: {psnr:.1} dB");
    }
    stage.settings.path = Path::Forward;
    assert!(psnr(&stage.on_gpu(&webgl2).picture, &stage.on_cpu()) >= AGREEMENT);
    webgl2.check().unwrap();
}

#[test]
fn the_near_plane_cuts_no_hole() {
    // From in front of the box, through its front face, to the middle of it.
    for step in 0..=20 {
        let mut stage = Stage::new(SIZE);
        let forward = 3.0 + 0.2 * step as f32;
        stage.view.view_from_world = Mat4::from_translation(vec3(0.0, 0.0, forward));
        stage.bounds = Some(Bounds { min: vec3(-5.0, -4.0, -8.0), max: vec3(5.0, 4.0, -4.0) });
        stage.shade_tree = ShadeTree::ReducedDepth;
        stage.view.clip_from_view = directx::perspective(0.8, 16.0 / 9.0, 0.5, 80.0);
        let picture = stage.on_gpu(gpu()).picture;
        // From here on the box fills the view, and this stage paints every pixel of it.
        if forward >= 3.5 {
            assert!(picture.texels.iter().all(|&texel| texel != BACKDROP), "{forward}: a hole");
        }
        stage.shade_tree = ShadeTree::Final;
        // Until the camera has passed the smoke.
        if forward < 6.3 {
            let psnr = psnr(&stage.on_gpu(gpu()).picture, &stage.on_cpu());
            assert!(psnr >= AGREEMENT, "{forward}: {psnr:.1} dB");
        }
    }
}

#[test]
fn a_box_beyond_the_far_plane_shows_no_hole() {
    let mut stage = Stage::new(SIZE);
    stage.view.clip_from_view = directx::perspective(0.8, 16.0 / 9.0, 0.5, 20.0);
    stage.bounds = Some(Bounds { min: Vec3::splat(-50.0), max: Vec3::splat(50.0) });
    assert!(psnr(&stage.on_gpu(gpu()).picture, &stage.on_cpu()) >= AGREEMENT);
}
