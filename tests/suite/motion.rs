//! Motion of the presets: detail must ride on the smoke, and not be drawn anew in every frame, while the outline changes.

use glam::{IVec2, UVec2, Vec4};
use haze_core::assets::image::Image;
use haze_core::formula::color::srgb_from_linear;

use crate::presets::{render_on_gpu, shot};

const SIZE: UVec2 = UVec2::new(640, 360);
/// Side of a patch, and distance from patch to patch, pixels.
const SIDE: usize = 20;
const SPACING: usize = 12;
/// Frames per second.
const RATE: f64 = 30.0;

/// An image in gray, sRGB encoded.
struct Gray {
    size: [usize; 2],
    values: Vec<f32>,
}

impl Gray {
    fn at(&self, x: usize, y: usize) -> f32 {
        self.values[y * self.size[0] + x]
    }

    /// Mean over the square of so many pixels around each pixel, three times: about a Gaussian.
    fn blurred(&self, radius: isize) -> Self {
        let [width, height] = self.size;
        let along = |gray: &Self, step: [isize; 2]| {
            let value = |index: usize| {
                let x = index % width;
                let y = index / width;
                let at = |i: isize| {
                    let x = (x as isize + i * step[0]).clamp(0, width as isize - 1);
                    let y = (y as isize + i * step[1]).clamp(0, height as isize - 1);
                    gray.at(x as usize, y as usize)
                };
                (-radius..=radius).map(at).sum::<f32>() / (2 * radius + 1) as f32
            };
            Self { size: gray.size, values: (0..width * height).map(value).collect() }
        };
        let mut blurred = Self { size: self.size, values: self.values.clone() };
        for _ in 0..3 {
            blurred = along(&along(&blurred, [1, 0]), [0, 1]);
        }
        blurred
    }

    /// Values of a patch, less their mean.
    fn patch(&self, x: usize, y: usize) -> Vec<f32> {
        let rows = (y..y + SIDE).flat_map(|row| (x..x + SIDE).map(move |column| (column, row)));
        let values: Vec<f32> = rows.map(|(column, row)| self.at(column, row)).collect();
        let mean = values.iter().sum::<f32>() / values.len() as f32;
        values.into_iter().map(|value| value - mean).collect()
    }
}

fn gray(image: &Image<Vec4>) -> Gray {
    let encode = |linear: f32| srgb_from_linear(linear.clamp(0.0, 1.0));
    let values = image.texels.iter().map(|t| 0.299 * encode(t.x) + 0.587 * encode(t.y) + 0.114 * encode(t.z));
    Gray { size: [image.size.x as usize, image.size.y as usize], values: values.collect() }
}

fn norm(values: &[f32]) -> f32 {
    values.iter().map(|value| value * value).sum::<f32>().sqrt()
}

/// Median of the best match of the moving patches of one frame in a later one: 1 where the image only moves, 0.8 where
/// nothing matches.
fn coherence(frames: &[Gray], later: usize) -> f32 {
    // Less low frequencies, which match anywhere.
    let detail = |frame: &Gray| {
        let values = frame.values.iter().zip(frame.blurred(6).values).map(|(value, low)| value - low);
        Gray { size: frame.size, values: values.collect() }
    };
    let first = detail(&frames[0]);
    let then = detail(&frames[later]);
    let [width, height] = first.size;
    let reach = 10 + 8 * later as i32;
    let mut best = Vec::new();
    for y in (0..height - SIDE).step_by(SPACING) {
        for x in (0..width - SIDE).step_by(SPACING) {
            let patch = first.patch(x, y);
            let changed: Vec<f32> = frames[0]
                .patch(x, y)
                .iter()
                .zip(frames[frames.len() - 1].patch(x, y))
                .map(|(before, after)| after - before)
                .collect();
            let texels = (SIDE * SIDE) as f32;
            if norm(&patch) < 0.008 * texels.sqrt() || norm(&changed) < 0.01 * texels.sqrt() {
                continue;
            }
            let mut highest = 0.0_f32;
            for offset_y in -reach..=reach {
                for offset_x in -reach..=reach {
                    let to = IVec2::new(x as i32 + offset_x, y as i32 + offset_y);
                    let last = IVec2::new((width - SIDE) as i32, (height - SIDE) as i32);
                    if to.cmpge(IVec2::ZERO).all() && to.cmple(last).all() {
                        let other = then.patch(to.x as usize, to.y as usize);
                        let product: f32 = patch.iter().zip(&other).map(|(a, b)| a * b).sum();
                        highest = highest.max(product / (norm(&patch) * norm(&other)).max(1.0e-9));
                    }
                }
            }
            best.push(highest);
        }
    }
    best.sort_by(f32::total_cmp);
    assert!(best.len() > 20, "{} patches move", best.len());
    best[best.len() / 2]
}

/// Frames of a preset from a time on.
fn frames(preset: &str, time: f64) -> Vec<Gray> {
    let frame = |number: u32| {
        let mut shot = shot(preset, SIZE);
        shot.preset.time = time + f64::from(number) / RATE;
        gray(&render_on_gpu(&shot.at_its_time(), false))
    };
    (0..3).map(frame).collect()
}

fn assert_detail_rides(preset: &str) {
    let frames = frames(preset, 10.0);
    let [next, second] = [1, 2].map(|later| coherence(&frames, later));
    println!("{preset}: {next:.3} {second:.3}");
    assert!(next >= 0.93 && second >= 0.86, "{preset}: {next} after a frame, {second} after two");
}

/// Pixels that smoke changes at a time.
fn outline(preset: &str, time: f64) -> Vec<bool> {
    let mut shot = shot(preset, SIZE / 2);
    shot.preset.time = time;
    for system in &mut shot.preset.systems {
        system.settings.shadow.scene = 0.0;
        system.settings.fire.light = 0.0;
    }
    let with_smoke = gray(&render_on_gpu(&shot.at_its_time(), false));
    shot.preset.systems.iter_mut().for_each(|system| system.emitter.amount = 0.0);
    let without = gray(&render_on_gpu(&shot.at_its_time(), false));
    with_smoke.values.iter().zip(without.values).map(|(with, without)| (with - without).abs() > 0.04).collect()
}

#[test]
fn outlines_of_smoke_change_within_seconds() {
    for preset in ["column", "steam_vent", "oil_fire"] {
        let before = outline(preset, 10.0);
        let after = outline(preset, 11.6);
        let pairs = || before.iter().zip(&after);
        let both = pairs().filter(|(before, after)| **before && **after).count() as f32;
        let either = pairs().filter(|(before, after)| **before || **after).count() as f32;
        println!("{preset}: {:.3} of {either}", both / either);
        assert!(either > 1000.0 && both <= 0.85 * either, "{preset}: {both} of {either}");
    }
}

#[test]
fn detail_of_column_rides_on_its_smoke() {
    assert_detail_rides("column");
}

#[test]
fn detail_of_steam_vent_rides_on_its_smoke() {
    assert_detail_rides("steam_vent");
}

#[test]
fn detail_of_oil_fire_rides_on_its_smoke() {
    assert_detail_rides("oil_fire");
}
