//! Left- and right-handed views, any up axis, mirrored projections, and views of a part of the target.

use glam::camera::{lh, rh};
use glam::{Mat4, UVec2, Vec3, Vec4, vec3};
use haze::Bounds;
use haze::image::Image;
use haze::settings::*;

use super::{SIZE, field};
use crate::common::{AGREEMENT, gpu, psnr};
use crate::test_scene::{BACKDROP, DepthKind, TestScene};

/// Transforms the world of a stage by `turn`, which may mirror it. In view space nothing changes.
fn in_world(mut stage: TestScene, turn: Mat4) -> TestScene {
    stage.view.view_from_world *= turn.inverse();
    stage.particles.iter_mut().for_each(|p| p.position = turn.transform_point3(p.position));
    for light in &mut stage.lights {
        light.position = turn.transform_point3(light.position);
        light.direction = turn.transform_vector3(light.direction);
    }
    stage
}

#[test]
fn handedness_and_up_axis_do_not_change_the_image() {
    let flip = |x, y, z| Mat4::from_scale(vec3(x, y, z));
    let z_view = |mut stage: TestScene| {
        stage.view.view_from_world = flip(1.0, 1.0, -1.0) * stage.view.view_from_world;
        stage.view.clip_from_view *= flip(1.0, 1.0, -1.0);
        stage.ahead = 1.0;
        stage
    };
    let z_up = Mat4::from_rotation_x(std::f32::consts::FRAC_PI_2);
    type Change<'a> = &'a dyn Fn(TestScene) -> TestScene;
    let hosts: [(&str, Change); 5] = [
        ("a left-handed world", &|stage| in_world(stage, flip(1.0, 1.0, -1.0))),
        ("a left-handed world that looks along +z", &|stage| z_view(in_world(stage, flip(1.0, 1.0, -1.0)))),
        ("a world with z up", &|stage| in_world(stage, z_up)),
        ("+z view space", &z_view),
        ("a mirror", &|stage| in_world(stage, flip(-1.0, 1.0, 1.0))),
    ];
    for technique in
        [Technique::Soft, Technique::DepthSpriteSoft, Technique::SphericalBillboard, Technique::VolumetricSoft]
    {
        for (path, near_box) in [(RenderPath::Raster, false), (RenderPath::Raster, true), (RenderPath::Forward, false)]
        {
            let stage = || {
                let mut stage = TestScene::new(SIZE);
                (stage.settings.technique, stage.settings.path) = (technique, path);
                if near_box {
                    stage.bounds = Some(Bounds { min: Vec3::splat(-20.0), max: Vec3::splat(20.0) });
                }
                stage
            };
            let picture = stage().on_gpu(gpu()).picture;
            for (name, change) in hosts {
                let name = format!("{name}, {} {} {near_box}", technique.name(), path.name());
                let stage = change(stage());
                let seen = stage.on_gpu(gpu()).picture;
                let reference = psnr(&seen, &stage.on_cpu());
                assert!(reference >= AGREEMENT, "{name}: {reference:.1} dB from the reference");
                // Volume noise is fixed in world space, so a transformed world has other noise.
                let same_noise = !technique.is_volumetric() || name.starts_with("+z");
                let same = psnr(&seen, &picture);
                // Another order of f32 operations, rounded to f16.
                assert!(!same_noise || same >= 85.0, "{name}: {same:.1} dB");
            }
        }
    }
}

#[test]
fn mirrored_projections_and_near_planes_behind_the_viewer_match_the_reference() {
    let orthographic = |near| rh::proj::directx::orthographic(-4.0, 4.0, -2.25, 2.25, near, 80.0);
    let perspective = TestScene::new(SIZE).view.clip_from_view;
    let cases = [
        ("upside down", Mat4::from_scale(vec3(1.0, -1.0, 1.0)) * perspective, Mat4::IDENTITY),
        ("left to right", Mat4::from_scale(vec3(-1.0, 1.0, 1.0)) * perspective, Mat4::IDENTITY),
        ("orthographic from behind", orthographic(-30.0), Mat4::IDENTITY),
        ("orthographic from inside", orthographic(-30.0), Mat4::from_translation(vec3(0.0, 0.0, 6.0))),
        (
            "orthographic along +z",
            lh::proj::directx::orthographic(-4.0, 4.0, -2.25, 2.25, -30.0, 80.0),
            Mat4::from_scale(vec3(1.0, 1.0, -1.0)),
        ),
    ];
    for (name, clip_from_view, view_from_world) in cases {
        for (depth, technique) in [(DepthKind::Buffer, Technique::Soft), (DepthKind::Linear, Technique::SoftLinear)] {
            for path in [RenderPath::Raster, RenderPath::Forward] {
                let mut stage = TestScene::new(SIZE);
                (stage.view.clip_from_view, stage.view.view_from_world) = (clip_from_view, view_from_world);
                (stage.depth, stage.settings.technique, stage.settings.path) = (depth, technique, path);
                // Disables the near fade, which depends on the distance from the viewer.
                stage.settings.soft_fade.near_fade_end = 0.0;
                stage.ahead = if name.ends_with("+z") { 1.0 } else { -1.0 };
                let picture = stage.on_gpu(gpu()).picture;
                assert!(picture.texels.iter().any(|&texel| texel != BACKDROP), "{name}: no smoke");
                let psnr = psnr(&picture, &stage.on_cpu());
                assert!(psnr >= AGREEMENT, "{name}, {}, {}: {psnr:.1} dB", technique.name(), path.name());
            }
        }
    }
    // Moving an orthographic viewer along its view direction does not change the image.
    let seen_from = |near: f32, distance: f32| {
        let mut stage = TestScene::new(SIZE);
        stage.settings.soft_fade.near_fade_end = 0.0;
        stage.view.clip_from_view = rh::proj::directx::orthographic(-4.0, 4.0, -2.25, 2.25, near, near + 80.0);
        stage.view.view_from_world = Mat4::from_translation(vec3(0.0, 0.0, distance));
        // Linear scene depth is measured from the viewer; only an empty scene is the same from both positions.
        (stage.depth, stage.empty_linear) = (DepthKind::Linear, true);
        stage.attach_depth = false;
        stage.on_gpu(gpu()).picture
    };
    let psnr = psnr(&seen_from(0.5, 0.0), &seen_from(-19.5, 20.0));
    assert!(psnr >= 85.0, "{psnr:.1} dB");
}

#[test]
fn view_of_a_part_of_a_larger_target_draws_only_that_part() {
    let origin = UVec2::new(70, 31);
    type Change = fn(&mut TestScene);
    let changes: &[(&str, Change)] = &[
        ("half scale", |_| {}),
        ("scale 3", |s| s.settings.accumulate.scale = 3),
        ("full scale", |s| s.settings.accumulate.scale = 1),
        ("host depth", |s| {
            (s.settings.accumulate.scale, s.settings.accumulate.depth_source) = (1, DepthSource::Host);
        }),
        ("forward", |s| s.settings.path = RenderPath::Forward),
        ("forward sphere", |s| {
            (s.settings.path, s.settings.technique) = (RenderPath::Forward, Technique::SphericalBillboard);
        }),
        ("reduced depth", |s| s.debug_view = DebugView::ReducedDepth),
        ("specular", |s| s.debug_view = DebugView::SpecularScatter),
        ("linear", |s| s.settings.technique = Technique::SoftLinear),
    ];
    for (name, change) in changes {
        let mut stage = TestScene::new(SIZE);
        (stage.depth, stage.attach_depth) = (DepthKind::Both, true);
        // Spreads the smoke beyond every edge of the view.
        stage.particles.iter_mut().for_each(|p| p.position *= vec3(1.6, 1.6, 1.0));
        change(&mut stage);
        let separate = stage.on_gpu(gpu()).picture;
        stage.host.target_size = Some(UVec2::new(260, 150));
        stage.view.origin = origin;
        let part = stage.on_gpu(gpu()).picture;
        let mut cropped = Image::new(SIZE, Vec4::ZERO);
        cropped.for_each(|at, texel| *texel = part.load((at + origin).as_ivec2()));
        // At another position in the target, sprite corners are snapped to other 1/256 pixels.
        let same = psnr(&cropped, &separate);
        assert!(same >= 95.0, "{name}: {same:.1} dB");
        let outside = (0..260 * 150_u32).map(|i| UVec2::new(i % 260, i / 260));
        let mut outside = outside.filter(|at| at.cmplt(origin).any() || at.cmpge(origin + SIZE).any());
        assert!(outside.all(|at| part.load(at.as_ivec2()) == BACKDROP), "{name}: smoke outside the view");
        // The reference draws only the pixels of the view.
        assert!(psnr(&cropped, &stage.on_cpu()) >= AGREEMENT, "{name}");
    }
    let mut stage = TestScene::new(SIZE);
    stage.host.target_size = Some(UVec2::new(200, 100));
    stage.view.origin = UVec2::new(41, 0);
    assert_eq!(field(stage.try_on_gpu(gpu())), "view.size");
}
