// Tiling 3D noise of volumetric sprites: rgb = inverse density gradient / 2 + 1/2, a = density.

#import "lib/ramp.wgsl"

fn load_noise_volume(noise: texture_3d<f32>, texel: vec3i, size: vec3i) -> vec4f {
    // `%` has the sign of its first operand.
    return textureLoad(noise, ((texel % size) + size) % size, 0);
}

// Samples the noise, which repeats with every unit of `coordinate`. Callers scale the gradient, once for all octaves.
fn sample_noise_volume(noise: texture_3d<f32>, repeat_sampler: sampler, coordinate: vec3f) -> vec4f {
    if !EXACT_FILTERING {
        return textureSampleLevel(noise, repeat_sampler, coordinate, 0.0);
    }
    let size = vec3i(textureDimensions(noise));
    let at = fract(coordinate) * vec3f(size) - 0.5;
    let base = floor(at);
    let f = at - base;
    let i = vec3i(base);
    let near = mix(
        mix(load_noise_volume(noise, i, size), load_noise_volume(noise, i + vec3i(1, 0, 0), size), f.x),
        mix(load_noise_volume(noise, i + vec3i(0, 1, 0), size), load_noise_volume(noise, i + vec3i(1, 1, 0), size), f.x),
        f.y,
    );
    let far = mix(
        mix(load_noise_volume(noise, i + vec3i(0, 0, 1), size), load_noise_volume(noise, i + vec3i(1, 0, 1), size), f.x),
        mix(load_noise_volume(noise, i + vec3i(0, 1, 1), size), load_noise_volume(noise, i + vec3i(1, 1, 1), size), f.x),
        f.y,
    );
    return mix(near, far, f.z);
}

// Sums octaves of the noise: inverse density gradient (-1..1) and density. Each has three times the frequency and half the weight of the one before; weights sum to
// 1. (MS)
fn sample_noise_octaves(noise: texture_3d<f32>, repeat_sampler: sampler, coordinate: vec3f, octaves: u32) -> vec4f {
    var sum = vec4f(0.0);
    var total = 0.0;
    var weight = 1.0;
    var position = coordinate;
    for (var octave = 0u; octave < octaves; octave++) {
        sum += sample_noise_volume(noise, repeat_sampler, position) * weight;
        total += weight;
        weight *= 0.5;
        position *= 3.0;
    }
    let texel = sum / total;
    return vec4f(texel.rgb * 2.0 - 1.0, texel.a);
}

// Noise coordinate of a point. `from_eye` is its position relative to the eye, in world axes; `noise_offset` is the
// position of the eye minus the rise of the noise. (MS "Animating the volume particles")
fn noise_coordinate(from_eye: vec3f, noise_size: f32, noise_offset: vec3f) -> vec3f {
    return (from_eye + noise_offset) / noise_size;
}
