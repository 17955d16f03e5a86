//! Outlines of objects in front of smoke and inside it: every sample of a pixel has its own smoke.

use std::sync::Arc;

use glam::{UVec2, Vec2, Vec3, Vec4, Vec4Swizzles};
use haze_author::backdrop::{Bvh, SceneMaterial, SceneMesh, SceneVertex};
use haze_core::assets::image::Image;
use haze_core::settings::{RenderPath, SoftScatterMode};
use haze_demo::shot::Shot;
use haze_preset::SceneName;

use crate::gpu::is_tiled_available;
use crate::presets::render_on_gpu;

const SIZE: UVec2 = UVec2::new(192, 108);
const EYE: Vec3 = Vec3::new(0.0, 1.2, 5.0);
const FIELD_OF_VIEW: f32 = 30.0;
/// Distance of the bars' left edges, metres.
const SPACING: f32 = 0.45;
/// Way of a bar's top to the right, for each metre of height.
const SLANT: f32 = 0.15;

/// White smoke in front of a dark sky.
fn smoke(size: UVec2) -> Shot {
    let mut shot = Shot::load("column", size).unwrap();
    shot.preset.environment.scene = SceneName::Empty;
    for color in [&mut shot.preset.environment.zenith, &mut shot.preset.environment.horizon] {
        *color = Vec3::splat(0.02);
    }
    shot.preset.camera.position = EYE;
    shot.preset.camera.target = EYE - Vec3::Z;
    shot.preset.camera.fov = FIELD_OF_VIEW;
    shot.preset.lights.clear();
    let settings = &mut shot.preset.systems[0].settings;
    settings.fire.intensity = 0.0;
    settings.accumulate.downscale = 1;
    settings.path = RenderPath::Raster;
    settings.soft_scatter.mode = SoftScatterMode::Smoothstep;
    settings.soft_scatter.scatter_color = Vec3::ONE;
    settings.soft_scatter.ambient_color = Vec3::ONE;
    shot
}

/// Slanted bars across the view.
#[derive(Clone, Copy)]
struct Bars {
    z: f32,
    width: f32,
}

/// The shot with bars.
fn with_bars(mut shot: Shot, bars: Bars) -> Shot {
    let Bars { z, width } = bars;
    let mut vertices = Vec::new();
    for bar in -8..8 {
        let left = SPACING * bar as f32;
        let corner = |x: f32, y: f32| SceneVertex {
            position: Vec3::new(left + x + SLANT * y, y, z),
            normal: Vec3::Z,
            color: Vec3::splat(0.5),
            ..SceneVertex::default()
        };
        let corners = [corner(0.0, -2.0), corner(width, -2.0), corner(width, 5.0), corner(0.0, 5.0)];
        vertices.extend([0, 1, 2, 0, 2, 3].map(|index: usize| corners[index]));
    }
    let triangles: Vec<_> =
        vertices.as_chunks::<3>().0.iter().map(|corners| corners.map(|corner| corner.position)).collect();
    let mut mesh = SceneMesh {
        bvh: Bvh::new(&triangles),
        parts: vec![(0, 0..triangles.len() as u32)],
        materials: vec![SceneMaterial::default()],
        vertices,
        ..SceneMesh::default()
    };
    mesh.make_masks();
    shot.backdrop.scene = Some(Arc::new(mesh));
    shot
}

/// Samples of a pixel.
const SAMPLES: [Vec2; 4] = [Vec2::new(0.25, 0.25), Vec2::new(0.75, 0.25), Vec2::new(0.25, 0.75), Vec2::new(0.75, 0.75)];

impl Bars {
    /// True if a bar covers a position in the image, pixels.
    fn cover(self, pixel: Vec2, size: UVec2) -> bool {
        let half = (0.5 * FIELD_OF_VIEW.to_radians()).tan() * (EYE.z - self.z);
        let from_middle = (pixel - 0.5 * size.as_vec2()) / (0.5 * size.y as f32) * half;
        let height = EYE.y - from_middle.y;
        let across = EYE.x + from_middle.x - SLANT * height;
        across.rem_euclid(SPACING) < self.width
    }

    /// Number of a pixel's samples that bars cover.
    fn covered_samples(self, at: UVec2, size: UVec2) -> usize {
        SAMPLES.into_iter().filter(|sample| self.cover(at.as_vec2() + sample, size)).count()
    }
}

fn pixels() -> impl Iterator<Item = UVec2> {
    (0..SIZE.y).flat_map(|y| (0..SIZE.x).map(move |x| UVec2::new(x, y)))
}

/// Mean of samples as the scene weights them: a single bright one does not dominate.
fn mean(samples: impl Iterator<Item = Vec3>) -> Vec3 {
    let mut sum = Vec3::ZERO;
    let mut weights = 0.0;
    for sample in samples {
        let weight = 1.0 / (1.0 + sample.max_element());
        sum += sample * weight;
        weights += weight;
    }
    sum / weights
}

fn color(image: &Image<Vec4>, at: UVec2) -> Vec3 {
    image.load(at.as_ivec2()).xyz()
}

fn average_and_most(errors: &[f32]) -> (f32, f32) {
    (errors.iter().sum::<f32>() / errors.len() as f32, errors.iter().copied().fold(0.0, f32::max))
}

#[test]
fn objects_in_front_of_smoke_keep_their_smooth_outlines() {
    let bars = Bars { z: 2.6, width: 0.12 };
    for (path, scale) in [(RenderPath::Raster, 1), (RenderPath::Raster, 4), (RenderPath::Tiled, 1)] {
        if path == RenderPath::Tiled && !is_tiled_available() {
            continue;
        }
        let mut smoke = smoke(SIZE);
        smoke.preset.systems[0].settings.path = path;
        smoke.preset.systems[0].settings.accumulate.downscale = scale;
        let barred = with_bars(smoke.clone(), bars);
        let renderers: [fn(&Shot) -> Image<Vec4>; 2] =
            [|shot| render_on_gpu(shot, true), |shot| shot.render_on_cpu().unwrap()];
        for (renderer, render) in ["GPU", "CPU"].into_iter().zip(renderers) {
            let behind = render(&smoke);
            let image = render(&barred);
            let whole = pixels().find(|&at| bars.covered_samples(at, SIZE) == 4).unwrap();
            let bar = color(&image, whole);
            let mut outlines = 0;
            let mut errors = Vec::new();
            for at in pixels().filter(|&at| scale == 1 || (1..4).contains(&bars.covered_samples(at, SIZE))) {
                let count = bars.covered_samples(at, SIZE);
                // Coarser texels show other smoke beside a bar than without it: that of the next pixel, there.
                let beside = [at.x.saturating_sub(1), (at.x + 1).min(SIZE.x - 1)].map(|x| UVec2::new(x, at.y));
                let beside = beside.into_iter().find(|&at| bars.covered_samples(at, SIZE) == 0);
                let smoke = match beside {
                    Some(beside) if scale > 1 => color(&image, beside),
                    _ => color(&behind, at),
                };
                let expected = mean((0..4).map(|index| if index < count { bar } else { smoke }));
                outlines += u32::from(smoke.max_element() > bar.max_element() + 0.2 && (1..4).contains(&count));
                errors.push((color(&image, at) - expected).abs().max_element());
            }
            let (average, most) = average_and_most(&errors);
            println!("{renderer} {path:?} {scale}: {outlines} outlines, {average:.4} off, {most:.4} at most");
            assert!(outlines > 100, "{renderer}: {outlines} outlines of bright smoke");
            assert!(average <= 0.02, "{renderer} {path:?} {scale}: {average} off");
            // Upsampled smoke differs from pixel to pixel at the plume's rim.
            let limit = if scale == 1 { 0.02 } else { 0.1 };
            assert!(most <= limit, "{renderer} {path:?} {scale}: {most} off at most");
        }
    }
}

#[test]
fn objects_inside_smoke_have_the_smoke_in_front_of_them_at_outlines() {
    // Bars of seven pixels, and of one.
    for width in [0.12, 0.02] {
        let bars = Bars { z: 0.0, width };
        let image = render_on_gpu(&with_bars(smoke(SIZE), bars), true);
        // Centers of finer pixels are samples of a pixel.
        let fine_size = SIZE * 6;
        let fine = render_on_gpu(&with_bars(smoke(fine_size), bars), true);
        let mut errors = Vec::new();
        for at in pixels().filter(|&at| (1..4).contains(&bars.covered_samples(at, SIZE))) {
            let finer = SAMPLES.map(|sample| at * 6 + (sample * 6.0).as_uvec2());
            // Finer outlines show no sample alone.
            if finer.iter().all(|&fine_at| bars.covered_samples(fine_at, fine_size).is_multiple_of(4)) {
                let expected = mean(finer.into_iter().map(|fine_at| color(&fine, fine_at)));
                errors.push((color(&image, at) - expected).abs().max_element());
            }
        }
        let (average, most) = average_and_most(&errors);
        println!("{width} m: {} outlines, {average:.4} off, {most:.4} at most", errors.len());
        assert!(errors.len() > 200, "{} outlines", errors.len());
        assert!(average <= 0.02, "{width} m: {average} off");
    }
}
