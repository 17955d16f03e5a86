//! Checks that the pixel probe reports the values that the GPU drew.

use glam::{UVec2, Vec2, Vec2Swizzles, Vec3, Vec4, Vec4Swizzles};
use haze::{Light, wgpu};
use haze_core::assets::image::Image;
use haze_core::assets::ramp::Ramp;
use haze_core::settings::*;
use haze_demo::capture::CapturedFrame;
use haze_demo::offscreen_renderer::OffscreenRenderer;
use haze_demo::shot::Shot;
use haze_preset::builtin;
use haze_reference::{Probe, SystemProbe};

use crate::gpu::{can_test, gpu, is_tiled_available};
use crate::presets::offscreen_context;

const SIZE: UVec2 = UVec2::new(160, 90);

/// Draws a shot on the GPU; returns the captured targets and an image of every debug view in `stages`. `None` on
/// OpenGL, which cannot copy depth to a buffer.
fn render_and_capture(shot: &Shot, stages: &[DebugView]) -> Option<(CapturedFrame, Vec<Image<Vec4>>)> {
    let gpu = gpu();
    let context = offscreen_context();
    let mut renderer = OffscreenRenderer::new(context, true).unwrap();
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    renderer.record(&mut encoder, shot, stages).unwrap();
    let capture = renderer.capture(&mut encoder);
    gpu.submit(encoder).unwrap();
    assert_eq!(capture.is_some(), context.can_capture());
    can_test("capture", capture.is_some());
    let capture = capture?;
    // The poll of another test's thread may be the one that completes the read-back.
    while !capture.is_finished() {
        std::thread::yield_now();
    }
    let read = |&debug_view| renderer.read(gpu, &Shot { debug_view, ..shot.clone() }).unwrap();
    Some((capture.read().unwrap(), stages.iter().map(read).collect()))
}

/// Every third pixel in x and in y.
fn pixels() -> Vec<UVec2> {
    (0..SIZE.y).step_by(3).flat_map(|y| (0..SIZE.x).step_by(3).map(move |x| UVec2::new(x, y))).collect()
}

/// Accepted difference, in steps of a half float: the blend unit rounds once per system, and one step is for the
/// device's arithmetic.
const STEPS: f32 = 4.0;

/// Largest difference of a channel, in steps of a half float.
fn difference(a: Vec3, b: Vec3) -> f32 {
    let step = a.abs().max(b.abs()).max(Vec3::splat(1.0 / 16.0)) / 1024.0;
    ((a - b).abs() / step).max_element()
}

/// Fraction of pixels that may differ by more. At edges of the bounding box and of boxes in the scene, the rasterizer's
/// precision of 1/256 pixel decides what a pixel shows.
const EDGES: f32 = 0.005;

/// Numbers of pixels that were compared and that differ from the image, and their largest difference.
fn compare(probed: impl Fn(&Probe) -> Option<Vec3>, probes: &[Probe], drawn: &Image<Vec4>) -> (u32, u32, f32) {
    let mut seen = 0;
    let mut wrong = 0;
    let mut most = 0.0_f32;
    for (probe, at) in probes.iter().zip(pixels()) {
        let Some(probed) = probed(probe) else { continue };
        let difference = difference(probed, drawn.load(at.as_ivec2()).xyz());
        seen += 1;
        most = most.max(difference);
        wrong += u32::from(difference > STEPS);
    }
    (seen, wrong, most)
}

/// Asserts that `probed` of each probe equals the image at that pixel; skips probes for which it returns `None`.
fn assert_matches_image(what: &str, probed: impl Fn(&Probe) -> Option<Vec3>, probes: &[Probe], drawn: &Image<Vec4>) {
    let (seen, wrong, most) = compare(probed, probes, drawn);
    println!("{what}: {wrong} of {seen} pixels differ, by up to {most:.1} steps");
    assert!(seen > 20, "{what}: only {seen} pixels with smoke");
    assert!(wrong as f32 <= EDGES * seen as f32, "{what}: {wrong} of {seen} pixels differ, by up to {most} steps");
}

#[test]
fn probed_color_matches_the_image() {
    for preset in builtin::PRESETS {
        let mut shot = Shot::load(preset.name, SIZE).unwrap();
        // A probe explains smoke and scene, before the camera's passes mix pixels.
        shot.preset.camera.antialiasing = false;
        shot.preset.camera.heat_haze = 0.0;
        let Some((captured, images)) = render_and_capture(&shot, &[DebugView::Final]) else { return };
        // A probe explains the surfaces behind an outline.
        let front = captured.front.clone();
        let mut probes = captured.with_shot(shot.clone()).probe(&pixels()).unwrap();
        for (probe, at) in probes.iter_mut().zip(pixels()) {
            probe.color = probe.color.filter(|_| front.load(at.as_ivec2()).w == 0.0);
        }
        let outlines = front.texels.iter().filter(|texel| texel.w > 0.0).count();
        assert!(outlines * 5 < front.texels.len(), "{}: {outlines} pixels of outlines", preset.name);
        if shot.preset.systems.iter().any(|system| system.settings.is_forward()) {
            assert!(probes.iter().all(|probe| probe.color.is_none()), "{}: a color of a forward system", preset.name);
            continue;
        }
        assert_matches_image(preset.name, |probe| probe.color.map(|color| color.xyz()), &probes, &images[0]);
    }
}

#[test]
fn probed_values_match_every_debug_view() {
    type Probed = fn(&SystemProbe) -> Vec3;
    let stages: [(DebugView, Probed); 6] = [
        (DebugView::Amount, |probe| Vec3::splat(probe.amount)),
        (DebugView::Normals, |probe| (probe.normal * 0.5 + 0.5) * probe.coverage),
        (DebugView::Diffuse, |probe| probe.diffuse * probe.coverage),
        (DebugView::SoftScatter, |probe| probe.soft_scatter * probe.coverage),
        (DebugView::Combined, |probe| probe.light() * probe.coverage),
        (DebugView::SpecularScatter, SystemProbe::specular),
    ];
    let changes: [fn(&mut Settings); 6] = [
        |_| {},
        |s| s.accumulate.lighting_resolution = LightingResolution::Target,
        |s| (s.accumulate.encoding, s.accumulate.order) = (NormalEncoding::Biased, BlendOrder::Weighted),
        |s| (s.accumulate.downscale, s.diffuse.mode) = (4, DiffuseMode::Cubemap),
        |s| (s.accumulate.downscale, s.accumulate.depth_source) = (1, DepthSource::Host),
        |s| {
            s.accumulate.format = AccumulationFormat::Rgba8Unorm;
            s.accumulate.encoding = NormalEncoding::Biased;
            s.accumulate.order = BlendOrder::Sorted;
            s.diffuse.mode = DiffuseMode::Motif;
            s.soft_scatter.mode = SoftScatterMode::Ramp;
            // Lit texels are half floats. Near an amount of 1, where the glow is steep, their last bit is visible.
            s.accumulate.lighting_resolution = LightingResolution::Full;
        },
    ];
    let paths = if is_tiled_available() { &[RenderPath::Raster, RenderPath::Tiled][..] } else { &[RenderPath::Raster] };
    for (&path, (index, change)) in paths.iter().flat_map(|path| changes.iter().enumerate().map(move |of| (path, of))) {
        let mut shot = Shot::load("column", SIZE).unwrap();
        let settings = &mut shot.preset.systems[0].settings;
        settings.path = path;
        change(settings);
        let Some((captured, images)) = render_and_capture(&shot, &stages.map(|(stage, _)| stage)) else { return };
        let probes = captured.with_shot(shot.clone()).probe(&pixels()).unwrap();
        for ((stage, probed), image) in stages.iter().zip(&images) {
            let what = format!("{} {}, {index}", path.name(), stage.name());
            assert_matches_image(&what, |probe| probe.systems.first().map(probed), &probes, image);
        }
        if shot.preset.systems[0].settings.diffuse.mode == DiffuseMode::Ramp {
            for system in probes.iter().flat_map(|probe| &probe.systems) {
                let of_lights: Vec3 = system.lights.iter().map(|light| light.diffuse).sum();
                let sum = of_lights + system.ambient.unwrap_or_default();
                assert!(difference(sum, system.diffuse) < 1.0, "sum over lights {sum}, diffuse {}", system.diffuse);
            }
        }
    }
}

/// Ramp whose color is its coordinate, in red and green; blue is 1. With 128 texels, the error of a bilinear lookup with
/// weights of 1/256 is below a step of a half float.
fn coordinate_ramp() -> Ramp {
    let size = UVec2::splat(128);
    let at = |x, y| (Vec2::new(x as f32, y as f32) / (size - 1).as_vec2()).extend(1.0);
    Ramp::from_linear(size, (0..size.y).flat_map(|y| (0..size.x).map(move |x| at(x, y))))
}

/// Asserts that a coordinate is the one by which the image looked a `coordinate_ramp` up, and that a flipped or swapped
/// axis would be noticed. `probed`: the coordinate, and the light without the ramp.
fn assert_coordinate_matches_image(
    what: &str,
    probed: impl Fn(&SystemProbe) -> Option<(Vec2, f32)>,
    probes: &[Probe],
    drawn: &Image<Vec4>,
) {
    type Change = fn(Vec2) -> Vec2;
    let color = |probe: &Probe, change: Change| {
        let system = probe.systems.first()?;
        let (coordinate, light) = probed(system)?;
        Some(change(coordinate).extend(1.0) * (light * system.coverage))
    };
    assert_matches_image(what, |probe| color(probe, |at| at), probes, drawn);
    let mutants: [(&str, Change); 3] = [
        ("flipped across", |at| Vec2::new(1.0 - at.x, at.y)),
        ("flipped upwards", |at| Vec2::new(at.x, 1.0 - at.y)),
        ("swapped", |at| at.yx()),
    ];
    for (mutant, change) in mutants {
        let (seen, wrong, _) = compare(|probe| color(probe, change), probes, drawn);
        assert!(wrong > seen / 2, "{what}, {mutant}: only {wrong} of {seen} pixels differ");
    }
}

#[test]
fn probed_coordinates_of_the_shadow_ramp_match_the_image() {
    let mut shot = Shot::load("column", SIZE).unwrap();
    let settings = &mut shot.preset.systems[0].settings;
    let material = &mut shot.materials[0];
    settings.ambient.intensity = 0.0;
    material.shadow_ramp = coordinate_ramp();
    material.diffuse_ramp = Ramp::from_linear(UVec2::ONE, [Vec3::ONE]);
    let lights = shot.preset.lights.clone();
    let paths = if is_tiled_available() { &[RenderPath::Raster, RenderPath::Tiled][..] } else { &[] };
    for (&path, (index, light)) in paths.iter().flat_map(|path| lights.iter().enumerate().map(move |of| (path, of))) {
        // One light at a time, or the image would show a sum.
        shot.preset.lights = vec![Light { color: Vec3::ONE, ..*light }];
        shot.preset.systems[0].settings.path = path;
        let Some((captured, images)) = render_and_capture(&shot, &[DebugView::Diffuse]) else { return };
        let probes = captured.clone().with_shot(shot.clone()).probe(&pixels()).unwrap();
        // Blue is 1 in both ramps.
        let shadow = |probe: &SystemProbe| Some((probe.lights.first()?.shadow?.coordinate, probe.diffuse.z));
        assert_coordinate_matches_image(&format!("{} {index}", path.name()), shadow, &probes, &images[0]);
        for shadow in probes.iter().flat_map(|probe| &probe.systems).filter_map(|system| system.lights[0].shadow) {
            let expected = shadow.coordinate.extend(1.0) * shadow.transmittance.z;
            assert!(difference(shadow.transmittance, expected) < 1.0, "{shadow:?}");
        }
        let mut changed = shot.clone();
        changed.preset.lights[0].smoke_shadow = false;
        let probes = captured.with_shot(changed).probe(&pixels()).unwrap();
        let mut lights = probes.iter().flat_map(|probe| &probe.systems).flat_map(|system| &system.lights);
        assert!(lights.all(|light| light.shadow.is_none()), "a shadow of a light that shines through smoke");
    }
}

#[test]
fn probed_coordinates_of_the_fire_ramp_match_the_image() {
    let mut shot = Shot::load("oil_fire", SIZE).unwrap();
    let settings = &mut shot.preset.systems[0].settings;
    // Only fire gives light.
    settings.diffuse.intensity = 0.0;
    settings.soft_scatter.intensity = 0.0;
    settings.shadow.strength = 0.0;
    settings.specular_scatter.intensity = 0.0;
    settings.accumulate.lighting_resolution = LightingResolution::Full;
    shot.materials[0].fire_ramp = coordinate_ramp();
    let Some((captured, images)) = render_and_capture(&shot, &[DebugView::Combined]) else { return };
    let probes = captured.with_shot(shot.clone()).probe(&pixels()).unwrap();
    let fire = |probe: &SystemProbe| probe.fire.map(|fire| (fire.coordinate, fire.light.z));
    assert_coordinate_matches_image("fire", fire, &probes, &images[0]);
    shot.preset.systems[0].settings.fire.intensity = 0.0;
    let Some((captured, _)) = render_and_capture(&shot, &[DebugView::Final]) else { return };
    let probes = captured.with_shot(shot).probe(&pixels()).unwrap();
    assert!(probes.iter().flat_map(|probe| &probe.systems).all(|system| system.fire.is_none()));
}

#[test]
fn captured_texels_of_another_shot_are_an_error() {
    let shot = Shot::load("column", SIZE).unwrap();
    let Some((captured, _)) = render_and_capture(&shot, &[DebugView::Final]) else { return };
    let mut other = shot.clone();
    other.preset.systems[0].settings.accumulate.downscale = 3;
    let error = captured.clone().with_shot(other).probe(&[UVec2::ONE]).unwrap_err().to_string();
    assert!(error.starts_with("texels: "), "{error}");
    let other = Shot { size: SIZE * 2, ..shot };
    assert!(captured.with_shot(other).probe(&[UVec2::ONE]).is_err());
}
