// tonemap
// What    Tonemaps linear HDR images: one, two side by side, or their difference.
// Reads   two images; the same image twice to show one.
// Writes  a target that holds sRGB code in a format without sRGB conversion.
// Blend   none.
// Source  see the curves in lib/tonemap.wgsl.
// Space   target pixels.

#import "lib/tonemap.wgsl"

struct Tonemap {
    // Upper left corner and size in the target, pixels.
    origin: vec2f,
    size: vec2f,
    // Exposure factor of each image. 0: the image holds data, which is shown unchanged.
    exposure: vec2f,
    // Distance from the left, pixels, from which on the second image is shown.
    split: f32,
    // Factor on the difference of the two images in sRGB code. 0 shows the images instead.
    difference: f32,
    // Tonemap curve of each image.
    curves: vec2u,
    // WebGL wants sizes that are multiples of 16 bytes.
    padding: vec2u,
}

@group(0) @binding(0) var<uniform> tonemap: Tonemap;
@group(0) @binding(1) var first: texture_2d<f32>;
@group(0) @binding(2) var second: texture_2d<f32>;
@group(0) @binding(3) var smooth_sampler: sampler;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(vec2f(vec2u(index & 1u, index >> 1u)) * 4.0 - 1.0, 0.0, 1.0);
}

fn code(color: vec3f, curve: u32, exposure: f32) -> vec3f {
    if exposure == 0.0 {
        return color;
    }
    return tonemapped(color, curve, exposure);
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = position.xy - tonemap.origin;
    let uv = pixel / tonemap.size;
    let a = code(textureSampleLevel(first, smooth_sampler, uv, 0.0).rgb, tonemap.curves.x, tonemap.exposure.x);
    let b = code(textureSampleLevel(second, smooth_sampler, uv, 0.0).rgb, tonemap.curves.y, tonemap.exposure.y);
    if tonemap.difference > 0.0 {
        return vec4f(abs(a - b) * tonemap.difference, 1.0);
    }
    return vec4f(select(a, b, pixel.x >= tonemap.split) + dither(vec2u(pixel)), 1.0);
}
