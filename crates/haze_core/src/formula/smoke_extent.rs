//! Extent of a system's smoke, from sums over its sprites. View space, metres. WGSL: `shaders/lib/smoke_extent.wgsl`.

use super::saturate;

/// Amount below which a sprite counts as nearly transparent.
pub const NEARLY_TRANSPARENT: f32 = 0.05;

/// Weight of a sprite: its amount and its area. It fades out while the sprite passes the near plane.
pub fn extent_weight(amount: f32, radius: f32, view_depth: f32, near: f32) -> f32 {
    saturate(amount) * saturate((view_depth - near) / radius) * radius * radius
}

/// Mean square of a sprite's depths around a reference depth: a sprite stands for a puff as thick as it is wide.
pub fn mean_square_depth(depth: f32, radius: f32) -> f32 {
    depth * depth + radius * radius / 3.0
}

/// Half the thickness of a slab with these moments: its variance is the squared half thickness divided by 3.
pub fn half_extent(mean_square: f32, mean: f32) -> f32 {
    (3.0 * (mean_square - mean * mean).max(0.0)).sqrt()
}

/// Distance that a sprite reaches behind the center. A nearly transparent sprite contributes less, so that its death
/// causes no jump. `back`: view depth of the sprite's back.
pub fn reach_behind(amount: f32, back: f32, center_depth: f32) -> f32 {
    (back - center_depth).max(0.0) * (saturate(amount) / NEARLY_TRANSPARENT).min(1.0)
}
