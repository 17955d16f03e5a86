// Boxes of the demo scene and their procedural materials, composed before scene.wgsl. shading.rs implements the same
// functions on the CPU.

struct Box {
    center: vec3f,
    // Rotation about the vertical axis.
    cosine: f32,
    half_size: vec3f,
    sine: f32,
    color: vec3f,
    surface: u32,
}

const SURFACE_SLABS: u32 = 1u;
const SURFACE_BRICK: u32 = 2u;
const SURFACE_WOOD: u32 = 3u;
const SURFACE_PLASTER: u32 = 4u;
const SURFACE_GLOW: u32 = 5u;
const SURFACE_EVEN: u32 = 6u;

fn hash(at: vec3i) -> f32 {
    var v = vec3u(at) * 1664525u + 1013904223u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v = v ^ (v >> vec3u(16u));
    v.x += v.y * v.z;
    return f32(v.x >> 8u) * (1.0 / 16777216.0);
}

// Returns 0..1.
fn value_noise(p: vec3f) -> f32 {
    let cell = floor(p);
    let f = p - cell;
    let w = f * f * (3.0 - 2.0 * f);
    let i = vec3i(cell);
    let low = mix(
        mix(hash(i), hash(i + vec3i(1, 0, 0)), w.x),
        mix(hash(i + vec3i(0, 1, 0)), hash(i + vec3i(1, 1, 0)), w.x),
        w.y,
    );
    let high = mix(
        mix(hash(i + vec3i(0, 0, 1)), hash(i + vec3i(1, 0, 1)), w.x),
        mix(hash(i + vec3i(0, 1, 1)), hash(i + vec3i(1, 1, 1)), w.x),
        w.y,
    );
    return mix(low, high, w.z);
}

fn stains(p: vec3f) -> f32 {
    return value_noise(p * 0.7) * 0.5 + value_noise(p * 2.3) * 0.3 + value_noise(p * 9.1) * 0.2;
}

// Returns 0 on a joint between tiles of `size`, 1 on a tile.
fn joints(uv: vec2f, size: vec2f, width: f32) -> f32 {
    let from_edge = (0.5 - abs(fract(uv / size) - 0.5)) * size;
    return smoothstep(0.0, width, min(from_edge.x, from_edge.y));
}

// Returns the reflectance at a point of a box. `p` and `n` are in the box's frame; `world` makes stains differ between
// boxes.
fn albedo(b: Box, p: vec3f, n: vec3f, world: vec3f) -> vec3f {
    var uv = p.xy;
    if abs(n.x) > 0.5 { uv = p.zy; }
    if abs(n.y) > 0.5 { uv = p.xz; }
    let dirt = stains(world);
    if b.surface == SURFACE_SLABS {
        let size = vec2f(1.6, 1.6);
        let tile = floor(uv / size);
        let tone = 0.85 + 0.3 * hash(vec3i(vec2i(tile), 5));
        return b.color * tone * (0.55 + 0.7 * dirt) * mix(0.45, 1.0, joints(uv, size, 0.035));
    }
    if b.surface == SURFACE_BRICK {
        let size = vec2f(0.48, 0.17);
        let row = floor(uv.y / size.y);
        let shifted = vec2f(uv.x + row * 0.5 * size.x, uv.y);
        let tile = vec3i(vec3f(floor(shifted / size), n.x * 3.0 + n.z));
        let tone = 0.7 + 0.6 * hash(tile);
        let tint = mix(vec3f(1.0), vec3f(1.15, 0.92, 0.8), hash(tile + vec3i(7, 3, 1)));
        let brick = b.color * tone * tint * (0.6 + 0.6 * dirt);
        return mix(vec3f(0.16, 0.155, 0.15) * (0.6 + 0.6 * dirt), brick, joints(shifted, size, 0.02));
    }
    if b.surface == SURFACE_WOOD {
        let plank = floor(uv.y / 0.2);
        let grain = value_noise(vec3f(uv.x * 2.0, uv.y * 40.0, plank * 7.0 + b.center.x * 3.0));
        let tone = 0.8 + 0.4 * hash(vec3i(i32(plank), i32(b.center.x * 10.0), i32(b.center.z * 10.0)));
        // A frame of boards around every face of a crate.
        var edge = b.half_size - abs(p);
        edge = select(edge, vec3f(10.0), abs(n) > vec3f(0.5));
        let framed = smoothstep(0.09, 0.075, min(edge.x, min(edge.y, edge.z)));
        let boards = tone * mix(0.5, 1.0, joints(vec2f(25.0, uv.y), vec2f(50.0, 0.2), 0.015));
        return b.color * mix(boards, 1.15, framed) * (0.7 + 0.4 * grain) * (0.75 + 0.4 * dirt);
    }
    if b.surface == SURFACE_PLASTER {
        let damp = smoothstep(0.0, 1.2, world.y + dirt * 0.8 - 0.3);
        return b.color * (0.6 + 0.55 * dirt) * mix(0.6, 1.0, damp);
    }
    return b.color * (0.8 + 0.4 * dirt);
}
