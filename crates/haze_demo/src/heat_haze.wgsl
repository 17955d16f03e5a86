// heat haze
// What    Bends light above flames: what is behind hot air shimmers.
// Reads   the image, depth buffer of the scene.
// Writes  the image.
// Blend   none.
// Source  own: a plume per fire, shifted by noise that rises in it.
// Space   pixels; heat_haze.rs has the same functions on the CPU.

#import "lib/depth.wgsl"
#import "lib/hash.wgsl"

const MAX_PLUMES: u32 = 8u;
const PERIOD: u32 = 4096u;

struct Plume {
    base: vec2f,
    axis: vec2f,
    radius: f32,
    depth: f32,
    thickness: f32,
    shift: f32,
}

struct HeatHaze {
    depth_coefficients: vec4f,
    phase: vec2f,
    cell: f32,
    count: u32,
    plumes: array<Plume, MAX_PLUMES>,
}

@group(0) @binding(2) var<uniform> haze: HeatHaze;

fn heat(plume: Plume, pixel: vec2f, view_depth: f32) -> f32 {
    let offset = pixel - plume.base;
    let along = saturate(dot(offset, plume.axis) / max(dot(plume.axis, plume.axis), 1.0e-6));
    let aside = (offset - plume.axis * along) / (plume.radius * (1.0 + along));
    let inside = saturate(1.0 - dot(aside, aside));
    let behind = saturate((view_depth - plume.depth) / plume.thickness + 0.5);
    return inside * inside * (1.0 - along) * behind;
}

fn largest_shift(pixel: vec2f, view_depth: f32) -> f32 {
    var largest = 0.0;
    for (var i = 0u; i < haze.count; i++) {
        largest = max(largest, haze.plumes[i].shift * heat(haze.plumes[i], pixel, view_depth));
    }
    return largest;
}

fn random_value(cell: vec3i, octave: u32) -> vec2f {
    let random = pcg3d((vec3u(cell) & vec3u(PERIOD - 1u)) + vec3u(0u, 0u, octave * PERIOD));
    return vec2f(unit(random.x), unit(random.y)) * 2.0 - 1.0;
}

fn noise(at: vec3f, octave: u32) -> vec2f {
    let cell = vec3i(floor(at));
    let f = at - floor(at);
    let t = f * f * (3.0 - 2.0 * f);
    var layers: array<vec2f, 2>;
    for (var z = 0; z < 2; z++) {
        let upper = mix(random_value(cell + vec3i(0, 0, z), octave), random_value(cell + vec3i(1, 0, z), octave), t.x);
        let lower = mix(random_value(cell + vec3i(0, 1, z), octave), random_value(cell + vec3i(1, 1, z), octave), t.x);
        layers[z] = mix(upper, lower, t.y);
    }
    return mix(layers[0], layers[1], t.z);
}

fn direction(pixel: vec2f) -> vec2f {
    let at = vec3f(pixel / haze.cell, 0.0) + vec3f(0.0, haze.phase);
    return noise(at, 0u) + 0.5 * noise(at * vec3f(2.0, 2.0, 1.0), 1u);
}

fn bilinear(position: vec2f) -> vec3f {
    let corner = floor(position - 0.5);
    let t = position - 0.5 - corner;
    let at = vec2i(corner);
    let upper = mix(load_clamped(at), load_clamped(at + vec2i(1, 0)), t.x);
    let lower = mix(load_clamped(at + vec2i(0, 1)), load_clamped(at + vec2i(1, 1)), t.x);
    return mix(upper, lower, t.y);
}

fn view_depth_at(position: vec2f) -> f32 {
    let at = clamp(vec2i(floor(position)), vec2i(0), vec2i(textureDimensions(scene_depth)) - 1);
    return view_depth_from_ndc_depth(textureLoad(scene_depth, at, 0).r, haze.depth_coefficients);
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = position.xy;
    let texel = textureLoad(image, vec2i(pixel), 0);
    let shift = largest_shift(pixel, view_depth_at(pixel));
    if shift <= 0.0 {
        return texel;
    }
    let moved = pixel + direction(pixel) * shift;
    // Surfaces in front of the air are not seen through it.
    if largest_shift(pixel, view_depth_at(moved)) <= 0.0 {
        return texel;
    }
    return vec4f(bilinear(moved), texel.a);
}
