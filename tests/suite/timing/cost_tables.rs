//! Figures of GPU time for the docs.

use glam::UVec2;
use haze::Settings;
use haze::settings::{Backlight, Lighting, RenderPath};
use haze_demo::headless::Headless;

use super::{draw_and_measure, timed_gpu, timed_host};
use crate::gpu::is_tiled_available;
use crate::test_scene::TestScene;

/// Median GPU time of the sum of `passes` for every scene, milliseconds. The scenes are drawn in turn.
fn medians(gpu: &Headless, stages: &[TestScene], passes: &[&str]) -> Vec<f32> {
    let mut hosts: Vec<_> = stages.iter().map(|scene| timed_host(gpu, scene)).collect();
    let mut all = vec![Vec::new(); stages.len()];
    for turn in 0..24 {
        for ((scene, (host, timing)), times) in stages.iter().zip(&mut hosts).zip(&mut all) {
            let drawn = draw_and_measure(gpu, host, timing, scene);
            let ms: f32 = drawn.passes.iter().filter(|pass| passes.contains(&pass.name)).map(|pass| pass.ms).sum();
            assert!(ms > 0.0, "no time for {passes:?}");
            // The first four rounds warm up.
            if turn >= 4 {
                times.push(ms);
            }
        }
    }
    all.iter_mut().for_each(|times| times.sort_by(f32::total_cmp));
    all.iter().map(|times| times[times.len() / 2]).collect()
}

/// Prints the figures of docs/six_way.md and docs/light.md.
#[test]
#[ignore = "prints figures for the docs"]
fn prints_cost_of_six_way_lighting_and_ramps() {
    let Some(gpu) = timed_gpu() else { return };
    let mut scene = TestScene::new(UVec2::new(1280, 720));
    scene.particles.iter_mut().for_each(|particle| particle.radius = 1.6);
    let other = |change: fn(&mut Settings)| {
        let mut other = scene.clone();
        change(&mut other.settings);
        other
    };
    let raster: [(RenderPath, &[&str]); 2] =
        [(RenderPath::Raster, &["accumulate"]), (RenderPath::Raster, &["transfer"])];
    let tiled: [(RenderPath, &[&str]); 2] = [
        (RenderPath::Tiled, &["tile_project", "sort", "tile_bin", "tile_refine", "tile_accumulate"]),
        (RenderPath::Tiled, &["tile_accumulate"]),
    ];
    let tiled = if is_tiled_available() { &tiled[..] } else { &[] };
    for scale in [1, 2] {
        for &(path, passes) in raster.iter().chain(tiled) {
            let pair = [Lighting::Normals, Lighting::SixWay].map(|lighting| {
                let mut scene = scene.clone();
                (scene.settings.path, scene.settings.lighting) = (path, lighting);
                scene.settings.accumulate.scale = scale;
                scene
            });
            let times = medians(gpu, &pair, passes);
            println!(
                "1/{scale} {}: normals {:.3} ms, six-way {:.3} ms, {:.2}",
                passes.join(" + "),
                times[0],
                times[1],
                times[1] / times[0]
            );
        }
    }
    // A ramp with one row, one with several rows, and a second ramp for light from behind.
    let mut two_axes = scene.clone();
    two_axes.material.diffuse_ramp = scene.material.backlight_ramp.clone();
    let backlit = other(|settings| settings.diffuse.backlight = Backlight::Ramp);
    let times = medians(gpu, &[scene.clone(), two_axes, backlit], &["transfer"]);
    let [one, two, behind] = times[..] else { return };
    println!("transfer: one axis {one:.3} ms, two axes {:.2}, light from behind {:.2}", two / one, behind / one);
}
