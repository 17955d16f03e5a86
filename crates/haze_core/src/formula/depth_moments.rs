//! Depth of smoke at a pixel, from accumulated moments. Depths are fractions of a system's range of view depths.

use glam::Vec2;

use super::saturate;

/// Number of samples that represent the smoke at a pixel.
pub const DEPTH_SAMPLES: u32 = 4;

/// Depth of a sprite, and the mean of its square: a sprite is as deep as wide. `radius`: half the side of the square that
/// its density fills, metres.
pub fn depth_moments(view_depth: f32, radius: f32, near: f32, far: f32) -> Vec2 {
    let range = (far - near).max(1.0e-4);
    let depth = saturate((view_depth - near) / range);
    let reach = radius / range;
    // The variance of the bump of the density grid.
    Vec2::new(depth, depth * depth + reach * reach / 7.0)
}

/// View depth of a sample of the smoke at a pixel, metres: as if it were spread evenly, as far as its moments are.
/// `moments`: mean depth, and mean of its square.
pub fn depth_of_sample(index: u32, moments: Vec2, near: f32, far: f32) -> f32 {
    let deviation = (moments.y - moments.x * moments.x).max(0.0).sqrt();
    // Even between ±√3 standard deviations.
    let offset = ((index as f32 + 0.5) * (2.0 / DEPTH_SAMPLES as f32) - 1.0) * 1.732_050_8;
    near + (far - near) * saturate(moments.x + deviation * offset)
}
