// demo scene: boxes
// What    Boxes with procedural materials, of scene.wgsl. scene_materials.wgsl is composed before this file, and the shadow
//         of the smoke after it.
// Reads   boxes (uniforms) and masks of occluders, in addition to scene.wgsl.
// Writes  paint: alpha is box index * 6 + face of the box.

@group(0) @binding(1) var<uniform> boxes: array<Box, 96>;
// Bit masks of the boxes that can occlude the sky (list 0) or a light (from list 1 on), per grid cell:
// occluders.rs.
@group(0) @binding(3) var occluders: texture_2d<u32>;

const OCCLUDER_CELLS = vec3i(40, 8, 40);
const OCCLUDER_ORIGIN = vec3f(-20.0, -0.5, -24.0);
const AMBIENT_REACH: f32 = 0.7;
const SUN_SPREAD: f32 = 0.02;
const WIDEST_PIXEL: f32 = 0.1;
const UNDERSIDE_GAP: f32 = 1.0e-4;
const UNDERSIDE: u32 = 2u;

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
            let o = to_local(b, origin - b.center);
            let d = to_local(b, direction);
            let interval = box_interval(b, o, d);
            if interval.x < interval.y {
                if interval.y > 0.0 && interval.x < distance { return 0.0; }
                continue;
            }
            // Approximates the closest approach by the two ends of this interval. Ends behind the origin do not count.
            let positions = min(interval, vec2f(distance));
            for (var end = 0; end < 2; end++) {
                let position = positions[end];
                let gap = box_distance(b, o + d * position) / max(position * spread, pixel);
                visible = select(visible, min(visible, gap), position > 0.0);
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
            open_near = min(open_near, box_distance(b, to_local(b, near - b.center)));
            open_far = min(open_far, box_distance(b, to_local(b, far - b.center)));
        }
    }
    return mix(0.25, 1.0, saturate(open_near / 0.15)) * mix(0.35, 1.0, saturate(open_far / AMBIENT_REACH));
}

// Returns the light at a point of a box. `pixel` is the width of a pixel there, metres.
fn irradiance(world: vec3f, normal: vec3f, pixel: f32) -> Lit {
    var lit = lit_by(ambient_light(normal) * ambient_visibility(world, normal));
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
        lit = add_light(lit, i, lights[i].color * (max(facing, 0.0) * sample.attenuation * visible));
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

// True if the underside lies in the plane of the ground's surface. It is not drawn.
fn stands_on_ground(b: Box) -> bool {
    return abs(b.center.y - b.half_size.y) < UNDERSIDE_GAP;
}

// Draws 36 vertices per instance: six faces of two triangles.
@vertex
fn box_vertex(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> BoxVertex {
    // Reverse order: small boxes come last in the list and are drawn first, so the depth test skips what they hide.
    let index = scene.box_count - 1u - instance;
    let b = boxes[index];
    let face = vertex / 6u;
    var positions = array<u32, 6>(0u, 1u, 2u, 2u, 1u, 3u);
    let place = positions[vertex % 6u];
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
    let world = b.center + to_world(b, local);
    // One point: no triangle is left.
    let is_drawn = face != UNDERSIDE || !stands_on_ground(b);
    let position = select(vec4f(0.0, 0.0, 0.0, 1.0), scene.clip_from_world * vec4f(world, 1.0), is_drawn);
    return BoxVertex(position, world, local, normal, index * 6u + face);
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

// Returns the point at which the ray meets the plane of a face.
fn point_on_face(b: Box, normal: vec3f, direction: vec3f) -> vec3f {
    let origin = to_local(b, scene.eye - b.center);
    let distance = (dot(abs(normal), b.half_size) - dot(normal, origin)) / dot(normal, to_local(b, direction));
    return scene.eye + direction * distance;
}

// Light of a group of samples. It is evaluated per sample if the pixel's lie on different faces, otherwise once at its center.
fn light_at(position: vec2f, is_in_group: vec4<bool>) -> Lit {
    let first = vec2i(position) * 2;
    var paints = array<vec4f, 4>();
    for (var i = 0; i < 4; i++) {
        paints[i] = textureLoad(paint, first + vec2i(i & 1, i >> 1u), 0);
    }
    let pixel_angle = length(ray_direction(position + vec2f(0.0, 1.0)) - ray_direction(position));
    let is_one_face = paints[0].a == paints[1].a && paints[0].a == paints[2].a && paints[0].a == paints[3].a;
    var lit = array<Lit, 4>();
    for (var i = 0; i < select(4, 1, is_one_face); i++) {
        if !is_one_face && !is_in_group[i] {
            continue;
        }
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
    if is_one_face {
        lit[1] = lit[0];
        lit[2] = lit[0];
        lit[3] = lit[0];
    }
    return average(paints, lit, is_in_group);
}
