//! Shadow of smoke on smoke: optical depth towards a light, and its lookup in the shadow ramp. Lengths are in cells of
//! the density grid.

use glam::{Vec2, Vec3, Vec4};

use super::density_grid::bump_radius;
use super::saturate;

/// Lights in a block of the volume of a frame's shadow: a texel has three values, and the hardware blends three values and
/// the amount in one texture.
pub const LIGHTS_PER_BLOCK: usize = 3;
/// Largest number of blocks with lights.
pub const LIGHT_BLOCKS: usize = 5;
/// Largest number of lights whose shadows are drawn.
pub const SHADOWED_LIGHTS: usize = LIGHTS_PER_BLOCK * LIGHT_BLOCKS;

/// Steps of a march. Cells are at most 1.5 steps apart at a resolution of 32.
pub const SHADOW_STEPS: u32 = 48;
/// Largest optical depth that is stored. Half floats hold it, and no light is left behind it.
pub const MAX_OPTICAL_DEPTH: f32 = 1000.0;

/// Unit vector from a point to a light, and in w the distance to where the march ends: at the light, or where the line
/// leaves the grid of `size` cells. `light`: its position, and 0 in w; or the direction to it, and 1 in w.
pub fn shadow_ray(light: Vec4, from: Vec3, size: Vec3) -> Vec4 {
    let to_light = light.truncate() - from * (1.0 - light.w);
    let distance = to_light.dot(to_light).max(1.0e-8).sqrt();
    let direction = to_light / distance;
    let ahead = Vec3::select(direction.cmpgt(Vec3::ZERO), size - from, from);
    let exit = ahead / direction.abs().max(Vec3::splat(1.0e-12));
    let leave = exit.x.min(exit.y).min(exit.z).max(0.0);
    direction.extend(if light.w > 0.5 { leave } else { leave.min(distance) })
}

/// Offset of a step of a march from its line, in radii of the light's disc: the steps are spread evenly over the disc. The
/// square of the distance and the angle are a sequence of low discrepancy. (Roberts, "The Unreasonable Effectiveness of
/// Quasirandom Sequences", 2018)
pub fn light_disc_offset(step: u32, direction: Vec3) -> Vec3 {
    let position = (Vec2::new(0.754_877_7, 0.569_840_3) * (step as f32 + 0.5)).fract();
    let axis = if direction.y.abs() > 0.9 { Vec3::X } else { Vec3::Y };
    let right = direction.cross(axis).normalize();
    let angle = position.y * std::f32::consts::TAU;
    (right * angle.cos() + right.cross(direction) * angle.sin()) * position.x.sqrt()
}

/// Optical depth of a sprite's own smoke from its center outwards, as a lookup at its center finds it.
///
/// It is c · mass / width². The variance r²/7 of the bump along each axis grows with the size of the cells and by the
/// trilinear lookups of the march and of the result; `2.0` is fitted to the mean over positions between cells. c is 7/4π for
/// a Gaussian, and between 0.439 along an axis and 0.487 along the diagonal of a cube for the bump. Widening takes the bump
/// to a Gaussian as it takes away its kurtosis, by the square of r²/width².
pub fn own_optical_depth(radius: f32, depth: f32) -> f32 {
    let reach = bump_radius(radius);
    let widened = reach * reach + 2.0;
    let kept = reach * reach / widened;
    let shape = 0.557 - 0.09 * kept * kept;
    4.0 * depth * radius * radius / widened * shape
}

/// Optical depths through other sprites: what the grid holds, less the sprite's own part.
pub fn foreign_optical_depths(in_grid: Vec3, own: f32) -> Vec3 {
    (in_grid - own).max(Vec3::ZERO)
}

/// Optical depth that the smoke at its own mean depth adds to its shadow: how far the optical depths in the grid exceed those
/// that the sprites accumulated, on average over the first block of lights.
pub fn own_at_mean_depth(in_grid: Vec3, accumulated: Vec3) -> f32 {
    (in_grid - accumulated).max(Vec3::ZERO).dot(Vec3::splat(1.0 / 3.0))
}

/// Lookup position in the shadow ramp. Across: 0 in full light, 1 behind endless smoke. Up: 0 for a light on the viewer's
/// side, 1 for a light behind the smoke.
pub fn shadow_position(optical_depth: f32, to_light: Vec3, to_viewer: Vec3) -> Vec2 {
    Vec2::new(saturate(1.0 - (-optical_depth).exp2()), saturate(0.5 - 0.5 * to_light.dot(to_viewer)))
}

/// Block of a light with shadow, by its slot, from 1 on; 0 without a slot.
pub fn block_of_slot(slot: f32) -> f32 {
    ((slot - 1.0).max(0.0) / LIGHTS_PER_BLOCK as f32).floor()
}

/// 1 in the channel of a slot of the first block, from 1 on; 0 in the others.
pub fn channel_of_slot(slot: f32) -> Vec3 {
    (Vec3::ONE - (Vec3::new(1.0, 2.0, 3.0) - slot).abs()).max(Vec3::ZERO)
}

/// Value of a light with shadow: a channel of `values`, those of its block, by its slot; 0 without a slot.
pub fn select_slot(slot: f32, values: Vec3) -> f32 {
    values.dot(channel_of_slot(slot - block_of_slot(slot) * LIGHTS_PER_BLOCK as f32))
}

#[cfg(test)]
mod tests;
