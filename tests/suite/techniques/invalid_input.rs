//! Input that is rejected with the name of the field, and degenerate input that must stay finite.

use glam::{Vec3, vec3};
use haze::{Bounds, Particle};
use haze_core::assets::sprite::{Sprite, SpriteLayout};
use haze_core::error::Error;
use haze_core::settings::*;

use super::scene;
use crate::gpu::{gpu, non_finite_texels};
use crate::test_scene::TestScene;

/// Returns the error of a scene with a change that is not accepted.
fn rejection(change: fn(&mut TestScene)) -> String {
    let mut scene = scene(Technique::Soft);
    change(&mut scene);
    match scene.try_on_gpu(gpu()) {
        Err(Error::Field(error)) => error.to_string(),
        other => panic!("{:?}", other.map(|_| ())),
    }
}

#[test]
fn out_of_range_settings_are_errors_that_name_the_field() {
    let field = |change| rejection(change).split(':').next().unwrap().replace("systems[0].settings.", "");
    assert_eq!(field(|s| s.settings.soft_fade.fade_scale = 0.0), "soft_fade.fade_scale");
    assert_eq!(field(|s| s.settings.soft_fade.fade_scale = 1e9), "soft_fade.fade_scale");
    assert_eq!(field(|s| s.settings.soft_fade.contrast_power = 0.0), "soft_fade.contrast_power");
    assert_eq!(field(|s| s.settings.soft_fade.contrast_power = 100.0), "soft_fade.contrast_power");
    assert_eq!(field(|s| s.settings.sprite.size = 1e9), "sprite.size");
    assert_eq!(field(|s| s.settings.debug.draw_count = 0), "debug.draw_count");
    assert_eq!(field(|s| s.settings.volumetric.march_steps = 1), "volumetric.march_steps");
    assert_eq!(field(|s| s.settings.volumetric.noise_size = 0.0), "volumetric.noise_size");
    assert_eq!(field(|s| s.settings.spherical_billboard.density = f32::NAN), "spherical_billboard.density");
    assert_eq!(field(|s| s.time = f64::INFINITY), "time");
    // At scale 1 the host's depth needs a target as large as the image.
    let error = rejection(|s| {
        s.settings.accumulate.depth_source = DepthSource::Host;
        s.settings.accumulate.downscale = 1;
        s.settings.accumulate.max_side = 100;
    });
    assert!(error.starts_with("systems[0].settings.accumulate.max_side: 100"), "{error}");
}

#[test]
fn missing_or_mismatched_images_are_errors_that_name_the_field() {
    let lacking = |change: fn(&mut TestScene)| {
        let mut scene = scene(Technique::DepthSpriteHard);
        scene.material.detail = None;
        change(&mut scene);
        scene.try_on_gpu(gpu()).map(|_| ()).unwrap_err().to_string()
    };
    assert!(lacking(|_| {}).starts_with("systems[0].settings.technique: \"depth_sprite_hard\""));
    let motion = lacking(|s| (s.settings.technique, s.settings.sprite.motion) = (Technique::Soft, 0.5));
    assert!(motion.starts_with("systems[0].settings.sprite.motion: 0.5"), "{motion}");
    let mut two_frames = scene(Technique::Soft);
    let sheet = image::RgbaImage::new(16, 8);
    let layout = SpriteLayout { columns: 2, rows: 1, y_down: false };
    two_frames.material.detail = Some(Sprite::from_image("two".as_ref(), &sheet, layout).unwrap());
    let error = two_frames.try_on_gpu(gpu()).map(|_| ()).unwrap_err().to_string();
    assert_eq!(error, "systems[0].material.detail: the number of frames is 2; expected 1, as many as the sprite has");
}

#[test]
fn degenerate_particles_draw_finite_images() {
    for &technique in Technique::ALL {
        let mut scene = scene(technique);
        scene.bounds = Some(Bounds { min: vec3(-4.0, -3.0, -9.0), max: vec3(4.0, 3.0, 2.0) });
        scene.settings.soft_fade.near_fade_end = 0.0;
        scene.settings.spherical_billboard.density = 1000.0;
        scene.settings.volumetric.opacity = 1000.0;
        scene.settings.exponential.density = 1000.0;
        scene.particles = vec![
            Particle { position: Vec3::ZERO, ..Particle::default() },
            Particle { position: vec3(0.0, 0.0, -6.0), radius: 0.0, ..Particle::default() },
            Particle { position: vec3(0.0, 0.0, -6.0), radius: 1e-20, ..Particle::default() },
            Particle { position: vec3(0.0, 0.0, -6.0), radius: 1e9, ..Particle::default() },
            Particle { position: vec3(0.0, 0.0, -0.1), radius: 0.01, ..Particle::default() },
            Particle { position: vec3(1.0, 0.0, -5.0), age: 1e30, ..Particle::default() },
        ];
        let shrink: [fn(&mut TestScene); 3] =
            [|_| {}, |s| s.settings.sprite.size = 0.0, |s| s.settings.spherical_billboard.radius = 0.0];
        for change in shrink {
            change(&mut scene);
            let drawn = scene.on_gpu(gpu());
            assert!(
                drawn.image.texels.iter().all(|texel| texel.is_finite()),
                "{}: GPU image not finite",
                technique.name()
            );
            let targets = drawn.renderer.targets(0).unwrap();
            assert_eq!(
                non_finite_texels(gpu(), &targets.accumulation[0], targets.size),
                0,
                "{}: target not finite",
                technique.name()
            );
            assert!(
                scene.on_cpu().texels.iter().all(|texel| texel.is_finite()),
                "{}: CPU image not finite",
                technique.name()
            );
        }
    }
}
