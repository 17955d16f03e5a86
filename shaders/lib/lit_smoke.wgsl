// Lighting of accumulated smoke by normal or six-way maps, shared by transfer and light_target.

#import "lib/diffuse.wgsl"
#import "lib/accumulated.wgsl"
#import "lib/attachments.wgsl"
#import "lib/normal.wgsl"
#import "lib/shadow_volume.wgsl"
#import "lib/diffuse_bake.wgsl"
#import "lib/emission.wgsl"

// Six faces of baked light by normal (cubemap), or one image of a lit sphere (motif).
@group(3) @binding(2) var baked_diffuse: texture_2d_array<f32>;
// Textures of the accumulation target behind the first. Those that the system does not have are not read.
@group(3) @binding(3) var texture_1: texture_2d<f32>;
@group(3) @binding(4) var texture_2: texture_2d<f32>;
@group(3) @binding(5) var texture_3: texture_2d<f32>;

const DIFFUSE_MODE_RAMP: u32 = 0u;
const DIFFUSE_MODE_CUBEMAP: u32 = 1u;
const DIFFUSE_MODE_MOTIF: u32 = 2u;
const DIFFUSE_MODE_PAINTED_MOTIF: u32 = 3u;
const DIFFUSE_MODE_SPHERICAL_HARMONICS: u32 = 4u;
override DIFFUSE_MODE: u32 = DIFFUSE_MODE_RAMP;
override NORMAL_ENCODING: u32 = NORMAL_ENCODING_SIGNED;
override NORMAL_DECODE: u32 = NORMAL_DECODE_EXACT;

// Surface that light falls on.
struct Surface {
    // Unit length, view space.
    normal: vec3f,
    // If the target has six-way light.
    six_way: SixWay,
    shade: Shade,
    // Moments of its depth, as in depth_moments(), if the target has them.
    depth: vec2f,
    // Means of heat and of its square, if the target has them.
    heat: vec2f,
    // Mean color of the particles.
    tint: vec3f,
}

// Samples the textures behind the first at a pixel of the view.
fn sample_attachments(pixel: vec2f) -> Attachments {
    var slots: array<vec4f, MAX_TARGET_ATTACHMENTS>;
    if ATTACHMENT_COUNT > 1u {
        slots[1] = sample_target(texture_1, pixel);
    }
    if ATTACHMENT_COUNT > 2u {
        slots[2] = sample_target(texture_2, pixel);
    }
    if ATTACHMENT_COUNT > 3u {
        slots[3] = sample_target(texture_3, pixel);
    }
    return attachments_from_slots(slots);
}

// Loads a texel of the textures behind the first.
fn load_attachments(texel: vec2i) -> Attachments {
    var slots: array<vec4f, MAX_TARGET_ATTACHMENTS>;
    if ATTACHMENT_COUNT > 1u {
        slots[1] = textureLoad(texture_1, texel, 0);
    }
    if ATTACHMENT_COUNT > 2u {
        slots[2] = textureLoad(texture_2, texel, 0);
    }
    if ATTACHMENT_COUNT > 3u {
        slots[3] = textureLoad(texture_3, texel, 0);
    }
    return attachments_from_slots(slots);
}

// Decodes a texel of the first texture, and the values of the others.
fn surface_from_accumulation(accumulated: vec4f, attachments: Attachments) -> Surface {
    var surface: Surface;
    surface.shade = shade_of_sprites(vec3f(0.0));
    surface.tint = vec3f(1.0);
    if OPTICAL_DEPTHS_SLOT != 0u {
        let depths = attachments.optical_depths;
        surface.shade.optical_depths = depths.rgb / max(depths.a, 1.0e-6);
    }
    if DEPTH_SLOT != 0u {
        surface.depth = attachments.depth.rg / max(attachments.depth.a, 1.0e-6);
    }
    if HEAT_SLOT != 0u {
        // The fit of an upsampler may fall below 0, which means cold.
        surface.heat = max(attachments.heat.rg, vec2f(0.0)) / max(attachments.heat.a, 1.0e-6);
    }
    if TINT_SLOT != 0u {
        surface.tint = max(attachments.tint.rgb, vec3f(0.0)) / max(attachments.tint.a, 1.0e-6);
    }
    if SIX_WAY_SLOT != 0u {
        // The fit of an upsampler may fall below 0, which means no light.
        let negative = attachments.six_way;
        let scale = 1.0 / max(negative.a, 1.0e-6);
        surface.six_way = SixWay(max(accumulated.rgb, vec3f(0.0)) * scale, max(negative.rgb, vec3f(0.0)) * scale);
        surface.normal = normal_from_six_way(surface.six_way.positive, surface.six_way.negative);
        return surface;
    }
    var weights = accumulated.a;
    if WEIGHTS_SLOT != 0u {
        weights = attachments.weights;
    }
    surface.normal = normal_from_accumulation(NORMAL_ENCODING, NORMAL_DECODE, accumulated.rgb, weights);
    return surface;
}

// Surface at a pixel, past the scene's shadow and open to the sky.
fn shaded_surface(accumulated: vec4f, attachments: Attachments, pixel: vec2f) -> Surface {
    var surface = surface_from_accumulation(accumulated, attachments);
    if SHADOW && DEPTH_SLOT != 0u {
        surface.shade = shade_on_ray(surface.shade.optical_depths, ray_of_pixel(pixel), surface.depth);
    }
    return surface;
}

// Point of the smoke that is lit at a pixel, view space: at its mean depth, or on the plane of shading_position().
fn lit_position(surface: Surface, pixel: vec2f) -> vec3f {
    if DEPTH_SLOT == 0u {
        return shading_position(pixel);
    }
    return mean_position(ray_of_pixel(pixel), surface.depth);
}

fn diffuse(surface: Surface, amount: f32, position: vec3f) -> vec3f {
    if SIX_WAY_SLOT != 0u {
        return diffuse_from_six_way(surface.six_way, position, surface.shade) * system.diffuse_intensity * surface.tint;
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
        default: {
            light = diffuse_from_lights(normal, coverage(amount, system.boost), position, surface.shade);
        }
    }
    return light * system.diffuse_intensity * surface.tint;
}

// Light that the smoke gives at a point.
fn fire_light(surface: Surface, amount: f32) -> vec3f {
    if HEAT_SLOT == 0u {
        return vec3f(0.0);
    }
    return emission(fire_from_moments(surface.heat), amount);
}
