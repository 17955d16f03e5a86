// Bindings of every pass. The layouts are in src/renderer/layouts.rs.

#import "lib/view.wgsl"
#import "lib/system.wgsl"
#import "lib/lighting.wgsl"

// MAX_LIGHTS in crates/haze_core/src/frame/light.rs.
const MAX_LIGHTS: u32 = 128u;

@group(0) @binding(0) var<uniform> view: View;
// The host's depth buffer, or its R32Float view depth. Read with textureLoad as unfilterable float, which every backend
// supports for both.
@group(0) @binding(1) var scene_depth: texture_2d<f32>;

@group(1) @binding(0) var<uniform> system: System;
// View space. Only lights that reach the system.
@group(1) @binding(1) var<uniform> lights: array<Light, MAX_LIGHTS>;

// Optical depths from the cells of the frame's density grid towards the lights with shadow.
@group(1) @binding(2) var shadow_volume: texture_3d<f32>;

@group(2) @binding(0) var sprite: texture_2d_array<f32>;
// x is the diffuse coordinate of the normal, y the amount times boost.
@group(2) @binding(1) var diffuse_ramp: texture_2d<f32>;
@group(2) @binding(2) var soft_scatter_ramp: texture_2d<f32>;
// x is distance², y is the amount.
@group(2) @binding(3) var specular_ramp: texture_2d<f32>;
@group(2) @binding(4) var painted_motif: texture_2d<f32>;
@group(2) @binding(5) var linear_sampler: sampler;
// rgb: depth and motion, see detail_from_texel().
@group(2) @binding(6) var detail: texture_2d_array<f32>;
@group(2) @binding(7) var age_ramp: texture_2d<f32>;
@group(2) @binding(8) var noise: texture_3d<f32>;
@group(2) @binding(9) var repeat_sampler: sampler;
@group(2) @binding(10) var coverage_ramp: texture_2d<f32>;
// x is the mip level, y the frame; see alpha_bounds_texel().
@group(2) @binding(11) var sprite_alpha_bounds: texture_2d<u32>;
@group(2) @binding(12) var backlight_ramp: texture_2d<f32>;
// x by optical depth, y by the angle between light and viewer: see shadow_position().
@group(2) @binding(13) var shadow_ramp: texture_2d<f32>;
// x by age.
@group(2) @binding(14) var heat_ramp: texture_2d<f32>;
// x by heat, y by amount times boost.
@group(2) @binding(15) var fire_ramp: texture_2d<f32>;

// Depth of the host at a pixel of the view.
fn load_scene_depth(pixel: vec2i) -> f32 {
    return textureLoad(scene_depth, pixel + vec2i(view.origin), 0).r;
}
