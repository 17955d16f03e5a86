//! Documented behavior of each technique where a sprite meets the scene, the near plane or the far plane.

use glam::camera::rh::proj::directx;
use haze_core::settings::*;

use super::{SIZE, assert_agreement, one_sprite, scene};
use crate::gpu::gpu;
use crate::test_host::Host;
use crate::test_scene::{BACKDROP, DepthKind, TestScene};

/// A single sprite at `view_depth` metres, with a wall at 6.2 m as the scene.
fn wall(technique: Technique, view_depth: f32) -> TestScene {
    let mut scene = one_sprite(technique, view_depth);
    scene.wall_everywhere = true;
    scene
}

/// Amount in the middle of the image, 0..1.
fn amount(scene: &TestScene) -> f32 {
    let mut host = Host::with_shared_context(gpu(), scene).unwrap();
    host.draw(gpu(), scene).unwrap();
    amount_in(&host)
}

fn amount_in(host: &Host) -> f32 {
    let image = host.image(gpu()).unwrap();
    let middle = image.load((SIZE / 2).as_ivec2());
    // The debug view of the amount is gray, and is drawn over the backdrop wherever the amount is above 0.
    if middle == BACKDROP { 0.0 } else { middle.x }
}

#[test]
fn only_the_curve_always_shows_smoke_behind_a_surface() {
    for &technique in Technique::ALL {
        for &curve in FadeCurve::ALL {
            let mut previous = f32::INFINITY;
            let mut host = Host::with_shared_context(gpu(), &wall(technique, 5.0)).unwrap();
            for step in 0..40 {
                // The wall is at 6.2 m.
                let depth = 4.9 + 0.06 * step as f32;
                let mut scene = wall(technique, depth);
                scene.settings.soft_fade.curve = curve;
                scene.settings.soft_fade.fade_scale = 2.5;
                host.draw(gpu(), &scene).unwrap();
                let amount = amount_in(&host);
                let name = format!("{} {} at {depth:.2} m: {amount}", technique.name(), curve.name());
                let shows_through = curve == FadeCurve::Always && technique.is_soft();
                // Distance by which the sprite extends in front of its center, metres.
                let reach = if technique.is_sphere() || technique.is_depth_sprite() || technique == Technique::Density {
                    0.7
                } else {
                    0.0
                };
                let through = if shows_through { 1.0 / 2.5 } else { 0.0 };
                if depth > 6.2 + reach + through + 0.01 {
                    assert!(amount <= 0.0, "{name}, expected none");
                }
                if shows_through && depth < 6.2 + through - 0.03 {
                    assert!(amount > 0.0, "{name}, expected some");
                }
                // Volumetric techniques contain noise, so their amount need not fall monotonically.
                if !technique.is_volumetric() {
                    assert!(amount <= previous + 2e-3, "{name} after {previous}");
                }
                previous = amount;
            }
        }
    }
}

/// Largest change of any pixel from frame to frame while a camera moves through a sprite in steps of 19 mm.
fn largest_step(technique: Technique) -> f32 {
    let mut previous = None;
    let mut largest = 0.0_f32;
    let mut host = Host::with_shared_context(gpu(), &one_sprite(technique, 0.9)).unwrap();
    for step in 0..=88 {
        // From 0.9 m in front of the sprite's center to 0.75 m behind it. Near plane at 0.1 m, radius 0.7 m.
        let scene = one_sprite(technique, 0.9 - 1.2 * step as f32 / 64.0);
        host.draw(gpu(), &scene).unwrap();
        let image = host.image(gpu()).unwrap();
        let amounts: Vec<f32> =
            image.texels.iter().map(|texel| if *texel == BACKDROP { 0.0 } else { texel.x }).collect();
        if let Some(previous) = previous.replace(amounts.clone()) {
            let changes = amounts.iter().zip(&previous).map(|(a, b): (&f32, &f32)| (a - b).abs());
            largest = largest.max(changes.fold(0.0, f32::max));
        }
    }
    largest
}

/// Limit for spheres. The camera moves by 19 mm per step, and density times amount is 2.4 per metre, so the amount
/// along the central ray changes by at most 1 - exp(-2.4 · 0.019) = 4.5 %.
const MAX_SPHERE_STEP: f32 = 0.045;

/// Limit for squares, which also grow on screen: by a fifth per step close to the near plane. A square that vanishes at
/// once changes by 0.8.
const MAX_SLAB_STEP: f32 = 0.2;

#[test]
fn spherical_billboards_do_not_pop_at_the_near_plane() {
    let sphere = largest_step(Technique::SphericalBillboard);
    let square = largest_step(Technique::Soft);
    println!("largest change in a step: sphere {sphere:.3}, square {square:.3}");
    assert!(sphere < MAX_SPHERE_STEP, "largest change in a step: {sphere}");
    // The mutant: a flat square disappears within 25 mm, hardly more than a step.
    assert!(square > 8.0 * MAX_SPHERE_STEP, "largest change in a step of the mutant: {square}");
}

#[test]
fn slabs_vanish_when_their_far_side_passes_the_near_plane() {
    for technique in [Technique::Density, Technique::DepthSpriteHard, Technique::DepthSpriteSoft] {
        let step = largest_step(technique);
        println!("largest change in a step: {} {step:.3}", technique.name());
        assert!(step < MAX_SLAB_STEP, "largest change in a step: {} {step}", technique.name());
        for depth in [-0.55, -0.3, 0.0, 0.05, 0.1, 0.4, 0.69, 0.75] {
            assert_agreement(&format!("{} at {depth} m", technique.name()), &one_sprite(technique, depth));
        }
        assert!(amount(&one_sprite(technique, -0.3)) > 0.0, "{}: nothing at -0.3 m", technique.name());
        assert!(amount(&one_sprite(technique, -0.65)) <= 0.0, "{}: smoke at -0.65 m", technique.name());
    }
}

#[test]
fn volumes_are_clipped_by_the_scene_and_the_near_plane() {
    for technique in [Technique::VolumetricHard, Technique::VolumetricSoft, Technique::SphericalBillboard] {
        // Optical depth through the middle of a sphere at `depth`. With its center on the wall, about half is left.
        let through = |depth: f32| {
            let mut scene = wall(technique, depth);
            scene.settings.soft_fade.fade_scale = 1000.0;
            scene.settings.volumetric.march_steps = 8;
            scene.settings.volumetric.noise_octaves = 1;
            -(1.0 - amount(&scene)).ln()
        };
        let whole = through(5.4);
        let half = through(6.2);
        println!("{}: optical depth {whole:.3} whole, {half:.3} half", technique.name());
        // Half, within a quarter either way because the noise is uneven. Without clipping it would be the whole.
        assert!((0.25..0.75).contains(&(half / whole)), "{}: optical depth {half} of {whole}", technique.name());
        // With the camera at the sphere's center, the part beyond the near plane is left, and both renderers agree.
        let inside = one_sprite(technique, 0.0);
        let ahead = -(1.0 - amount(&inside)).ln();
        println!("{}: optical depth {ahead:.3} from inside", technique.name());
        assert!(
            (0.15..0.75).contains(&(ahead / whole)),
            "{}: optical depth {ahead} of {whole} from inside",
            technique.name()
        );
        for depth in [-0.55, -0.3, 0.0, 0.05, 0.1, 0.4, 0.69, 0.75] {
            assert_agreement(&format!("{} at {depth} m", technique.name()), &one_sprite(technique, depth));
        }
        // Nothing is left once the far side has passed the near plane.
        assert!(amount(&one_sprite(technique, -0.65)) <= 0.0);
    }
}

#[test]
fn depth_sprites_intersect_the_scene_at_the_depth_of_their_texels() {
    // In the middle, the detail map moves texels towards the viewer by 0.8 radii, 0.55 m.
    let seen = |technique, depth: f32| amount(&wall(technique, depth)) > 0.0;
    assert!(seen(Technique::Hard, 6.1) && !seen(Technique::Hard, 6.3));
    assert!(seen(Technique::DepthSpriteHard, 6.3) && seen(Technique::DepthSpriteHard, 6.6));
    assert!(!seen(Technique::DepthSpriteHard, 6.9));
    assert!(seen(Technique::DepthSpriteSoft, 6.6) && !seen(Technique::DepthSpriteSoft, 6.9));
}

#[test]
fn nothing_is_drawn_beyond_the_far_plane() {
    for &technique in Technique::ALL {
        for path in [RenderPath::Raster, RenderPath::Forward] {
            let drawn = |depth: f32| {
                let mut scene = one_sprite(technique, depth);
                scene.view.clip_from_view = directx::perspective(0.8, 16.0 / 9.0, 0.1, 6.0);
                scene.settings.path = path;
                scene.debug_view = DebugView::Final;
                scene.on_gpu(gpu()).image.texels.iter().any(|&texel| texel != BACKDROP)
            };
            assert!(drawn(4.5) && !drawn(7.0), "{} {}", technique.name(), path.name());
        }
    }
}

#[test]
fn soft_linear_requires_and_reads_the_linear_target() {
    let mut scene = scene(Technique::SoftLinear);
    scene.depth = DepthKind::Buffer;
    scene.attach_depth = haze::read_only_depth_is_supported(&gpu().device);
    let error = scene.try_on_gpu(gpu()).map(|_| ()).unwrap_err().to_string();
    assert!(
        error.starts_with("systems[0].settings.technique: \"soft_linear\"") && error.contains("BufferAndLinear"),
        "{error}"
    );
    // With an empty linear target, a technique that reads it shows smoke that the depth buffer hides.
    let mut scene = wall(Technique::Soft, 6.4);
    scene.empty_linear = true;
    let buffer_is_read = haze::read_only_depth_is_supported(&gpu().device);
    assert_eq!(amount(&scene) > 0.0, !buffer_is_read);
    scene.settings.technique = Technique::SoftLinear;
    assert!(amount(&scene) > 0.0);
}
