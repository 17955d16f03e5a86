//! Samples colors from a screenshot for the eyedropper.

use egui::{ColorImage, Key, Pos2};
use glam::Vec3;

/// Minimum length of a stroke, points. Shorter ones count as clicks.
const CLICK: f32 = 6.0;
/// Number of colors along a stroke, each the mean over its part. Finer detail would be noise.
const PARTS: usize = 32;

/// Sample size: side of the square of pixels that are averaged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SampleSize {
    #[default]
    One = 1,
    Three = 3,
    Five = 5,
}

impl SampleSize {
    pub const ALL: [(Self, Key); 3] = [(Self::One, Key::Num1), (Self::Three, Key::Num3), (Self::Five, Key::Num5)];

    /// Returns the number of pixels on either side of the middle.
    pub fn reach(self) -> i32 {
        self as i32 / 2
    }

    /// Returns the sample size `by` steps larger or smaller.
    pub fn stepped(self, by: isize) -> Self {
        let at = Self::ALL.iter().position(|(sample_size, _)| *sample_size == self).unwrap_or(0);
        Self::ALL[at.saturating_add_signed(by).min(Self::ALL.len() - 1)].0
    }
}

/// Returns the pixel at a position in points, clamped to the image.
pub fn pixel_at(screenshot: &ColorImage, at: Pos2, pixels_per_point: f32) -> [i32; 2] {
    let at = (at.to_vec2() * pixels_per_point).floor();
    let [width, height] = screenshot.size.map(|side| side as f32 - 1.0);
    [at.x.min(width).max(0.0) as i32, at.y.min(height).max(0.0) as i32]
}

/// Returns the color of a pixel, 0 to 255. Positions outside are clamped to the border.
pub fn pixel_color(screenshot: &ColorImage, [x, y]: [i32; 2]) -> Vec3 {
    let [width, height] = screenshot.size;
    let inside = |at: i32, side: usize| usize::try_from(at).unwrap_or(0).min(side.saturating_sub(1));
    let pixel = screenshot.pixels.get(inside(y, height) * width + inside(x, width)).copied().unwrap_or_default();
    let [r, g, b, _] = pixel.to_array();
    Vec3::from([r, g, b].map(f32::from))
}

/// Returns the mean sRGB code of the pixels around one, as in a blurred image.
fn mean_color(screenshot: &ColorImage, [x, y]: [i32; 2], sample_size: SampleSize) -> Vec3 {
    let reach = sample_size.reach();
    let around = (-reach..=reach).flat_map(|down| (-reach..=reach).map(move |right| [x + right, y + down]));
    around.map(|at| pixel_color(screenshot, at)).sum::<Vec3>() / (sample_size as i32 * sample_size as i32) as f32
}

/// Returns the sRGB colors along a stroke, 0 to 255; one color for a click.
pub fn sample_colors(
    screenshot: &ColorImage,
    stroke: &[Pos2],
    pixels_per_point: f32,
    sample_size: SampleSize,
) -> Vec<Vec3> {
    let pixel = |at: Pos2| mean_color(screenshot, pixel_at(screenshot, at, pixels_per_point), sample_size);
    let Some(first) = stroke.first().filter(|_| !screenshot.pixels.is_empty()) else { return Vec::new() };
    let length: f32 = stroke.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
    if length < CLICK {
        return vec![pixel(*first)];
    }
    let mut parts = vec![(Vec3::ZERO, 0.0); PARTS];
    let mut before = 0.0;
    for pair in stroke.windows(2) {
        let part = pair[0].distance(pair[1]);
        let steps = (part * pixels_per_point * 2.0).ceil().max(1.0);
        for step in 0..steps as usize {
            let fraction = (step as f32 + 0.5) / steps;
            let along = (before + part * fraction) / length;
            let (sum, weight) = &mut parts[((along * PARTS as f32) as usize).min(PARTS - 1)];
            *sum += pixel(pair[0].lerp(pair[1], fraction)) * part / steps;
            *weight += part / steps;
        }
        before += part;
    }
    parts.into_iter().filter(|(_, weight)| *weight > 0.0).map(|(sum, weight)| sum / weight).collect()
}

#[cfg(test)]
mod tests {
    use egui::{Color32, pos2, vec2};

    use super::*;

    /// Image whose red increases across and green downwards.
    fn image() -> ColorImage {
        let pixel = |index: usize| Color32::from_rgb((index % 200) as u8, (index / 200) as u8, 9);
        ColorImage::new([200, 100], (0..20_000).map(pixel).collect())
    }

    #[test]
    fn a_click_samples_the_pixel_under_the_pointer() {
        for (at, scale, expected) in [
            (pos2(20.7, 30.2), 1.0, [20.0, 30.0]),
            (pos2(20.7, 30.2), 2.0, [41.0, 60.0]),
            (pos2(900.0, -5.0), 1.0, [199.0, 0.0]),
        ] {
            let colors = sample_colors(&image(), &[at, at + vec2(1.0, 1.0)], scale, SampleSize::One);
            assert_eq!(colors, [Vec3::new(expected[0], expected[1], 9.0)]);
        }
        assert!(sample_colors(&ColorImage::default(), &[pos2(1.0, 1.0)], 1.0, SampleSize::One).is_empty());
        assert!(sample_colors(&image(), &[], 1.0, SampleSize::One).is_empty());
    }

    #[test]
    fn larger_sample_sizes_average_pixels() {
        let at = [pos2(20.5, 30.5)];
        let mut noisy = image();
        noisy.pixels[30 * 200 + 20] = Color32::from_rgb(245, 30, 9);
        for (sample_size, expected) in [(SampleSize::One, 245.0), (SampleSize::Three, 45.0), (SampleSize::Five, 29.0)] {
            let taken = sample_colors(&noisy, &at, 1.0, sample_size)[0];
            assert!(taken.abs_diff_eq(Vec3::new(expected, 30.0, 9.0), 1.0e-3), "{sample_size:?}: {taken}");
        }
        // At a corner the border pixels are repeated.
        let corner = sample_colors(&image(), &[pos2(0.0, 0.0)], 1.0, SampleSize::Three)[0];
        assert!(corner.abs_diff_eq(Vec3::new(1.0 / 3.0, 1.0 / 3.0, 9.0), 1.0e-3), "{corner}");
        let sizes = [-1, 1, 1, 1].map(|by| SampleSize::Three.stepped(by));
        assert_eq!(sizes, [SampleSize::One, SampleSize::Five, SampleSize::Five, SampleSize::Five]);
        assert_eq!((SampleSize::One.stepped(-1), SampleSize::Five.stepped(1)), (SampleSize::One, SampleSize::Five));
    }

    #[test]
    fn a_stroke_samples_colors_along_its_path() {
        // Positions along a stroke are measured by path length, also on the way back.
        let there = [pos2(0.0, 50.5), pos2(100.0, 50.5), pos2(180.0, 50.5)];
        let row = sample_colors(&image(), &there, 1.0, SampleSize::One);
        assert_eq!(row.len(), PARTS);
        for (index, color) in row.iter().enumerate() {
            let expected = (index as f32 + 0.5) / PARTS as f32 * 180.0 - 0.5;
            assert!((color.x - expected).abs() < 1.0 && (color.y - 50.0).abs() < 1.0e-3, "{index}: {color}");
        }
        let back = sample_colors(&image(), &[there[0], there[1], there[0]], 1.0, SampleSize::One);
        assert!((back[PARTS - 1].x - back[0].x).abs() < 1.0 && (back[PARTS / 2].x - 98.0).abs() < 3.0, "{back:?}");
    }
}
