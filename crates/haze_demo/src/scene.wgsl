// demo scene
// What    Draws boxes with procedural materials: paint (reflectance and face, 2x2 samples per pixel), depth, then light.
//         scene_materials.wgsl is composed before this file, and the shadow of the smoke after it.
//         With shadow of smoke, the light of each light with shadow is kept apart, and a last pass adds what comes through
//         the smoke: only this pass is drawn while only the smoke moves.
// Reads   scene, boxes and lights (uniforms), occluder masks; the light pass also reads paint.
// Writes  paint, depth buffer and linear view depth, scene color (linear HDR).
// Blend   none.
// Source  Karis, "Tone mapping", 2013, for the weights of the samples.
// Space   world space, metres, y up. shading.rs implements the same functions on the CPU.

#import "lib/lighting.wgsl"
#import "lib/depth.wgsl"

struct Scene {
    clip_from_world: mat4x4f,
    eye: vec3f,
    box_count: u32,
    zenith: vec3f,
    light_count: u32,
    horizon: vec3f,
    padding0: f32,
    ground: vec3f,
    padding1: f32,
    // Vectors at view depth 1: camera_rays.rs.
    ray_forward: vec3f,
    padding2: f32,
    ray_right: vec3f,
    padding3: f32,
    ray_up: vec3f,
    padding4: f32,
    // Of the host's depth buffer, as in lib/depth.wgsl.
    depth_coefficients: vec4f,
    // Indices of the lights whose light is kept apart; 4294967295 for none.
    apart: vec4u,
}

@group(0) @binding(0) var<uniform> scene: Scene;
@group(0) @binding(1) var<uniform> boxes: array<Box, 96>;
@group(0) @binding(2) var<uniform> lights: array<Light, 128>;
// Bit masks of the boxes that can occlude the sky (list 0) or a light (from list 1 on), per grid cell:
// occluders.rs.
@group(0) @binding(3) var occluders: texture_2d<u32>;

const OCCLUDER_CELLS = vec3i(40, 8, 40);
const OCCLUDER_ORIGIN = vec3f(-20.0, -0.5, -24.0);
const AMBIENT_REACH: f32 = 0.7;
const SUN_DISTANCE: f32 = 60.0;
const SUN_SPREAD: f32 = 0.02;
const WIDEST_PIXEL: f32 = 0.1;
const LIGHT_GAP: f32 = 0.02;

fn to_local(b: Box, v: vec3f) -> vec3f {
    return vec3f(v.x * b.cosine + v.z * b.sine, v.y, v.z * b.cosine - v.x * b.sine);
}

fn to_world(b: Box, v: vec3f) -> vec3f {
    return vec3f(v.x * b.cosine - v.z * b.sine, v.y, v.z * b.cosine + v.x * b.sine);
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

// Index of the lowest bit that is set, from the exponent of its value: WebGL2 has no firstTrailingBit().
fn lowest_bit(bits: u32) -> u32 {
    return (bitcast<u32>(f32(bits & (~bits + 1u))) >> 23u) - 127u;
}

// Returns the visible fraction of a light of angular size `spread` (radius / distance). A ray that misses a box is
// dimmed by its angular distance to the box, which gives a penumbra from one ray. The penumbra is at least `pixel`
// metres wide.
fn light_visibility(mask: vec4u, origin: vec3f, direction: vec3f, distance: f32, spread: f32, pixel: f32) -> f32 {
    var visible = 1.0;
    for (var word = 0u; word < 3u; word++) {
        for (var bits = mask[word]; bits != 0u; bits &= bits - 1u) {
            let i = word * 32u + lowest_bit(bits);
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
            let i = word * 32u + lowest_bit(bits);
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

// Light, with that of up to three lights apart.
struct Lit {
    rest: vec3f,
    apart: array<vec3f, 3>,
}

fn lit_by(light: vec3f) -> Lit {
    return Lit(light, array<vec3f, 3>());
}

fn total(lit: Lit) -> vec3f {
    return lit.rest + lit.apart[0] + lit.apart[1] + lit.apart[2];
}

// Returns the light at a point of a box. `pixel` is the width of a pixel there, metres.
fn irradiance(world: vec3f, normal: vec3f, pixel: f32) -> Lit {
    let ambient = mix(scene.ground, mix(scene.horizon, scene.zenith, 0.5), normal.y * 0.5 + 0.5);
    var lit = lit_by(ambient * ambient_visibility(world, normal));
    let origin = world + normal * 2.0e-3;
    for (var i = 0u; i < scene.light_count; i++) {
        let sample = sample_light(lights[i], world);
        let facing = dot(normal, sample.direction);
        let is_lit = facing > 0.0 && sample.attenuation > 0.0;
        var distance = SUN_DISTANCE;
        var spread = SUN_SPREAD;
        if lights[i].directional < 0.5 {
            let to_light = length(lights[i].position - world);
            distance = to_light - LIGHT_GAP;
            spread = lights[i].radius / max(to_light, 0.1);
        }
        // An empty mask instead of a branch: llvmpipe executes both sides of a branch, but leaves a loop once no lane
        // is active.
        let boxes = select(vec4u(0u), boxes_at(i + 1u, world), is_lit);
        let visible = light_visibility(boxes, origin, sample.direction, distance, spread, min(pixel, WIDEST_PIXEL));
        let light = lights[i].color * (max(facing, 0.0) * sample.attenuation * visible);
        let is_apart = scene.apart == vec4u(i);
        lit.rest += select(light, vec3f(0.0), any(is_apart));
        lit.apart[0] += select(vec3f(0.0), light, is_apart.x);
        lit.apart[1] += select(vec3f(0.0), light, is_apart.y);
        lit.apart[2] += select(vec3f(0.0), light, is_apart.z);
    }
    return lit;
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
    var paint = b.color;
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

// Returns the vector from the eye to view depth 1. `uv` is 0..1, from the image's upper left corner.
fn ray_at_unit_depth(uv: vec2f) -> vec3f {
    return scene.ray_forward + scene.ray_right * (uv.x * 2.0 - 1.0) + scene.ray_up * (1.0 - uv.y * 2.0);
}

// Returns the direction of the ray through a position in the image, pixels.
fn ray_direction(place: vec2f) -> vec3f {
    return normalize(ray_at_unit_depth(place * 2.0 / vec2f(textureDimensions(paint))));
}

// Returns the point at which the ray meets the plane of a face.
fn point_on_face(b: Box, normal: vec3f, direction: vec3f) -> vec3f {
    let origin = to_local(b, scene.eye - b.centre);
    let distance = (dot(abs(normal), b.half_size) - dot(normal, origin)) / dot(normal, to_local(b, direction));
    return scene.eye + direction * distance;
}

// Averages four samples per pixel, weighted so that a single bright sample does not dominate an edge (Karis, "Tone
// mapping", 2013). Light is evaluated per sample if they lie on different faces, otherwise once at the pixel's centre.
fn light_at(position: vec2f) -> Lit {
    let first = vec2i(position) * 2;
    var paints = array<vec4f, 4>();
    for (var i = 0; i < 4; i++) {
        paints[i] = textureLoad(paint, first + vec2i(i & 1, i >> 1u), 0);
    }
    let pixel_angle = length(ray_direction(position + vec2f(0.0, 1.0)) - ray_direction(position));
    let is_one_face = paints[0].a == paints[1].a && paints[0].a == paints[2].a && paints[0].a == paints[3].a;
    var lit = array<Lit, 4>();
    for (var i = 0; i < select(4, 1, is_one_face); i++) {
        let offset = vec2f(vec2i(i & 1, i >> 1u)) * 0.5 - 0.25;
        let direction = ray_direction(position + select(offset, vec2f(0.0), is_one_face));
        let face = u32(max(paints[i].a, 0.0));
        let b = boxes[face / 6u];
        let normal = face_normal(face % 6u);
        lit[i] = lit_by(vec3f(1.0));
        if paints[i].a < 0.0 {
            lit[i] = lit_by(sky(direction));
        } else if b.surface != SURFACE_GLOW {
            let point = point_on_face(b, normal, direction);
            let world_normal = to_world(b, normal);
            let pixel = pixel_angle * length(point - scene.eye) / max(-dot(direction, world_normal), 1.0e-3);
            lit[i] = irradiance(point, world_normal, pixel);
        }
    }
    var sum: Lit;
    var weights = 0.0;
    for (var i = 0; i < 4; i++) {
        let reflectance = select(paints[i].rgb, vec3f(1.0), paints[i].a < 0.0);
        let light = lit[select(i, 0, is_one_face)];
        let color = reflectance * total(light);
        let weight = 1.0 / (1.0 + max(color.r, max(color.g, color.b)));
        sum.rest += reflectance * light.rest * weight;
        for (var slot = 0; slot < 3; slot++) {
            sum.apart[slot] += reflectance * light.apart[slot] * weight;
        }
        weights += weight;
    }
    sum.rest /= weights;
    for (var slot = 0; slot < 3; slot++) {
        sum.apart[slot] /= weights;
    }
    return sum;
}

@fragment
fn light_fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return vec4f(total(light_at(position.xy)), 1.0);
}

struct LightParts {
    @location(0) rest: vec4f,
    @location(1) first: vec4f,
    @location(2) second: vec4f,
    @location(3) third: vec4f,
}

@fragment
fn light_parts_fragment(@builtin(position) position: vec4f) -> LightParts {
    let lit = light_at(position.xy);
    return LightParts(
        vec4f(lit.rest, 1.0),
        vec4f(lit.apart[0], 1.0),
        vec4f(lit.apart[1], 1.0),
        vec4f(lit.apart[2], 1.0),
    );
}

@group(1) @binding(1) var rest: texture_2d<f32>;
@group(1) @binding(2) var first: texture_2d<f32>;
@group(1) @binding(3) var second: texture_2d<f32>;
@group(1) @binding(4) var third: texture_2d<f32>;
@group(1) @binding(5) var depth: texture_2d<f32>;

// Adds the light that comes through the smoke.
@fragment
fn shade_fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let at = vec2i(position.xy);
    var color = textureLoad(rest, at, 0).rgb;
    let view_depth = view_depth_from_ndc_depth(textureLoad(depth, at, 0).r, scene.depth_coefficients);
    let world = scene.eye + ray_at_unit_depth(position.xy / vec2f(textureDimensions(rest))) * view_depth;
    var through = array<vec3f, 3>(vec3f(1.0), vec3f(1.0), vec3f(1.0));
    if view_depth < SKY_VIEW_DEPTH {
        for (var slot = 0; slot < 3; slot++) {
            through[slot] = haze_transmittance(world, scene.apart[slot]);
        }
    }
    color += textureLoad(first, at, 0).rgb * through[0];
    color += textureLoad(second, at, 0).rgb * through[1];
    color += textureLoad(third, at, 0).rgb * through[2];
    return vec4f(color, 1.0);
}
