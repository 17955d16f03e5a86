// bloom
// What    Spreads light around bright areas, as a lens does: a pyramid of ever coarser levels, added up from the coarsest.
// Reads   a level, or the image.
// Writes  the level after it; on the way back the level before it, at last the image.
// Blend   none; on the way back by a constant, so that no light is lost.
// Source  Jimenez, "Next generation post processing in Call of Duty: Advanced Warfare", 2014: the pyramid.
// Space   texels of the target.

@group(0) @binding(0) var level: texture_2d<f32>;

// Brightest light that spreads: half floats end not far above.
const BRIGHTEST: f32 = 6.0e4;

fn light_at(at: vec2i) -> vec3f {
    let last = vec2i(textureDimensions(level)) - 1;
    return clamp(textureLoad(level, clamp(at, vec2i(0), last), 0).rgb, vec3f(0.0), vec3f(BRIGHTEST));
}

// Texel of a level half the size: sixteen texels around its middle, weighted 1 3 3 1 along both axes.
fn halved(at: vec2i) -> vec3f {
    let weights = vec4f(1.0, 3.0, 3.0, 1.0) / 8.0;
    var sum = vec3f(0.0);
    for (var y = 0; y < 4; y++) {
        for (var x = 0; x < 4; x++) {
            sum += light_at(2 * at + vec2i(x, y) - 1) * (weights[x] * weights[y]);
        }
    }
    return sum;
}

// Texel of a level twice the size: bilinear between the four nearest.
fn doubled(at: vec2i) -> vec3f {
    let nearest = at / 2;
    let aside = (at & vec2i(1)) * 2 - 1;
    let row = light_at(nearest) * 3.0 + light_at(nearest + vec2i(aside.x, 0));
    let next_row = light_at(nearest + vec2i(0, aside.y)) * 3.0 + light_at(nearest + aside);
    return (row * 3.0 + next_row) / 16.0;
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(vec2f(vec2u(index & 1u, index >> 1u)) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn halve_fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return vec4f(halved(vec2i(position.xy)), 1.0);
}

@fragment
fn double_fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return vec4f(doubled(vec2i(position.xy)), 1.0);
}
