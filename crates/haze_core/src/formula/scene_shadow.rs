//! Shadow of smoke on the scene. Lengths are in cells of the density grid.

use glam::{Vec3, Vec4};

use super::saturate;

/// Position, in cells, at which light leaves the grid of `size` cells on its way to `from`, and 1 in w: `from` itself if it is
/// inside, else the point at which the line to the light enters the grid. w is 0 if the line meets the grid nowhere before the
/// light. `light`: its position, and 0 in w; or the direction to it, and 1 in w.
pub fn grid_entry(light: Vec4, from: Vec3, size: Vec3) -> Vec4 {
    let to_light = light.truncate() - from * (1.0 - light.w);
    let distance = to_light.dot(to_light).max(1.0e-8).sqrt();
    let direction = to_light / distance;
    let steady = Vec3::select(direction.abs().cmplt(Vec3::splat(1.0e-6)), Vec3::splat(1.0e-6), direction);
    let low = -from / steady;
    let high = (size - from) / steady;
    let first = low.min(high);
    let last = low.max(high);
    let enter = first.x.max(first.y).max(first.z).max(0.0);
    let leave = last.x.min(last.y).min(last.z);
    let reach = if light.w > 0.5 { leave } else { leave.min(distance) };
    (from + direction * enter).extend(if enter < reach { 1.0 } else { 0.0 })
}

/// Fraction of a light that falls through smoke onto the scene. `painted`: color of the shadow ramp for that optical depth and
/// a light behind the smoke, which tints what is left of the light.
pub fn transmitted_light(optical_depth: f32, painted: Vec3) -> Vec3 {
    let brightest = painted.max_element();
    let hue = if brightest > 1.0e-4 { painted / brightest } else { Vec3::ONE };
    Vec3::ONE.lerp(hue, saturate(1.0 - (-optical_depth).exp2())) * (-optical_depth).exp()
}
