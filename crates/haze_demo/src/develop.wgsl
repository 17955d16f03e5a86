// Shows pictures of linear HDR on a screen: one, two side by side, or how they differ.

#import "lib/tonemap.wgsl"

struct Develop {
    // Upper left pixel in the target, and size.
    origin: vec2f,
    size: vec2f,
    // Multiplies the light of either picture. 0: the picture holds numbers, which are shown as they are.
    exposure: vec2f,
    // Pixels from the left from which on the second picture is shown.
    split: f32,
    // Multiplies the difference of the two; 0: none is shown.
    difference: f32,
}

@group(0) @binding(0) var<uniform> shown: Develop;
@group(0) @binding(1) var first: texture_2d<f32>;
@group(0) @binding(2) var second: texture_2d<f32>;
@group(0) @binding(3) var smooth_sampler: sampler;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(vec2f(vec2u(index & 1u, index >> 1u)) * 4.0 - 1.0, 0.0, 1.0);
}

fn code(colour: vec3f, exposure: f32) -> vec3f {
    if exposure == 0.0 {
        return colour;
    }
    return developed(colour, exposure);
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = position.xy - shown.origin;
    let uv = pixel / shown.size;
    let a = code(textureSampleLevel(first, smooth_sampler, uv, 0.0).rgb, shown.exposure.x);
    let b = code(textureSampleLevel(second, smooth_sampler, uv, 0.0).rgb, shown.exposure.y);
    if shown.difference > 0.0 {
        return vec4f(abs(a - b) * shown.difference, 1.0);
    }
    return vec4f(select(a, b, pixel.x >= shown.split) + dither(vec2u(pixel)), 1.0);
}
