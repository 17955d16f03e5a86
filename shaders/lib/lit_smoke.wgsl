// Lighting of accumulated smoke by normal or six-way maps, and its coverage, shared by transfer and light_target.

#import "lib/diffuse.wgsl"
#import "lib/accumulated.wgsl"
#import "lib/normal.wgsl"
#import "lib/diffuse_bake.wgsl"

// Six faces of baked light by normal (cubemap), or one image of a lit sphere (motif).
@group(3) @binding(2) var baked_diffuse: texture_2d_array<f32>;
// Second target. If WEIGHT_SUM: the sum of the normals' weights in r. If SIX_WAY: light from left, bottom and back, and
// the sum of weights.
@group(3) @binding(3) var extra_attachment: texture_2d<f32>;

const DIFFUSE_MODE_RAMP: u32 = 0u;
const DIFFUSE_MODE_CUBEMAP: u32 = 1u;
const DIFFUSE_MODE_MOTIF: u32 = 2u;
const DIFFUSE_MODE_PAINTED_MOTIF: u32 = 3u;
const DIFFUSE_MODE_SPHERICAL_HARMONICS: u32 = 4u;
override DIFFUSE_MODE: u32 = DIFFUSE_MODE_RAMP;
override NORMAL_ENCODING: u32 = NORMAL_ENCODING_SIGNED;
override NORMAL_DECODE: u32 = NORMAL_DECODE_EXACT;
override WEIGHT_SUM: bool = false;
override SIX_WAY: bool = false;
const COVERAGE_MODE_LINEAR: u32 = 0u;
const COVERAGE_MODE_RAMP: u32 = 1u;
override COVERAGE_MODE: u32 = COVERAGE_MODE_LINEAR;

// Surface that light falls on.
struct Surface {
    // Unit length, view space.
    normal: vec3f,
    // If SIX_WAY.
    six_way: SixWay,
}

// Decodes a texel of the target, and of the second target if there is one.
fn surface_from_accumulation(accumulated: vec4f, extra_attachment: vec4f) -> Surface {
    var surface: Surface;
    if SIX_WAY {
        // The fit of an upsampler may fall below 0, which means no light.
        let scale = 1.0 / max(extra_attachment.a, 1.0e-6);
        surface.six_way = SixWay(max(accumulated.rgb, vec3f(0.0)) * scale, max(extra_attachment.rgb, vec3f(0.0)) * scale);
        surface.normal = normal_from_six_way(surface.six_way.positive, surface.six_way.negative);
        return surface;
    }
    var weights = accumulated.a;
    if WEIGHT_SUM {
        weights = extra_attachment.r;
    }
    surface.normal = normal_from_accumulation(NORMAL_ENCODING, NORMAL_DECODE, accumulated.rgb, weights);
    return surface;
}

fn diffuse(surface: Surface, amount: f32, position: vec3f) -> vec3f {
    if SIX_WAY {
        return diffuse_from_six_way(surface.six_way, position) * system.diffuse_intensity;
    }
    let normal = surface.normal;
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
        default: { light = diffuse_from_lights(normal, coverage(amount, system.boost), position); }
    }
    return light * system.diffuse_intensity;
}

// Share of the scene that the smoke hides.
fn smoke_coverage(amount: f32) -> f32 {
    let covered = coverage(amount, system.boost);
    if COVERAGE_MODE == COVERAGE_MODE_RAMP {
        return painted_coverage(sample_ramp(coverage_ramp, linear_sampler, covered));
    }
    return covered;
}
