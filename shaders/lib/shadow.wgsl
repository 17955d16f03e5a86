// Shadow of smoke on smoke: optical depth towards a light, and its lookup in the shadow ramp. Lengths are in cells of the
// density grid.

#import "lib/density_grid.wgsl"

// True if the system receives shadow.
override SHADOW: bool = false;

const SHADOWED_LIGHTS: u32 = 3u;
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

// Optical depth of a sprite's own smoke from its centre outwards, as a lookup at its centre finds it.
//
// It is c · mass / width². The variance r²/7 of the bump along each axis grows with the size of the cells and by the
// trilinear lookups of the march and of the result; `2.0` is fitted to the mean over places between cells. c is 7/4π for a
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

// Lookup position in the shadow ramp. Across: 0 in full light, 1 behind endless smoke. Up: 0 for a light on the viewer's
// side, 1 for a light behind the smoke.
fn shadow_position(optical_depth: f32, to_light: vec3f, to_viewer: vec3f) -> vec2f {
    return vec2f(saturate(1.0 - exp2(-optical_depth)), saturate(0.5 - 0.5 * dot(to_light, to_viewer)));
}

// Value of a light with shadow: a channel of `values` by the light's slot, 1 to 3; 0 without a slot.
fn of_slot(slot: f32, values: vec3f) -> f32 {
    let chosen = max(1.0 - abs(vec3f(1.0, 2.0, 3.0) - slot), vec3f(0.0));
    return dot(values, chosen);
}
