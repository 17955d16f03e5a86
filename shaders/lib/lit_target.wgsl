// Sampling of the lit target at full resolution, shared by transfer_lit and specular_scatter.

#import "lib/accumulated.wgsl"
#import "lib/ramp.wgsl"

// Output of depth_slopes.
@group(3) @binding(2) var depth_slopes: texture_2d<f32>;

// Samples the lit smoke at a pixel of the view. Under UPSAMPLE_GUIDED, each texel is carried to the pixel's depth along
// its slope. The filter does not depend on depth where no slope is near, which is most of an image.
// `texel_size`: filter_texel_size().
fn sample_lit(pixel: vec2f, texel_size: vec2f) -> vec4f {
    if UPSAMPLE != UPSAMPLE_GUIDED || system.scale == 1u {
        return sample_target(accumulation, pixel);
    }
    let texel = pixel / f32(system.scale) - system.target_origin;
    if any(texel < vec2f(0.0)) || any(texel >= system.target_size) {
        return vec4f(0.0);
    }
    if !EXACT_FILTERING {
        let position = filtered_position(texel, texel_size);
        if all(textureSampleLevel(depth_slopes, linear_sampler, position, 0.0) == vec4f(0.0)) {
            return textureSampleLevel(accumulation, linear_sampler, position, 0.0);
        }
    }
    let corner = texel - 0.5;
    let base = vec2i(floor(corner));
    let at = array<vec2i, 4>(
        clamped_texel(base),
        clamped_texel(base + vec2i(1, 0)),
        clamped_texel(base + vec2i(0, 1)),
        clamped_texel(base + vec2i(1, 1)),
    );
    let values = mat4x4f(
        textureLoad(accumulation, at[0], 0),
        textureLoad(accumulation, at[1], 0),
        textureLoad(accumulation, at[2], 0),
        textureLoad(accumulation, at[3], 0),
    );
    let slopes = mat4x4f(
        textureLoad(depth_slopes, at[0], 0),
        textureLoad(depth_slopes, at[1], 0),
        textureLoad(depth_slopes, at[2], 0),
        textureLoad(depth_slopes, at[3], 0),
    );
    let fraction = fract(corner);
    let slope = abs(slopes[0]) + abs(slopes[1]) + abs(slopes[2]) + abs(slopes[3]);
    if all(slope == vec4f(0.0)) {
        return values * upsample_weights(UPSAMPLE_BILINEAR, fraction, vec4f(0.0), 0.0);
    }
    let depths = vec4f(guide(at[0]), guide(at[1]), guide(at[2]), guide(at[3]));
    let depth = min(scene_view_depth(pixel), system.smoke_depth_limit);
    let weights = surface_weights(fraction, depths, depth);
    let four = carried_value(weights, values, slopes, depths, depth, 1.0 / system.fade_scale);
    let weight = four_texels_weight(dot(weights, vec4f(1.0)));
    if weight == 1.0 {
        return four;
    }
    return mix(mean_of_sixteen(base, fraction, depth), four, weight);
}

// Coordinate at which the hardware filters the texels around a position, without reading beyond the part in use.
fn filtered_position(texel: vec2f, texel_size: vec2f) -> vec2f {
    return clamp(texel, vec2f(0.5), system.target_size - 0.5) * texel_size;
}

// Size of a texel in the coordinates of the hardware's filter. For vertex shaders: the lookup is slow on NVIDIA's GPUs.
fn filter_texel_size() -> vec2f {
    return 1.0 / vec2f(textureDimensions(accumulation));
}

// Mean of the sixteen texels around a pixel, mostly of those near its depth.
fn mean_of_sixteen(base: vec2i, fraction: vec2f, depth: f32) -> vec4f {
    var sum = vec4f(0.0);
    var total = 0.0;
    for (var i = 0; i < 16; i++) {
        let offset = vec2i(i % 4, i / 4) - 1;
        let at = clamped_texel(base + offset);
        let weight = guided_weight(vec3f(vec2f(offset) - fraction, guide(at) - depth), depth);
        sum += textureLoad(accumulation, at, 0) * weight;
        total += weight;
    }
    return sum / total;
}
