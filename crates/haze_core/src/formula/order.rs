//! Weights of normals under the order `weighted`. WGSL: `shaders/lib/order.wgsl`.

use glam::Vec4;

use super::saturate;

/// Number of view depths for which the optical depth in front is stored. `OPTICAL_DEPTH_KNOTS` in order.wgsl.
pub const OPTICAL_DEPTH_KNOTS: usize = 16;

/// Relative position of a view depth among the knots, 0..=1: `smoke_near` is at 0.25, `smoke_far` at 0.75.
pub fn knot_coordinate(view_depth: f32, smoke_near: f32, smoke_far: f32) -> f32 {
    let through = (view_depth - smoke_near) / (smoke_far - smoke_near).max(1.0e-4);
    saturate(through * 0.5 + 0.25)
}

/// Optical depth of the smoke in front of a view depth, interpolated between the knots.
pub fn optical_depth_in_front(knots: &[Vec4; 4], view_depth: f32, smoke_near: f32, smoke_far: f32) -> f32 {
    let knots: &[f32] = bytemuck::cast_slice(knots);
    let position = knot_coordinate(view_depth, smoke_near, smoke_far) * (OPTICAL_DEPTH_KNOTS - 1) as f32;
    let low = (position as usize).min(OPTICAL_DEPTH_KNOTS - 2);
    knots[low] + (knots[low + 1] - knots[low]) * (position - low as f32)
}

/// Weight of a normal: e^(−depth_weight · optical depth), at most 1. The exponent is limited to 8.
pub fn order_weight(depth_weight: f32, optical_depth: f32) -> f32 {
    (-(depth_weight * optical_depth).min(8.0)).exp()
}
