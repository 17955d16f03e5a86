// Shadow of smoke on smoke: optical depth towards a light, and its lookup in the shadow ramp. Lengths are in cells of the
// density grid.

#import "lib/density_grid.wgsl"

// True if the system receives shadow.
override SHADOW: bool = false;

// Number of blocks with lights that the system reads.
override SHADOW_BLOCKS: u32 = 1u;

// Lights in a block of the volume of a frame's shadow.
const LIGHTS_PER_BLOCK: u32 = 3u;
// Largest number of blocks with lights.
const LIGHT_BLOCKS: u32 = 5u;
// LIGHTS_PER_BLOCK * LIGHT_BLOCKS.
const SHADOWED_LIGHTS: u32 = 15u;
const SHADOW_STEPS: u32 = 48u;
// Largest optical depth that is stored. Half floats hold it, and no light is left behind it.
const MAX_OPTICAL_DEPTH: f32 = 1000.0;

// Unit vector from a point to a light, and in w the distance to where the march ends: at the light, or where the line
// leaves the grid of `size` cells. `light`: its position, and 0 in w; or the direction to it, and 1 in w.
fn shadow_ray(light: vec4f, origin: vec3f, size: vec3f) -> vec4f {
    let to_light = light.xyz - origin * (1.0 - light.w);
    let distance = sqrt(max(dot(to_light, to_light), 1.0e-8));
    let direction = to_light / distance;
    let ahead = select(origin, size - origin, direction > vec3f(0.0));
    let exit = ahead / max(abs(direction), vec3f(1.0e-12));
    let leave = max(min(exit.x, min(exit.y, exit.z)), 0.0);
    return vec4f(direction, select(min(leave, distance), leave, light.w > 0.5));
}

// Offset of a step of a march from its line, in radii of the light's disc: the steps are spread evenly over the disc. The
// square of the distance and the angle are a sequence of low discrepancy. (Roberts, "The Unreasonable Effectiveness of
// Quasirandom Sequences", 2018)
fn light_disc_offset(step: u32, direction: vec3f) -> vec3f {
    let position = fract(vec2f(0.7548777, 0.5698403) * (f32(step) + 0.5));
    let axis = select(vec3f(0.0, 1.0, 0.0), vec3f(1.0, 0.0, 0.0), abs(direction.y) > 0.9);
    let right = normalize(cross(direction, axis));
    let angle = position.y * 6.2831853;
    return (right * cos(angle) + cross(right, direction) * sin(angle)) * sqrt(position.x);
}

// Optical depth of a sprite's own smoke from its center outwards, as a lookup at its center finds it.
//
// It is c · mass / width². The variance r²/7 of the bump along each axis grows with the size of the cells and by the
// trilinear lookups of the march and of the result; `2.0` is fitted to the mean over positions between cells. c is 7/4π for a
// Gaussian, and between 0.439 along an axis and 0.487 along the diagonal of a cube for the bump. Widening takes the bump to
// a Gaussian as it takes away its kurtosis, by the square of r²/width².
fn own_optical_depth(radius: f32, depth: f32) -> f32 {
    let reach = bump_radius(radius);
    let widened = reach * reach + 2.0;
    let kept = reach * reach / widened;
    let shape = 0.557 - 0.09 * kept * kept;
    return 4.0 * depth * radius * radius / widened * shape;
}

// Optical depths through other sprites: what the grid holds, less the sprite's own part.
fn foreign_optical_depths(in_grid: vec3f, own: f32) -> vec3f {
    return max(in_grid - own, vec3f(0.0));
}

// Part of the optical depths at the mean depth of the smoke that the smoke there adds itself: the mean excess of those in the
// grid, towards the first block of lights, over those that the sprites accumulated.
fn own_at_mean_depth(in_grid: vec3f, accumulated: vec3f) -> f32 {
    return dot(max(in_grid - accumulated, vec3f(0.0)), vec3f(1.0 / 3.0));
}

// Lookup position in the shadow ramp. Across: 0 in full light, 1 behind endless smoke. Up: 0 for a light on the viewer's
// side, 1 for a light behind the smoke.
fn shadow_position(optical_depth: f32, to_light: vec3f, to_viewer: vec3f) -> vec2f {
    return vec2f(saturate(1.0 - exp2(-optical_depth)), saturate(0.5 - 0.5 * dot(to_light, to_viewer)));
}

// Block of a light with shadow, by its slot, from 1 on; 0 without a slot.
fn block_of_slot(slot: f32) -> f32 {
    return floor(max(slot - 1.0, 0.0) / f32(LIGHTS_PER_BLOCK));
}

// 1 in the channel of a slot of the first block, from 1 on; 0 in the others.
fn channel_of_slot(slot: f32) -> vec3f {
    return max(1.0 - abs(vec3f(1.0, 2.0, 3.0) - slot), vec3f(0.0));
}

// Value of a light with shadow: a channel of `values`, those of its block, by its slot; 0 without a slot.
fn select_slot(slot: f32, values: vec3f) -> f32 {
    return dot(values, channel_of_slot(slot - block_of_slot(slot) * f32(LIGHTS_PER_BLOCK)));
}
