//! Detects the direction of green in a sprite's normals.

use glam::{Vec2, Vec3, Vec4, Vec4Swizzles};

use haze_core::assets::sprite::Sprite;

/// Detected direction of green.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct YDirection {
    /// True if green points down.
    pub is_down: bool,
    /// Confidence, 0 to 1. Below [`MIN_CONFIDENCE`] the direction is a guess.
    pub confidence: f32,
}

/// Minimum confidence for a direction to count as known.
pub const MIN_CONFIDENCE: f32 = 0.3;
/// Detects the direction of green by two cues: normals lean outwards at the silhouette, and a gradient field of heights
/// has no curl, which holds only if green has the right sign. `None` if the sprite gives no cue.
pub fn y_direction(sprite: &Sprite) -> Option<YDirection> {
    let mut agrees = 0.0_f32;
    let mut all = 0.0_f32;
    let mut along = 0.0_f32;
    let mut total = 0.0_f32;
    let size = sprite.size();
    for frame in 0..sprite.frame_count() {
        for y in 1..size.saturating_sub(1) {
            for x in 1..size.saturating_sub(1) {
                let at = |x: u32, y: u32| sprite.texel(0, frame, x, y);
                let texel = at(x, y);
                let right = at(x + 1, y);
                let left = at(x - 1, y);
                let above = at(x, y - 1);
                let below = at(x, y + 1);
                // The amount decreases outwards.
                let fall = Vec2::new(left.w - right.w, below.w - above.w);
                let lean = normal(texel).y * fall.y * texel.w;
                agrees += lean;
                all += lean.abs();
                // Zero curl: the change of dz/dx along y equals the change of dz/dy along x.
                let slope = |texel: Vec4| normal(texel).truncate() / normal(texel).z.max(0.25);
                let weight = texel.w.min(right.w).min(left.w).min(above.w).min(below.w);
                let of_x = slope(above).x - slope(below).x;
                let of_y = slope(right).y - slope(left).y;
                along += of_x * of_y * weight;
                total += (of_x * of_y).abs() * weight;
            }
        }
    }
    let fraction = |sum: f32, all: f32| if all > 1.0e-6 { sum / all } else { 0.0 };
    let edges = fraction(agrees, all);
    let curls = fraction(along, total);
    let sum = (edges + curls).clamp(-1.0, 1.0);
    (all > 1.0e-6).then_some(YDirection { is_down: sum < 0.0, confidence: sum.abs() })
}

/// Decodes a texel's normal.
pub(super) fn normal(texel: Vec4) -> Vec3 {
    texel.xyz() * 2.0 - 1.0
}
