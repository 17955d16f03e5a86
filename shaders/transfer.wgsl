// transfer
// What    Lights the accumulated smoke once per pixel, over the system's bounding box.
// Reads   accumulation target, reduced depth, scene depth, lights, ramps, baked diffuse light.
// Writes  the host's colour target: linear HDR, or sRGB code where GAMMA_TARGET.
// Blend   ONE, ONE_MINUS_SRC_ALPHA (premultiplied over the scene).
// Source  OTEE "Transfer & lighting", "Diffuse lighting", "Soft scattering".
// Space   Lighting in view space, on the plane through the middle of the smoke that faces the viewer.

#import "lib/diffuse.wgsl"
#import "lib/accumulated.wgsl"
#import "lib/normal.wgsl"
#import "lib/diffuse_bake.wgsl"
#import "lib/colour.wgsl"

// Six faces of baked light by normal (cubemap), or one picture of a lit sphere (motif).
@group(3) @binding(2) var baked_diffuse: texture_2d_array<f32>;
// What the weights of the normals sum to, where WEIGHT_SUM.
@group(3) @binding(3) var weight_sum: texture_2d<f32>;

const DIFFUSE_MODE_RAMP: u32 = 0u;
const DIFFUSE_MODE_CUBEMAP: u32 = 1u;
const DIFFUSE_MODE_MOTIF: u32 = 2u;
const DIFFUSE_MODE_PAINTED_MOTIF: u32 = 3u;
const DIFFUSE_MODE_SPHERICAL_HARMONICS: u32 = 4u;
override DIFFUSE_MODE: u32 = DIFFUSE_MODE_RAMP;
override NORMAL_ENCODING: u32 = NORMAL_ENCODING_SIGNED;
override NORMAL_DECODE: u32 = NORMAL_DECODE_EXACT;
override WEIGHT_SUM: bool = false;
const COVERAGE_MODE_LINEAR: u32 = 0u;
const COVERAGE_MODE_RAMP: u32 = 1u;
override COVERAGE_MODE: u32 = COVERAGE_MODE_LINEAR;
// True: draw the back faces, never clipped away by the near plane. False: the front faces, depth-tested.
override BACK_FACES: bool = false;
// True: there is no reduced depth, sprites were compared with the host's own.
override HOST_DEPTH: bool = false;

const SHADE_TREE_FINAL: u32 = 0u;
const SHADE_TREE_COMBINED: u32 = 1u;
const SHADE_TREE_DIFFUSE: u32 = 2u;
const SHADE_TREE_SOFT_SCATTER: u32 = 3u;
const SHADE_TREE_SPECULAR_SCATTER: u32 = 4u;
const SHADE_TREE_NORMALS: u32 = 5u;
const SHADE_TREE_AMOUNT: u32 = 6u;
const SHADE_TREE_OVERDRAW: u32 = 7u;
const SHADE_TREE_REDUCED_DEPTH: u32 = 8u;
override SHADE_TREE: u32 = SHADE_TREE_FINAL;

// The twelve triangles of a box, counter-clockwise from outside. Bit 0 of a corner is x, bit 1 y, bit 2 z.
const BOX_CORNERS = array<u32, 36>(
    0u, 2u, 1u, 1u, 2u, 3u,
    4u, 5u, 6u, 5u, 7u, 6u,
    0u, 1u, 4u, 1u, 5u, 4u,
    2u, 6u, 3u, 3u, 6u, 7u,
    0u, 4u, 2u, 2u, 4u, 6u,
    1u, 3u, 5u, 3u, 7u, 5u,
);

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    var corners = BOX_CORNERS;
    let corner = corners[index];
    let side = vec3f(f32(corner & 1u), f32((corner >> 1u) & 1u), f32(corner >> 2u));
    let world = mix(system.bounds_min, system.bounds_max, side);
    var clip = view.clip_from_view * (view.view_from_world * vec4f(world, 1.0));
    if BACK_FACES {
        // Not depth-tested: only the half-space in front of the eye matters, not the near and far planes.
        clip.z = 0.5 * clip.w;
    }
    return clip;
}

fn diffuse(normal: vec3f, position: vec3f) -> vec3f {
    var light = vec3f(0.0);
    switch DIFFUSE_MODE {
        case DIFFUSE_MODE_CUBEMAP: {
            let cube = cube_coordinate(normal);
            light = sample_baked(baked_diffuse, linear_sampler, cube.position, cube.face);
        }
        case DIFFUSE_MODE_MOTIF: { light = sample_baked(baked_diffuse, linear_sampler, motif_position(normal), 0); }
        case DIFFUSE_MODE_PAINTED_MOTIF: {
            light = sample_ramp_2d(painted_motif, linear_sampler, motif_position(normal) * 0.5 + 0.5);
        }
        case DIFFUSE_MODE_SPHERICAL_HARMONICS: { light = spherical_harmonics(system.spherical_harmonics, normal); }
        default: { light = diffuse_from_lights(normal, position); }
    }
    return light * system.diffuse_intensity;
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = position.xy - view.origin;
    if SHADE_TREE == SHADE_TREE_REDUCED_DEPTH {
        var depth = 0.0;
        if HOST_DEPTH {
            depth = scene_view_depth(pixel);
        } else {
            let texel = pixel / system.scale - system.target_origin;
            depth = textureLoad(reduced_depth, vec2i(texel), 0).r * system.depth_limit;
        }
        let grey = 1.0 - saturate((depth - system.bounds_near) / (system.depth_limit - system.bounds_near));
        return vec4f(vec3f(grey), 1.0);
    }
    let accumulated = sample_target(accumulation, pixel);
    let amount = accumulated.a;
    if SHADE_TREE == SHADE_TREE_OVERDRAW {
        return vec4f(overdraw_colour(amount * 255.0), 1.0);
    }
    if SHADE_TREE == SHADE_TREE_AMOUNT {
        return vec4f(vec3f(amount), 1.0);
    }
    if amount <= 0.0 {
        discard;
    }
    var covered = coverage(amount, system.boost);
    if COVERAGE_MODE == COVERAGE_MODE_RAMP {
        covered = painted_coverage(sample_ramp(coverage_ramp, linear_sampler, covered));
    }
    var weights = amount;
    if WEIGHT_SUM {
        weights = sample_target(weight_sum, pixel).r;
    }
    let normal = normal_from_accumulation(NORMAL_ENCODING, NORMAL_DECODE, accumulated.rgb, weights);
    if SHADE_TREE == SHADE_TREE_NORMALS {
        return vec4f(normal * 0.5 + 0.5, 1.0) * covered;
    }

    var light = vec3f(0.0);
    if SHADE_TREE != SHADE_TREE_SOFT_SCATTER {
        light += diffuse(normal, lit_position(pixel));
    }
    if SHADE_TREE != SHADE_TREE_DIFFUSE {
        light += soft_scatter(amount);
    }
    return vec4f(target_colour(light), 1.0) * covered;
}
