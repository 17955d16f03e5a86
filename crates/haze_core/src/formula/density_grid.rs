//! Coarse grid of the smoke's extinction. Lengths are in cells, extinctions are optical depths across one cell.

use glam::Vec3;

use super::saturate;

/// Steps of the fixed-point numbers that compute shaders add up: the sum is the same in any order.
pub const DENSITY_STEPS: f32 = 65536.0;
/// Largest optical depth that one sprite adds to a cell.
const MAX_CELL_DEPTH: f32 = 16384.0;

/// Mean optical depth over the square of a sprite, −ln(1 − amount · alpha) averaged over its texels: exact for small
/// amounts, where it is `mean_alpha` · amount, and for amount 1, which defines `peak_alpha`.
pub fn mean_optical_depth(amount: f32, mean_alpha: f32, peak_alpha: f32) -> f32 {
    let peak = peak_alpha.max(1.0e-3);
    mean_alpha * -(1.0 - saturate(amount) * peak).ln() / peak
}

/// Integral from −1 to q of the bump 15/16·(1 − q²)²: 0 at −1 and 1 at 1.
pub fn bump_integral(q: f32) -> f32 {
    let x = q.clamp(-1.0, 1.0);
    let square = x * x;
    0.5 + 0.9375 * x * (1.0 - square * (2.0 / 3.0 - square * 0.2))
}

/// Radius of a sprite's bump: its own, and at least that at which a lookup hardly depends on its position between cells.
pub fn bump_radius(radius: f32) -> f32 {
    radius.max(1.5)
}

/// Optical depth that a sprite adds to a cell: its mean over the cell, exactly. The sprite is a product of bumps along
/// the three axes, as wide as its square; the sum over all cells is the `depth` over the area of its square.
///
/// `low`: lower corner of the cell, relative to the sprite's center. `depth`: [`mean_optical_depth`].
pub fn cell_optical_depth(low: Vec3, radius: f32, depth: f32) -> f32 {
    let reach = bump_radius(radius);
    let near = low / reach;
    let far = (low + 1.0) / reach;
    let x = bump_integral(far.x) - bump_integral(near.x);
    let y = bump_integral(far.y) - bump_integral(near.y);
    let z = bump_integral(far.z) - bump_integral(near.z);
    (4.0 * depth * radius * radius * (x * y * z)).min(MAX_CELL_DEPTH)
}

/// Optical depth as a whole number of steps.
pub fn density_steps(optical_depth: f32) -> u32 {
    (optical_depth.max(0.0) * DENSITY_STEPS + 0.5) as u32
}

/// Optical depth from a sum of steps, in two words.
pub fn optical_depth_of_steps(low: u32, high: u32) -> f32 {
    high as f32 * 65536.0 + low as f32 / DENSITY_STEPS
}
