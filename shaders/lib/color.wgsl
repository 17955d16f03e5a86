// sRGB encoding, luminance, and the color scale of overdraw.

// Encodes linear light as sRGB, 0..1. (IEC 61966-2-1)
fn srgb_from_linear(linear: f32) -> f32 {
    if linear <= 0.0031308 {
        return linear * 12.92;
    }
    return 1.055 * pow(linear, 1.0 / 2.4) - 0.055;
}

// Luminance of linear RGB. (ITU-R BT.709)
fn luminance(light: vec3f) -> f32 {
    return dot(light, vec3f(0.2126, 0.7152, 0.0722));
}

// Linear light, clamped to 0..1 and encoded as sRGB, for a target whose format the hardware does not encode.
fn srgb_color(light: vec3f) -> vec3f {
    let shown = saturate(light);
    return vec3f(srgb_from_linear(shown.r), srgb_from_linear(shown.g), srgb_from_linear(shown.b));
}

// Half of the largest half float: light never becomes infinite in the target, even if a glow is added to smoke.
const MAX_HALF_FLOAT_LIGHT: f32 = 32752.0;

// Light, limited to what a target of half floats can store.
fn bounded_light(light: vec3f) -> vec3f {
    return min(light, vec3f(MAX_HALF_FLOAT_LIGHT));
}

// Color scale of overdraw: black, blue, green, yellow, red, white at 0, 4, 8, 16, 32, 64 layers.
fn overdraw_color(layers: f32) -> vec3f {
    var colors = array<vec3f, 6>(
        vec3f(0.0),
        vec3f(0.0, 0.0, 1.0),
        vec3f(0.0, 1.0, 0.0),
        vec3f(1.0, 1.0, 0.0),
        vec3f(1.0, 0.0, 0.0),
        vec3f(1.0),
    );
    let heat = select(layers * 0.25, log2(max(layers, 1.0)) - 1.0, layers > 4.0);
    let index = clamp(u32(heat), 0u, 4u);
    return mix(colors[index], colors[index + 1u], saturate(heat - f32(index)));
}
