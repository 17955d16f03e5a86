// Measures the best an adapter can do: fragments that fetch texels, blend, and do nothing else.

@group(0) @binding(0) var source: texture_2d<f32>;
@group(0) @binding(1) var linear_sampler: sampler;
@group(0) @binding(2) var written: texture_storage_2d<rgba16float, write>;

struct Varyings {
    @builtin(position) position: vec4f,
    @location(0) uv: vec2f,
}

// A triangle over the whole target, one instance per layer, at depth 0.5.
@vertex
fn cover(@builtin(vertex_index) index: u32) -> Varyings {
    let corner = vec2f(f32(index & 1u), f32(index >> 1u)) * 2.0;
    return Varyings(vec4f(corner * 2.0 - 1.0, 0.5, 1.0), corner);
}

@fragment
fn constant() -> @location(0) vec4f {
    // Every fragment blends: unlike the disc, a constant has no transparent corners.
    return vec4f(0.05, 0.04, 0.03, 0.1);
}

@fragment
fn one_fetch(in: Varyings) -> @location(0) vec4f {
    let texel = textureSample(source, linear_sampler, in.uv);
    return vec4f(texel.rgb, 1.0) * (texel.a * 0.1);
}

@fragment
fn two_fetches(in: Varyings) -> @location(0) vec4f {
    let texel = mix(textureSample(source, linear_sampler, in.uv), textureSample(source, linear_sampler, in.uv * 0.9 + 0.05), 0.5);
    return vec4f(texel.rgb, 1.0) * (texel.a * 0.1);
}

// Averages 3 x 3 texels, with weights that fall with the difference in the fourth channel.
@fragment
fn joint_bilateral(in: Varyings) -> @location(0) vec4f {
    let size = vec2i(textureDimensions(source));
    let middle = vec2i(in.uv * vec2f(size));
    let own = textureLoad(source, clamp(middle, vec2i(0), size - 1), 0).a;
    var sum = vec4f(0.0);
    var weights = 0.0;
    for (var index = 0; index < 9; index++) {
        let at = clamp(middle + vec2i(index % 3 - 1, index / 3 - 1), vec2i(0), size - 1);
        let texel = textureLoad(source, at, 0);
        let weight = 1.0 / (0.01 + abs(texel.a - own));
        sum += texel * weight;
        weights += weight;
    }
    return sum / weights;
}

override layers: u32 = 1u;

// The layers of `one_fetch`, blended in registers and written once.
@compute @workgroup_size(8, 8)
fn blend_in_registers(@builtin(global_invocation_id) at: vec3u) {
    let size = textureDimensions(written);
    if any(at.xy >= size) {
        return;
    }
    let uv = (vec2f(at.xy) + 0.5) / vec2f(size);
    var sum = vec4f(0.0);
    for (var layer = 0u; layer < layers; layer++) {
        let texel = textureSampleLevel(source, linear_sampler, uv + f32(layer) * 0.001, 0.0);
        let color = vec4f(texel.rgb, 1.0) * (texel.a * 0.1);
        sum = color + sum * (1.0 - color.a);
    }
    textureStore(written, at.xy, sum);
}
