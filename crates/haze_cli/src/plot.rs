//! Plots curves on an image.

use glam::{UVec2, Vec2};
use image::{Rgb, RgbImage};

use haze_export::contact_sheet::{BACKGROUND, TEXT_COLOR};
use haze_export::text_drawing::draw_text;

const GRID: Rgb<u8> = Rgb([58, 60, 66]);
/// Margins beside the curves, pixels; the right one holds their names.
pub const LEFT: f32 = 44.0;
pub const RIGHT: f32 = 150.0;
const TOP: f32 = 16.0;
const BOTTOM: f32 = 44.0;
/// Half the width of a line, pixels.
const HALF_WIDTH: f32 = 1.2;

/// A function with its name and color.
pub struct Curve {
    pub name: &'static str,
    pub color: Rgb<u8>,
    pub function: Box<dyn Fn(f32) -> f32>,
}

/// Plots functions over `from..to`; values are 0..1. `axis` labels the x axis.
pub fn plot(size: UVec2, from: f32, to: f32, axis: &str, curves: &[Curve]) -> RgbImage {
    let mut image = RgbImage::from_pixel(size.x, size.y, BACKGROUND);
    let area = size.as_vec2() - Vec2::new(LEFT + RIGHT, TOP + BOTTOM);
    let position = |x: f32, y: f32| Vec2::new(LEFT, TOP) + Vec2::new((x - from) / (to - from), 1.0 - y) * area;
    for tenth in (0..=10).step_by(5) {
        let y = tenth as f32 / 10.0;
        line(&mut image, GRID, &[position(from, y), position(to, y)]);
        draw_text(&mut image, 8.0, position(from, y).y - 9.0, 16.0, TEXT_COLOR, &format!("{y:.1}"));
    }
    let mut x = from;
    while x <= to + 1.0e-3 {
        line(&mut image, GRID, &[position(x, 0.0), position(x, 1.0)]);
        let at = position(x, 0.0) + Vec2::new(-12.0, 4.0);
        draw_text(&mut image, at.x, at.y, 16.0, TEXT_COLOR, &format!("{x:.1}"));
        x += 0.5;
    }
    draw_text(&mut image, LEFT, size.y as f32 - 22.0, 16.0, TEXT_COLOR, axis);
    for (index, curve) in curves.iter().enumerate() {
        let points: Vec<_> = (0..=400).map(|i| from + (to - from) * i as f32 / 400.0).collect();
        let points: Vec<_> = points.into_iter().map(|x| position(x, (curve.function)(x))).collect();
        line(&mut image, curve.color, &points);
        let at = Vec2::new(size.x as f32 - RIGHT + 14.0, TOP + 24.0 * index as f32);
        draw_text(&mut image, at.x, at.y, 18.0, curve.color, curve.name);
    }
    image
}

/// Draws an antialiased line through points of ascending x.
fn line(image: &mut RgbImage, color: Rgb<u8>, points: &[Vec2]) {
    for (&a, &b) in points.iter().zip(&points[1..]) {
        let reach = Vec2::splat(HALF_WIDTH + 1.0);
        let last = Vec2::new(image.width() as f32, image.height() as f32) - 1.0;
        let low = (a.min(b) - reach).floor().clamp(Vec2::ZERO, last).as_uvec2();
        let high = (a.max(b) + reach).ceil().clamp(Vec2::ZERO, last).as_uvec2();
        for y in low.y..=high.y {
            for x in low.x..=high.x {
                let p = Vec2::new(x as f32, y as f32) + 0.5;
                let along = ((p - a).dot(b - a) / (b - a).length_squared().max(1.0e-6)).clamp(0.0, 1.0);
                let covered = (HALF_WIDTH + 0.5 - p.distance(a.lerp(b, along))).clamp(0.0, 1.0);
                let pixel = image.get_pixel_mut(x, y);
                for (channel, ink) in pixel.0.iter_mut().zip(color.0) {
                    // Overlapping segments blend towards the same ink.
                    let mixed = f32::from(*channel) + (f32::from(ink) - f32::from(*channel)) * covered;
                    *channel = mixed.round() as u8;
                }
            }
        }
    }
}
