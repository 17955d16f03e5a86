//! Scene and sky from files: both renderers show the same, and the settings about them do what they say.

use std::path::Path;
use std::sync::Arc;

use glam::{UVec2, Vec3, Vec4};
use haze_author::backdrop::{Bvh, SceneMaterial, SceneMesh, SceneVertex};
use haze_author::preset::no_effect_reason;
use haze_core::assets::image::Image;
use haze_core::settings::set_field;
use haze_demo::shot::Shot;
use haze_preset::Preset;

use crate::gpu::gpu;
use crate::presets::{render_on_gpu, without_smoke};
use crate::psnr::{MIN_PSNR, psnr_over};

/// The column in the example scene under its sky, with the scene's camera and lights.
fn shot(size: UVec2) -> Shot {
    let mut preset = Preset::load("column").unwrap();
    preset.environment.scene_file = "court.glb".into();
    preset.environment.sky_file = "dusk.hdr".into();
    preset.systems[0].settings.path = haze_core::settings::RenderPath::Raster;
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/own_scene/my.json");
    let mut shot = Shot::new(preset, &folder, size).unwrap();
    let backdrop = shot.backdrop.clone();
    assert!(backdrop.take_camera(None, &mut shot.preset) && backdrop.take_lights(&mut shot.preset));
    shot
}

fn changed(mut shot: Shot, fields: &[(&str, &str)]) -> Shot {
    for (field, value) in fields {
        set_field(&mut shot.preset, field, value).unwrap();
    }
    shot
}

#[test]
fn gpu_and_cpu_agree_on_a_scene_and_a_sky_from_files() {
    let turned = [("environment.sky_rotation", "70"), ("environment.sky_exposure", "-1")];
    let small = [("environment.scene_scale", "0.6"), ("camera.near", "4.2")];
    for (what, change) in [
        ("as in the example", &[][..]),
        ("sky turned and darker", &turned),
        ("half the size, cut by the near plane", &small),
        ("the sky behind alone", &[("environment.sky_light", "false")]),
        ("no sky", &[("environment.sky_file", "")]),
        ("the sky over the yard", &[("environment.scene_file", "")]),
    ] {
        let mut shot = changed(shot(UVec2::new(320, 180)), change);
        // A preset that names no file has none loaded.
        shot.backdrop.scene.take_if(|_| shot.preset.environment.scene_file.is_empty());
        shot.backdrop.sky.take_if(|_| shot.preset.environment.sky_file.is_empty());
        let images = |shot: &Shot| [render_on_gpu(shot, true), shot.render_on_cpu().unwrap()];
        let whole = images(&shot);
        let behind = images(&without_smoke(&shot));
        gpu().check().unwrap();
        let black = Image::new(shot.size, Vec4::ZERO);
        let scene = psnr_over(behind.each_ref(), [&black, &black]);
        let smoke = psnr_over(whole.each_ref(), behind.each_ref());
        println!("{what}: smoke {smoke:.1} dB, scene {scene:.1} dB");
        assert!(smoke >= MIN_PSNR && scene >= MIN_PSNR, "{what}: smoke {smoke:.1} dB, scene {scene:.1} dB");
    }
}

#[test]
fn gpu_and_cpu_agree_on_alpha_of_corners() {
    let mut shot = shot(UVec2::new(160, 90));
    // A floor, and a card above it whose alpha falls from left to right.
    let corner = |position: Vec3, alpha| SceneVertex {
        position,
        normal: Vec3::Y,
        color: Vec3::splat(0.5),
        alpha,
        ..SceneVertex::default()
    };
    let square = |height: f32, side: f32, right: f32| {
        let at = |x: f32, z: f32| corner(Vec3::new(x * side, height, z * side), if x > 0.0 { right } else { 1.0 });
        [at(-1.0, 1.0), at(1.0, 1.0), at(1.0, -1.0), at(-1.0, 1.0), at(1.0, -1.0), at(-1.0, -1.0)]
    };
    let image = |right: f32, shot: &mut Shot| {
        let vertices = [square(0.0, 5.0, 1.0), square(1.5, 1.5, right)].concat();
        let triangles: Vec<_> =
            vertices.as_chunks::<3>().0.iter().map(|corners| corners.map(|corner| corner.position)).collect();
        let cut_out = SceneMaterial { cutoff: Some(0.5), ..SceneMaterial::default() };
        let mut mesh = SceneMesh {
            bvh: Bvh::new(&triangles),
            vertices,
            parts: vec![(0, 0..2), (1, 2..4)],
            materials: vec![SceneMaterial::default(), cut_out],
            ..SceneMesh::default()
        };
        mesh.make_masks();
        shot.backdrop.scene = Some(Arc::new(mesh));
        let behind = without_smoke(shot);
        [render_on_gpu(&behind, true), behind.render_on_cpu().unwrap()]
    };
    shot.preset.camera.position = Vec3::new(0.0, 6.0, 6.0);
    shot.preset.camera.target = Vec3::ZERO;
    let black = Image::new(shot.size, Vec4::ZERO);
    let solid = image(1.0, &mut shot);
    let faded = image(0.0, &mut shot);
    for pair in [&solid, &faded] {
        let psnr = psnr_over(pair.each_ref(), [&black, &black]);
        assert!(psnr >= MIN_PSNR, "{psnr:.1} dB");
    }
    let [before, after] = [&solid[0], &faded[0]];
    let changed = before.texels.iter().zip(&after.texels).filter(|(a, b)| !a.abs_diff_eq(**b, 1e-3)).count();
    assert!(changed > 200, "{changed} pixels of the card and its shadow");
}

#[test]
fn a_scene_hides_smoke_and_is_in_its_shadow() {
    let size = UVec2::new(160, 90);
    let light =
        |shot: &Shot| render_on_gpu(shot, true).texels.iter().map(|texel| texel.truncate().element_sum()).sum::<f32>();
    let mut shot = shot(size);
    // From above, with the smoke behind the camera: only its shadow is in the image.
    shot.preset.camera.position = Vec3::new(1.5, 7.0, -1.0);
    shot.preset.camera.target = Vec3::new(2.5, 0.0, -1.4);
    shot.preset.camera.near = 6.0;
    let shaded = light(&shot);
    let bare = light(&without_smoke(&shot));
    assert!(shaded < 0.97 * bare, "{shaded} of {bare}");
    let on_scene = changed(shot.clone(), &[("systems[0].settings.shadow.scene", "0")]);
    assert!(light(&on_scene) > 1.01 * shaded, "the shadow on the scene");
    // Behind a wall, no smoke is seen.
    let mut hidden = self::shot(size);
    hidden.preset.camera.position = Vec3::new(0.0, 0.5, -9.0);
    hidden.preset.camera.target = Vec3::new(0.0, 0.2, 0.0);
    hidden.preset.camera.fov = 8.0;
    hidden.preset.lights.clear();
    let [seen, bare] = [render_on_gpu(&hidden, true), render_on_gpu(&without_smoke(&hidden), true)];
    assert_eq!(seen.texels, bare.texels);
}

#[test]
fn settings_of_scene_and_sky_have_an_effect_unless_a_reason_is_given() {
    let size = UVec2::new(64, 36);
    let values = [
        ("environment.scene", "studio"),
        ("environment.lamp", "false"),
        ("environment.scene_scale", "1.5"),
        ("environment.zenith", "1,0,0"),
        ("environment.horizon", "1,0,0"),
        ("environment.ground", "1,0,0"),
        ("environment.sky_rotation", "90"),
        ("environment.sky_exposure", "1"),
        ("environment.sky_light", "false"),
        ("systems[0].settings.ambient.sky_color", "1,0,0"),
        ("systems[0].settings.ambient.ground_color", "1,0,0"),
    ];
    for (scene, sky) in [(true, true), (true, false), (false, true), (false, false)] {
        let mut shot = shot(size);
        if !scene {
            shot.backdrop.scene = None;
            shot.preset.environment.scene_file = String::new();
            shot.preset.camera = Preset::load("column").unwrap().camera;
        }
        if !sky {
            shot.backdrop.sky = None;
            shot.preset.environment.sky_file = String::new();
        }
        let plain = shot.render_on_cpu().unwrap();
        for (field, value) in values {
            let moved = changed(shot.clone(), &[(field, value)]).render_on_cpu().unwrap();
            let reason = no_effect_reason(&shot.preset, field, size);
            assert_eq!(reason.is_some(), moved == plain, "{field}, scene {scene}, sky {sky}: {reason:?}");
        }
    }
}
