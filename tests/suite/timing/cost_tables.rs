//! Figures of GPU time for the docs.

use glam::{Mat4, UVec2, UVec3, Vec3, vec3};
use haze::{Light, LightKind, Particle, Settings, wgpu};
use haze_core::assets::image::Image;
use haze_core::assets::noise::{pcg3d, unit};
use haze_core::settings::{Backlight, Lighting, RenderPath};
use haze_demo::headless::Headless;

use super::{draw_and_measure, timed_gpu, timed_host};
use crate::gpu::is_tiled_available;
use crate::test_scene::{TestScene, TestShadowMap};

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
                scene.settings.path = path;
                scene.settings.lighting = lighting;
                scene.settings.accumulate.downscale = scale;
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

/// 4,096 sprites under three lights, at half scale.
fn scene_of_4096_sprites(gpu: &Headless) -> TestScene {
    let is_cpu = gpu.adapter.get_info().device_type == wgpu::DeviceType::Cpu;
    let mut scene = TestScene::new(if is_cpu { UVec2::new(1280, 720) } else { UVec2::new(1920, 1080) });
    scene.lights.push(Light { kind: LightKind::Directional, direction: Vec3::NEG_Y, ..Light::default() });
    scene.settings.accumulate.downscale = 2;
    let some = scene.particles.clone();
    let particle = |index: u32| {
        let place = pcg3d(UVec3::new(index, 3, 9));
        let place = (vec3(unit(place.x), unit(place.y), unit(place.z)) - 0.5) * vec3(4.0, 2.4, 2.0);
        let age = unit(pcg3d(UVec3::new(index, 5, 9)).x);
        Particle { position: place + vec3(0.0, 0.0, -6.0), radius: 0.2, amount: 0.1, age, ..some[index as usize % 60] }
    };
    scene.particles = (0..4096).map(particle).collect();
    scene
}

/// Prints the figures of docs/fire.md: whole frames, and accumulation, with fire and with colors by age.
#[test]
#[ignore = "prints figures for the docs"]
fn prints_cost_of_fire() {
    let Some(gpu) = timed_gpu() else { return };
    type Change = fn(&mut Settings);
    let changes: &[(&str, Change)] = &[
        ("normals", |_| {}),
        ("fire", |s| s.fire.intensity = 4.0),
        ("colors", |s| s.sprite.age_color = 1.0),
        ("both", |s| (s.fire.intensity, s.sprite.age_color) = (4.0, 1.0)),
        ("six-way", |s| s.lighting = Lighting::SixWay),
    ];
    for path in [RenderPath::Raster, RenderPath::Tiled].into_iter().take(if is_tiled_available() { 2 } else { 1 }) {
        let mut scene = scene_of_4096_sprites(gpu);
        scene.settings.path = path;
        let stages: Vec<_> = changes
            .iter()
            .map(|(_, change)| {
                let mut scene = scene.clone();
                change(&mut scene.settings);
                scene
            })
            .collect();
        let whole = medians(gpu, &stages, ALL_PASSES);
        let accumulate = medians(gpu, &stages, &["accumulate", "tile_project", "tile_accumulate"]);
        for (((name, _), whole_frame), accumulate_alone) in changes.iter().zip(&whole).zip(&accumulate) {
            let ratio = accumulate_alone / accumulate[0];
            println!("{} {name}: {whole_frame:.3} ms, accumulation {accumulate_alone:.3} ms, {ratio:.2}", path.name());
        }
    }
}

/// Prints whole frames of 4,096 sprites, and the passes of shadow. Unlike `haze bench shadow`, it has no shadow maps where it
/// counts lights.
#[test]
#[ignore = "prints figures for the docs"]
fn prints_cost_of_shadow() {
    let Some(gpu) = timed_gpu() else { return };
    if !is_tiled_available() {
        return;
    }
    let mut scene = scene_of_4096_sprites(gpu);
    for path in [RenderPath::Raster, RenderPath::Tiled] {
        scene.settings.path = path;
        let stages: Vec<_> = [0, 16, 24, 32, 48, 64, 96]
            .map(|resolution| {
                let mut scene = scene.clone();
                if resolution > 0 {
                    scene.settings.shadow.strength = 1.0;
                    scene.settings.shadow.resolution = resolution;
                }
                scene
            })
            .into();
        let whole = medians(gpu, &stages, ALL_PASSES);
        let splat = medians(gpu, &stages[1..], &["density_splat"]);
        let march = medians(gpu, &stages[1..], &["shadow_march"]);
        println!("{}: without shadow {:.3} ms", path.name(), whole[0]);
        let pair = [stages[0].clone(), stages[2].clone()];
        let passes: &[&str] = match path {
            RenderPath::Raster => &["accumulate", "transfer"],
            _ => &["tile_project", "tile_accumulate", "transfer"],
        };
        for pass in passes {
            let times = medians(gpu, &pair, &[pass]);
            println!("{pass}: {:.3} ms, {:.3} ms", times[0], times[1]);
        }
        let mut by_depth = stages[2].clone();
        by_depth.settings.shadow.by_depth = true;
        by_depth.shadow_maps.push(TestShadowMap {
            light: 2,
            layers: vec![Image::new(UVec2::splat(512), 1.0)],
            clip_from_world: vec![Mat4::from_scale(Vec3::splat(0.1))],
            reversed: false,
        });
        let times = medians(gpu, &[stages[2].clone(), by_depth.clone()], ALL_PASSES);
        let maps = medians(gpu, &[by_depth], &["shadow_visibility"]);
        println!("by depth: {:.3} ms, {:.3} ms; shadow_visibility {:.3} ms", times[0], times[1], maps[0]);
        for count in [3, 4, 15] {
            let mut plain = scene.clone();
            plain.lights.extend((3..count).map(|i: u32| {
                let (sine, cosine) = (i as f32 * 2.4).sin_cos();
                Light { position: vec3(4.0 * cosine, 1.5 * sine, -6.0 + 3.0 * sine), ..Light::default() }
            }));
            let mut shaded = plain.clone();
            let shadow = &mut shaded.settings.shadow;
            shadow.strength = 1.0;
            shadow.lights = count;
            shadow.by_depth = count > 3;
            let times = medians(gpu, &[plain, shaded], ALL_PASSES);
            println!("{count} lights: {:.3} ms, with shadow {:.3} ms", times[0], times[1]);
        }
        for (index, stage) in stages[1..].iter().enumerate() {
            println!(
                "{} cells: {:.3} ms, {:.2}; density_splat {:.3} ms, shadow_march {:.3} ms",
                stage.settings.shadow.resolution,
                whole[index + 1],
                whole[index + 1] / whole[0],
                splat[index],
                march[index]
            );
        }
    }
}

/// Passes of a frame.
const ALL_PASSES: &[&str] = &[
    "depth_downsample",
    "sort",
    "density_splat",
    "shadow_march",
    "shadow_visibility",
    "accumulate",
    "light_target",
    "depth_slopes",
    "mark_cells",
    "tile_project",
    "tile_gather",
    "tile_bin",
    "tile_refine",
    "tile_accumulate",
    "upsample_lit",
    "transfer",
    "specular_scatter",
];
