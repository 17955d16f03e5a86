// antialiasing
// What    Smooths edges of what is thin and bright, such as sparks.
// Reads   the image.
// Writes  the image.
// Blend   none.
// Source  Lottes, "FXAA", 2009: the direction of an edge by the brightness of the corners, and samples along it.
// Space   pixels; antialiasing.rs has the same functions on the CPU.

#import "lib/color.wgsl"

const EDGE_CONTRAST: f32 = 0.25;
const MIN_CONTRAST: f32 = 0.03;
const BRIGHTEST: f32 = 6.0e4;
const MAX_SPAN: f32 = 8.0;
const CORNER: f32 = 0.03125;
const MIN_CORNER: f32 = 0.0078125;

// Compresses light to 0..1, so that an average looks as it would after a tonemap.
fn compressed(light: vec3f) -> vec3f {
    let color = clamp(light, vec3f(0.0), vec3f(BRIGHTEST));
    return color / (1.0 + max(color.r, max(color.g, color.b)));
}

fn expanded(color: vec3f) -> vec3f {
    return color / max(1.0 - max(color.r, max(color.g, color.b)), 1.0e-4);
}

fn compressed_at(at: vec2i) -> vec3f {
    return compressed(load_clamped(at));
}

fn bilinear(position: vec2f) -> vec3f {
    let corner = floor(position - 0.5);
    let t = position - 0.5 - corner;
    let at = vec2i(corner);
    let upper = mix(compressed_at(at), compressed_at(at + vec2i(1, 0)), t.x);
    let lower = mix(compressed_at(at + vec2i(0, 1)), compressed_at(at + vec2i(1, 1)), t.x);
    return mix(upper, lower, t.y);
}

// Light of a pixel, which is smooth at an edge.
fn smooth_light(at: vec2i) -> vec3f {
    let nw = luminance(compressed_at(at + vec2i(-1, -1)));
    let ne = luminance(compressed_at(at + vec2i(1, -1)));
    let sw = luminance(compressed_at(at + vec2i(-1, 1)));
    let se = luminance(compressed_at(at + vec2i(1, 1)));
    let middle = luminance(compressed_at(at));
    let darkest = min(middle, min(min(nw, ne), min(sw, se)));
    let brightest = max(middle, max(max(nw, ne), max(sw, se)));
    if brightest - darkest < max(MIN_CONTRAST, EDGE_CONTRAST * brightest) {
        return load_clamped(at);
    }
    let across = vec2f(sw + se - nw - ne, nw + sw - ne - se);
    let corner = max(CORNER * (nw + ne + sw + se), MIN_CORNER);
    let along = clamp(across / (min(abs(across.x), abs(across.y)) + corner), vec2f(-MAX_SPAN), vec2f(MAX_SPAN));
    let position = vec2f(at) + 0.5;
    let near = 0.5 * (bilinear(position - along / 6.0) + bilinear(position + along / 6.0));
    let wide = 0.5 * near + 0.25 * (bilinear(position - along * 0.5) + bilinear(position + along * 0.5));
    // Beyond the end of the edge is something else.
    let brightness = luminance(wide);
    return expanded(select(wide, near, brightness < darkest || brightness > brightest));
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let at = vec2i(position.xy);
    return vec4f(smooth_light(at), textureLoad(image, at, 0).a);
}
