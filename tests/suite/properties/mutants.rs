//! Sensitivity of the PSNR limits: the effects of typical mistakes in a pass, applied to the reference, must fall below
//! them.

use glam::{Mat4, UVec2, Vec4, vec3};
use haze::Bounds;
use haze_core::assets::image::Image;
use haze_core::settings::DebugView;

use super::SIZE;
use crate::gpu::gpu;
use crate::psnr::{MIN_PSNR, psnr};
use crate::test_host::Host;
use crate::test_scene::{BACKDROP, TestScene};

#[test]
fn psnr_limit_detects_typical_mistakes_in_a_pass() {
    type Mistake = fn(&mut TestScene);
    let scene = || {
        let mut scene = TestScene::new(SIZE);
        scene.settings.specular_scatter.size = 480.0;
        scene
    };
    let image = scene().on_gpu(gpu()).image;
    let agreement = |change: Mistake| {
        let mut mutant = scene();
        change(&mut mutant);
        psnr(&image, &mutant.on_cpu())
    };
    assert!(agreement(|_| {}) >= 60.0);
    let mutants: &[(&str, Mistake)] = &[
        ("flipped normal y", |s| s.material.sprite = crate::test_scene::ball_sprite(true)),
        ("swapped ramp axes", |s| {
            let ramp = s.material.specular_ramp.clone();
            let texels = (0..128).map(|i| ramp.texel(UVec2::new(i / 8, i % 8)));
            s.material.specular_ramp = haze_core::assets::ramp::Ramp::from_linear(UVec2::new(8, 16), texels);
        }),
        ("reversed diffuse ramp", |s| {
            let ramp = s.material.diffuse_ramp.clone();
            let texels = (0..16).map(|i| ramp.texel(UVec2::new(15 - i, 0)));
            s.material.diffuse_ramp = haze_core::assets::ramp::Ramp::from_linear(UVec2::new(16, 1), texels);
        }),
        ("sprites turned the other way", |s| s.particles.iter_mut().for_each(|p| p.rotation = -p.rotation)),
        ("no soft fade", |s| s.settings.soft_fade.fade_scale = 1000.0),
        ("no boost", |s| s.settings.boost = 1.0),
        ("literal decode", |s| s.settings.accumulate.decode = haze_core::settings::NormalDecode::Literal),
        ("a light forgotten", |s| s.lights.truncate(1)),
        ("half a texel off", |s| s.view.view_from_world = Mat4::from_translation(vec3(0.03, 0.0, 0.0))),
    ];
    for (name, change) in mutants {
        let psnr = agreement(*change);
        println!("{name}: {psnr:.1} dB");
        assert!(psnr < MIN_PSNR - 10.0, "{name} passes: {psnr:.1} dB");
    }
}

#[test]
fn psnr_limit_detects_an_error_of_0_05_in_one_channel_of_a_small_cloud() {
    let mut smoke = Image::new(SIZE, BACKDROP);
    smoke.texels[..SIZE.element_product() as usize / 100].fill(Vec4::splat(0.7));
    for channel in Vec4::AXES {
        let mut off = smoke.clone();
        let few = off.texels.iter_mut().filter(|texel| **texel != BACKDROP);
        few.for_each(|texel| *texel -= channel * 0.05);
        let psnr = psnr(&off, &smoke);
        assert!(psnr < MIN_PSNR, "{channel}: {psnr:.1} dB");
    }
}

#[test]
fn psnr_limit_detects_normals_blended_front_to_back() {
    // The reference sorts; a frame that the GPU blends front to back must not match it.
    let mut scene = TestScene::new(SIZE);
    scene.debug_view = DebugView::Normals;
    scene.bounds = Some(Bounds { min: vec3(-4.0, -3.0, -9.0), max: vec3(4.0, 3.0, -3.0) });
    scene.particles.iter_mut().for_each(|particle| particle.amount = 0.9);
    let sorted = scene.on_cpu();
    let mut front_to_back = scene.particles.clone();
    front_to_back.sort_by(|a, b| b.position.z.total_cmp(&a.position.z));
    let mut host = Host::new(gpu(), &scene).unwrap();
    host.draw_buffer(gpu(), &scene, &front_to_back).unwrap();
    assert!(psnr(&host.image(gpu()).unwrap(), &sorted) < MIN_PSNR - 10.0);
}
