// demo scene What    Draws boxes with procedural materials: paint (reflectance and face, 2x2 samples per pixel), depth,
// then light. Reads   scene, boxes and lights (uniforms), occluder masks; the light pass also reads paint. Writes
// paint, depth buffer and linear view depth, scene colour (linear HDR). Blend   none. Source  Karis, "Tone mapping",
// 2013, for the weights of the samples. Space   World space, metres, y up. src/demo/shading.rs implements the same
// functions on the CPU.

#import "lib/lighting.wgsl"

struct Box {
    centre: vec3f,
    // Rotation about the vertical axis.
    cosine: f32,
    half_size: vec3f,
    sine: f32,
    colour: vec3f,
    surface: u32,
}

struct Scene {
    clip_from_world: mat4x4f,
    world_from_clip: mat4x4f,
    eye: vec3f,
    box_count: u32,
    zenith: vec3f,
    light_count: u32,
    horizon: vec3f,
    padding0: f32,
    ground: vec3f,
    padding1: f32,
}

@group(0) @binding(0) var<uniform> scene: Scene;
@group(0) @binding(1) var<uniform> boxes: array<Box, 96>;
@group(0) @binding(2) var<uniform> lights: array<Light, 128>;
// Bit masks of the boxes that can occlude the sky (list 0) or a light (from list 1 on), per grid cell:
// src/demo/occluders.rs.
@group(0) @binding(3) var occluders: texture_2d<u32>;

const OCCLUDER_CELLS = vec3i(40, 8, 40);
const OCCLUDER_ORIGIN = vec3f(-20.0, -0.5, -24.0);
const AMBIENT_REACH: f32 = 0.7;
const SUN_DISTANCE: f32 = 60.0;
const SUN_SPREAD: f32 = 0.02;
const WIDEST_PIXEL: f32 = 0.1;

const SURFACE_SLABS: u32 = 1u;
const SURFACE_BRICK: u32 = 2u;
const SURFACE_WOOD: u32 = 3u;
const SURFACE_PLASTER: u32 = 4u;
const SURFACE_GLOW: u32 = 5u;
const SURFACE_EVEN: u32 = 6u;

fn to_local(b: Box, v: vec3f) -> vec3f {
    return vec3f(v.x * b.cosine + v.z * b.sine, v.y, v.z * b.cosine - v.x * b.sine);
}

fn to_world(b: Box, v: vec3f) -> vec3f {
    return vec3f(v.x * b.cosine - v.z * b.sine, v.y, v.z * b.cosine + v.x * b.sine);
}

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
        return b.colour * tone * (0.55 + 0.7 * dirt) * mix(0.45, 1.0, joints(uv, size, 0.035));
    }
    if b.surface == SURFACE_BRICK {
        let size = vec2f(0.48, 0.17);
        let row = floor(uv.y / size.y);
        let shifted = vec2f(uv.x + row * 0.5 * size.x, uv.y);
        let tile = vec3i(vec3f(floor(shifted / size), n.x * 3.0 + n.z));
        let tone = 0.7 + 0.6 * hash(tile);
        let tint = mix(vec3f(1.0), vec3f(1.15, 0.92, 0.8), hash(tile + vec3i(7, 3, 1)));
        let brick = b.colour * tone * tint * (0.6 + 0.6 * dirt);
        return mix(vec3f(0.16, 0.155, 0.15) * (0.6 + 0.6 * dirt), brick, joints(shifted, size, 0.02));
    }
    if b.surface == SURFACE_WOOD {
        let plank = floor(uv.y / 0.2);
        let grain = value_noise(vec3f(uv.x * 2.0, uv.y * 40.0, plank * 7.0 + b.centre.x * 3.0));
        let tone = 0.8 + 0.4 * hash(vec3i(i32(plank), i32(b.centre.x * 10.0), i32(b.centre.z * 10.0)));
        // A frame of boards around every face of a crate.
        var edge = b.half_size - abs(p);
        edge = select(edge, vec3f(10.0), abs(n) > vec3f(0.5));
        let framed = smoothstep(0.09, 0.075, min(edge.x, min(edge.y, edge.z)));
        let boards = tone * mix(0.5, 1.0, joints(vec2f(25.0, uv.y), vec2f(50.0, 0.2), 0.015));
        return b.colour * mix(boards, 1.15, framed) * (0.7 + 0.4 * grain) * (0.75 + 0.4 * dirt);
    }
    if b.surface == SURFACE_PLASTER {
        let damp = smoothstep(0.0, 1.2, world.y + dirt * 0.8 - 0.3);
        return b.colour * (0.6 + 0.55 * dirt) * mix(0.6, 1.0, damp);
    }
    return b.colour * (0.8 + 0.4 * dirt);
}

// Returns the distances at which a ray, in the box's frame, enters and leaves the box. Enter > leave on a miss.
fn box_interval(b: Box, origin: vec3f, direction: vec3f) -> vec2f {
    let inverse = 1.0 / select(direction, vec3f(1.0e-6), abs(direction) < vec3f(1.0e-6));
    let middle = -origin * inverse;
    let reach = abs(inverse) * b.half_size;
    let enter = middle - reach;
    let leave = middle + reach;
    return vec2f(max(enter.x, max(enter.y, enter.z)), min(leave.x, min(leave.y, leave.z)));
}

fn box_distance(b: Box, p: vec3f) -> f32 {
    let q = abs(p) - b.half_size;
    return length(max(q, vec3f(0.0))) + min(max(q.x, max(q.y, q.z)), 0.0);
}

// Returns the mask of potential occluders of a point. Cells are one metre wide.
fn boxes_at(list: u32, point: vec3f) -> vec4u {
    let cell = vec3i(floor(point - OCCLUDER_ORIGIN));
    if any(cell < vec3i(0)) || any(cell >= OCCLUDER_CELLS) {
        return vec4u(0xffffffffu);
    }
    let at = vec2i(cell.x + cell.z * OCCLUDER_CELLS.x, i32(list) * OCCLUDER_CELLS.y + cell.y);
    return textureLoad(occluders, at, 0);
}

// Returns the visible fraction of a light of angular size `spread` (radius / distance). A ray that misses a box is
// dimmed by its angular distance to the box, which gives a penumbra from one ray. The penumbra is at least `pixel`
// metres wide.
fn light_visibility(mask: vec4u, origin: vec3f, direction: vec3f, distance: f32, spread: f32, pixel: f32) -> f32 {
    var visible = 1.0;
    for (var word = 0u; word < 3u; word++) {
        for (var bits = mask[word]; bits != 0u; bits &= bits - 1u) {
            let i = word * 32u + firstTrailingBit(bits);
            if i >= scene.box_count { break; }
            let b = boxes[i];
            if b.surface == SURFACE_GLOW { continue; }
            let o = to_local(b, origin - b.centre);
            let d = to_local(b, direction);
            let interval = box_interval(b, o, d);
            if interval.x < interval.y {
                if interval.y > 0.0 && interval.x < distance { return 0.0; }
                continue;
            }
            // Approximates the closest approach by the two ends of this interval. Ends behind the origin do not count.
            let places = min(interval, vec2f(distance));
            for (var end = 0; end < 2; end++) {
                let place = places[end];
                let gap = box_distance(b, o + d * place) / max(place * spread, pixel);
                visible = select(visible, min(visible, gap), place > 0.0);
            }
        }
    }
    return smoothstep(0.0, 1.0, visible);
}

// Returns the unoccluded fraction of the sky over a point, from the boxes' distance to two points along the normal.
fn ambient_visibility(p: vec3f, n: vec3f) -> f32 {
    let near = p + n * 0.15;
    let far = p + n * AMBIENT_REACH;
    var open_near = 0.15;
    var open_far = AMBIENT_REACH;
    let mask = boxes_at(0u, p);
    for (var word = 0u; word < 3u; word++) {
        for (var bits = mask[word]; bits != 0u; bits &= bits - 1u) {
            let i = word * 32u + firstTrailingBit(bits);
            if i >= scene.box_count { break; }
            let b = boxes[i];
            open_near = min(open_near, box_distance(b, to_local(b, near - b.centre)));
            open_far = min(open_far, box_distance(b, to_local(b, far - b.centre)));
        }
    }
    return mix(0.25, 1.0, saturate(open_near / 0.15)) * mix(0.35, 1.0, saturate(open_far / AMBIENT_REACH));
}

fn sky(direction: vec3f) -> vec3f {
    let up = saturate(direction.y);
    return mix(scene.horizon, scene.zenith, 1.0 - pow(1.0 - up, 3.0));
}

// Returns the light at a point of a box. `pixel` is the width of a pixel there, metres.
fn irradiance(world: vec3f, normal: vec3f, pixel: f32) -> vec3f {
    let ambient = mix(scene.ground, mix(scene.horizon, scene.zenith, 0.5), normal.y * 0.5 + 0.5);
    var light = ambient * ambient_visibility(world, normal);
    let origin = world + normal * 2.0e-3;
    for (var i = 0u; i < scene.light_count; i++) {
        let sample = sample_light(lights[i], world);
        let facing = dot(normal, sample.direction);
        let is_lit = facing > 0.0 && sample.attenuation > 0.0;
        var distance = SUN_DISTANCE;
        var spread = SUN_SPREAD;
        if lights[i].directional < 0.5 {
            distance = length(lights[i].position - world);
            spread = lights[i].radius / max(distance, 0.1);
        }
        // An empty mask instead of a branch: llvmpipe executes both sides of a branch, but leaves a loop once no lane
        // is active.
        let boxes = select(vec4u(0u), boxes_at(i + 1u, world), is_lit);
        let visible = light_visibility(boxes, origin, sample.direction, distance, spread, min(pixel, WIDEST_PIXEL));
        light += lights[i].colour * (max(facing, 0.0) * sample.attenuation * visible);
    }
    return light;
}

// A face's normal is along axis face / 2, negative if face is even.
fn face_normal(face: u32) -> vec3f {
    let sign = f32(face & 1u) * 2.0 - 1.0;
    return select(vec3f(0.0), vec3f(sign), vec3<bool>(face / 2u == 0u, face / 2u == 1u, face / 2u == 2u));
}

struct BoxVertex {
    @builtin(position) position: vec4f,
    @location(0) world: vec3f,
    @location(1) local: vec3f,
    @location(2) @interpolate(flat, either) local_normal: vec3f,
    // Box index * 6 + face of the box.
    @location(3) @interpolate(flat, either) face: u32,
}

// Draws 36 vertices per instance: six faces of two triangles.
@vertex
fn box_vertex(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> BoxVertex {
    // Reverse order: small boxes come last in the list and are drawn first, so the depth test skips what they hide.
    let index = scene.box_count - 1u - instance;
    let b = boxes[index];
    let face = vertex / 6u;
    var places = array<u32, 6>(0u, 1u, 2u, 2u, 1u, 3u);
    let place = places[vertex % 6u];
    let u = f32(place & 1u) * 2.0 - 1.0;
    let v = f32((place >> 1u) & 1u) * 2.0 - 1.0;
    let normal = face_normal(face);
    var local = normal + vec3f(0.0, u, v);
    if face / 2u == 1u {
        local = normal + vec3f(v, 0.0, u);
    } else if face / 2u == 2u {
        local = normal + vec3f(u, v, 0.0);
    }
    local *= b.half_size;
    let world = b.centre + to_world(b, local);
    return BoxVertex(scene.clip_from_world * vec4f(world, 1.0), world, local, normal, index * 6u + face);
}

// Writes reflectance (radiance of emissive boxes) and the face, at twice the size of the image. Cleared to NOTHING.
@fragment
fn paint_fragment(in: BoxVertex) -> @location(0) vec4f {
    let b = boxes[in.face / 6u];
    var paint = b.colour;
    if b.surface != SURFACE_GLOW && b.surface != SURFACE_EVEN {
        paint = albedo(b, in.local, in.local_normal, in.world);
    }
    return vec4f(paint, f32(in.face));
}

// Writes view depth, metres: w of a perspective projection.
@fragment
fn linear_fragment(in: BoxVertex) -> @location(0) vec4f {
    return vec4f((scene.clip_from_world * vec4f(in.world, 1.0)).w, 0.0, 0.0, 1.0);
}

@vertex
fn fullscreen_vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@group(1) @binding(0) var paint: texture_2d<f32>;

// Alpha of paint without a box.
const NO_BOX: f32 = -1.0;

// Returns the direction of the ray through a position in the image, pixels.
fn ray_direction(place: vec2f) -> vec3f {
    let uv = place * 2.0 / vec2f(textureDimensions(paint));
    let far = scene.world_from_clip * vec4f(uv.x * 2.0 - 1.0, 1.0 - uv.y * 2.0, 1.0, 1.0);
    return normalize(far.xyz / far.w - scene.eye);
}

// Returns the point at which the ray meets the plane of a face.
fn point_on_face(b: Box, normal: vec3f, direction: vec3f) -> vec3f {
    let origin = to_local(b, scene.eye - b.centre);
    let distance = (dot(abs(normal), b.half_size) - dot(normal, origin)) / dot(normal, to_local(b, direction));
    return scene.eye + direction * distance;
}

// Averages four samples per pixel, weighted so that a single bright sample does not dominate an edge (Karis, "Tone
// mapping", 2013). Light is evaluated per sample if they lie on different faces, otherwise once at the pixel's centre.
@fragment
fn light_fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let first = vec2i(position.xy) * 2;
    var paints = array<vec4f, 4>();
    for (var i = 0; i < 4; i++) {
        paints[i] = textureLoad(paint, first + vec2i(i & 1, i >> 1u), 0);
    }
    let pixel_angle = length(ray_direction(position.xy + vec2f(0.0, 1.0)) - ray_direction(position.xy));
    let is_one_face = paints[0].a == paints[1].a && paints[0].a == paints[2].a && paints[0].a == paints[3].a;
    var lit = array<vec3f, 4>();
    for (var i = 0; i < select(4, 1, is_one_face); i++) {
        let offset = vec2f(vec2i(i & 1, i >> 1u)) * 0.5 - 0.25;
        let direction = ray_direction(position.xy + select(offset, vec2f(0.0), is_one_face));
        let face = u32(max(paints[i].a, 0.0));
        let b = boxes[face / 6u];
        let normal = face_normal(face % 6u);
        lit[i] = vec3f(1.0);
        if paints[i].a < 0.0 {
            lit[i] = sky(direction);
        } else if b.surface != SURFACE_GLOW {
            let point = point_on_face(b, normal, direction);
            let world_normal = to_world(b, normal);
            let pixel = pixel_angle * length(point - scene.eye) / max(-dot(direction, world_normal), 1.0e-3);
            lit[i] = irradiance(point, world_normal, pixel);
        }
    }
    var sum = vec3f(0.0);
    var weights = 0.0;
    for (var i = 0; i < 4; i++) {
        let reflectance = select(paints[i].rgb, vec3f(1.0), paints[i].a < 0.0);
        let colour = reflectance * lit[select(i, 0, is_one_face)];
        let weight = 1.0 / (1.0 + max(colour.r, max(colour.g, colour.b)));
        sum += colour * weight;
        weights += weight;
    }
    return vec4f(sum / weights, 1.0);
}
