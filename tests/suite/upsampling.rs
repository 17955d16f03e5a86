//! Compares upsampled targets with full-resolution ones, at depth edges of the scene and over the whole image.

use glam::{IVec2, UVec2, Vec4, vec3};
use haze_core::assets::image::Image;
use haze_core::formula::color::srgb_from_linear;
use haze_core::settings::{DebugView, Grain, LightingResolution, Settings, Upsample};
use haze_demo::shot::Shot;
use haze_preset::builtin;

use crate::gpu::is_opengl;
use crate::presets::render_on_gpu;
use crate::psnr::psnr;

const SIZE: UVec2 = UVec2::new(640, 360);

/// Renders with a scale and an upsampling mode for every system but sparks, which are smaller than a texel: presets draw these
/// stretched sprites at scale 1.
fn render(shot: &Shot, scale: u32, upsample: Upsample) -> Image<Vec4> {
    let mut shot = shot.clone();
    let is_sparks = |settings: &Settings| settings.is_stretched() && settings.accumulate.downscale == 1;
    for system in shot.preset.systems.iter_mut().filter(|system| !is_sparks(&system.settings)) {
        system.settings.accumulate.fix_scale(scale);
        system.settings.accumulate.upsample = upsample;
    }
    render_on_gpu(&shot, true)
}

/// Marks pixels whose depth differs from a pixel at most `reach` pixels away.
fn edges(shot: &Shot, reach: i32) -> Vec<bool> {
    let depth = render(&Shot { debug_view: DebugView::ReducedDepth, ..shot.clone() }, 1, Upsample::Bilinear);
    let is_edge = |i: u32| {
        let at = IVec2::new((i % SIZE.x) as i32, (i / SIZE.x) as i32);
        let around = (-reach..=reach).flat_map(|y| (-reach..=reach).map(move |x| IVec2::new(x, y)));
        let depths = around.map(|offset| depth.load(at + offset).x);
        let (low, high) = depths.fold((f32::INFINITY, 0.0_f32), |(low, high), d| (low.min(d), high.max(d)));
        high - low > 0.02
    };
    (0..SIZE.element_product()).map(is_edge).collect()
}

/// Number of pixels at edges from which on their errors tell something.
const MIN_EDGE_PIXELS: usize = 5000;

/// True if enough pixels are at edges in the depths that the smoke reaches.
fn has_edges(shot: &Shot) -> bool {
    edges(shot, 2).into_iter().filter(|is_edge| *is_edge).count() > MIN_EDGE_PIXELS
}

/// PSNR of the pixels at edges, dB, and the largest error of a channel among them, sRGB 0..1.
fn error_at_edges(reduced: &Image<Vec4>, full: &Image<Vec4>, edges: &[bool]) -> (f32, f32) {
    let at_edges = |image: &Image<Vec4>| {
        let texels: Vec<Vec4> = image.texels.iter().zip(edges).filter(|(_, edge)| **edge).map(|(t, _)| *t).collect();
        Image { size: UVec2::new(texels.len() as u32, 1), texels }
    };
    let reduced = at_edges(reduced);
    let full = at_edges(full);
    assert!(full.texels.len() > MIN_EDGE_PIXELS, "only {} pixels at edges", full.texels.len());
    let encoded = |x: f32| srgb_from_linear(x.clamp(0.0, 1.0));
    let off = |(a, b): (&Vec4, &Vec4)| (0..3).map(|i| (encoded(a[i]) - encoded(b[i])).abs()).fold(0.0, f32::max);
    let worst = reduced.texels.iter().zip(&full.texels).map(off).fold(0.0, f32::max);
    (psnr(&reduced, &full), worst)
}

/// Worst error of a channel at depth edges at scale 2, sRGB 0..1, for an upsampling mode.
fn worst_at_edges(shot: &Shot, upsample: Upsample) -> f32 {
    let mut shot = shot.clone();
    // Grain at scale 1 is finer than a reduced target shows, at edges as elsewhere.
    shot.preset.systems.iter_mut().for_each(|system| system.settings.grain = Grain::default());
    let shot = &shot;
    let mut full = render(shot, 1, Upsample::Bilinear);
    let mut reduced = render(shot, 2, upsample);
    if shot.preset.systems.iter().any(|system| system.settings.burns()) {
        // Flames are several times brighter than white. Clipped, their own soft edges would be steps.
        let brightest = full.texels.iter().map(|texel| texel.truncate().max_element()).fold(1.0, f32::max);
        full.texels.iter_mut().chain(&mut reduced.texels).for_each(|texel| *texel /= brightest);
    }
    error_at_edges(&reduced, &full, &edges(shot, 2)).1
}

/// Prints the figures of the tables in docs/upsampling.md for every mode and scale.
fn print_rows(name: &str, shot: &Shot) {
    let full = render(shot, 1, Upsample::Bilinear);
    for scale in [2, 4] {
        let edges = edges(shot, scale as i32);
        for &upsample in Upsample::ALL {
            let reduced = render(shot, scale, upsample);
            let (edge_psnr, worst) = error_at_edges(&reduced, &full, &edges);
            let all = psnr(&reduced, &full);
            println!(
                "{name} scale {scale} {}: {all:.1} dB, at edges {edge_psnr:.1} dB, worst {worst:.2}",
                upsample.name()
            );
        }
    }
}

/// Renders with every system lit at `lighting_resolution`.
fn render_lit(shot: &Shot, scale: u32, upsample: Upsample, lighting_resolution: LightingResolution) -> Image<Vec4> {
    let mut shot = shot.clone();
    for system in &mut shot.preset.systems {
        system.settings.accumulate.lighting_resolution = lighting_resolution;
    }
    render(&shot, scale, upsample)
}

#[test]
fn lighting_at_target_resolution_stays_close_to_full_resolution() {
    for preset in builtin::PRESETS {
        let shot = Shot::load(preset.name, SIZE).unwrap();
        let lit = |scale, resolution| render_lit(&shot, scale, Upsample::Bilinear, resolution);
        assert!(lit(1, LightingResolution::Target) == lit(1, LightingResolution::Full));
        // The reduced target alone is at 36 to 80 dB. The worst presets here are `steam_vent`, 61.9 and 57.9 dB, and
        // `wildfire_sky`, whose backlight ramp is steep where grain tilts normals. The others are at 66 and 61 dB or more.
        // On OpenGL, `wildfire_sky` is at 59.1 dB instead of 63.3 at scale 2. The likely cause, which was not traced: its smoke
        // is far away, where OpenGL's depth buffers are coarser.
        let coarser = if preset.name == "wildfire_sky" && is_opengl() { 2.0 } else { 0.0 };
        for (scale, least) in [(2, 60.0 - coarser), (4, 56.0 - coarser)] {
            let [full, target] = [LightingResolution::Full, LightingResolution::Target].map(|r| lit(scale, r));
            let all = psnr(&target, &full);
            println!("{} lit at scale {scale}: {all:.1} dB", preset.name);
            assert!(full != target && all >= least, "{}: {all:.1} dB", preset.name);
        }
    }
}

/// The image as a screen shows it: nothing is brighter than white.
fn clipped(image: &Image<Vec4>) -> Image<Vec4> {
    Image { size: image.size, texels: image.texels.iter().map(|t| t.clamp(Vec4::ZERO, Vec4::ONE)).collect() }
}

#[test]
fn carrying_texels_along_slopes_is_as_close_to_full_scale_as_a_fit_for_each_pixel() {
    for preset in builtin::PRESETS {
        let shot = Shot::load(preset.name, SIZE).unwrap();
        let full = render(&shot, 1, Upsample::Bilinear);
        for scale in [2, 4] {
            let error = |resolution| {
                let lit = render_lit(&shot, scale, Upsample::Guided, resolution);
                psnr(&clipped(&lit), &clipped(&full))
            };
            let fitted = error(LightingResolution::Full);
            let carried = error(LightingResolution::Target);
            println!("{} at scale {scale}: fitted {fitted:.1} dB, carried {carried:.1} dB", preset.name);
            // `corridor` is 0.7 dB behind, the others 0.5 at most. At 70 dB the error is 0.08 of 255, which no screen shows:
            // `corridor` at scale 4 is 1.3 dB behind at 71 dB.
            let is_close = carried > fitted - 1.0 || carried > 70.0;
            assert!(is_close, "{} at scale {scale}: {carried:.1} dB, fitted {fitted:.1}", preset.name);
        }
    }
}

#[test]
fn guided_upsampling_at_half_scale_has_no_jagged_edges() {
    let mut count = 0;
    for preset in builtin::PRESETS {
        let shot = Shot::load(preset.name, SIZE).unwrap();
        // The smoke of `wildfire_sky` lies behind all of the scene, which then is one depth to it.
        if !has_edges(&shot) {
            continue;
        }
        count += 1;
        let guided = worst_at_edges(&shot, Upsample::Guided);
        println!("{}: worst pixel at edges {guided:.2}", preset.name);
        // The scene's depth is that of the surfaces behind outlines: one pixel of the rim of the steam's vent, which is seen at a
        // grazing angle, has no texel of its surface left beside it: as bright as the steam, 0.27 off. The next is 0.16 off.
        let limit = if preset.name == "steam_vent" { 0.28 } else { 0.2 };
        assert!(guided <= limit, "{}: worst pixel at edges {guided}", preset.name);
    }
    assert_eq!(count, builtin::PRESETS.len() - 1);
}

/// Shot in which the camera sees the brazier's top from a few degrees above it.
fn grazing_shot() -> Shot {
    let mut shot = Shot::load("column", SIZE).unwrap();
    // The root of the smoke cuts into the top.
    let system = &mut shot.preset.systems[0];
    system.emitter.position.y = 0.5;
    system.settings.soft_fade.fade_scale = 4.0;
    let camera = &mut shot.preset.camera;
    camera.position = vec3(0.3, 0.9, 4.5);
    camera.target = vec3(0.0, 0.7, 0.0);
    camera.fov = 25.0;
    shot
}

#[test]
fn guided_upsampling_has_no_stripes_on_a_grazing_surface() {
    let shot = grazing_shot();
    let [guided, joint] = [Upsample::Guided, Upsample::JointBilateral].map(|mode| worst_at_edges(&shot, mode));
    assert!(guided <= 0.2 && joint > 2.0 * guided, "worst pixel at edges: guided {guided}, joint bilateral {joint}");
}

#[test]
#[ignore = "prints the figures of docs/upsampling.md"]
fn prints_errors_of_every_upsampling_mode() {
    for preset in builtin::PRESETS {
        let shot = Shot::load(preset.name, SIZE).unwrap();
        if has_edges(&shot) {
            print_rows(preset.name, &shot);
        }
    }
    print_rows("grazing", &grazing_shot());
}
