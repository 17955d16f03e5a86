// Ramp lookups. The centers of a ramp's first and last texel are at 0 and 1, so that the end stops of a gradient are
// reached.

// True: filter in the shader in f32, as the CPU renderer does. False: use the sampler's filter, often with 8-bit
// weights.
override EXACT_FILTERING: bool = false;

const RAMP_FILTER_BILINEAR: u32 = 0u;
const RAMP_FILTER_NEAREST: u32 = 1u;
override RAMP_FILTER: u32 = RAMP_FILTER_BILINEAR;

// Texel coordinate of a ramp coordinate.
fn ramp_texel(size: vec2f, coordinate: vec2f) -> vec2f {
    return saturate(coordinate) * (size - 1.0);
}

fn sample_ramp_nearest(ramp: texture_2d<f32>, coordinate: vec2f) -> vec3f {
    let size = vec2f(textureDimensions(ramp));
    return textureLoad(ramp, vec2i(ramp_texel(size, coordinate) + 0.5), 0).rgb;
}

fn sample_ramp_2d(ramp: texture_2d<f32>, linear_sampler: sampler, coordinate: vec2f) -> vec3f {
    if RAMP_FILTER == RAMP_FILTER_NEAREST {
        return sample_ramp_nearest(ramp, coordinate);
    }
    let size = vec2f(textureDimensions(ramp));
    let texel = ramp_texel(size, coordinate);
    if !EXACT_FILTERING {
        return textureSampleLevel(ramp, linear_sampler, (texel + 0.5) / size, 0.0).rgb;
    }
    let base = floor(texel);
    let fraction = texel - base;
    let low = vec2i(base);
    let high = min(low + 1, vec2i(size) - 1);
    let bottom = mix(textureLoad(ramp, low, 0), textureLoad(ramp, vec2i(high.x, low.y), 0), fraction.x);
    let top = mix(textureLoad(ramp, vec2i(low.x, high.y), 0), textureLoad(ramp, high, 0), fraction.x);
    return mix(bottom, top, fraction.y).rgb;
}

fn sample_ramp(ramp: texture_2d<f32>, linear_sampler: sampler, u: f32) -> vec3f {
    return sample_ramp_2d(ramp, linear_sampler, vec2f(u, 0.0));
}
