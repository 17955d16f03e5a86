// accumulate: blends the normal and the amount of every sprite into the accumulation target.
// Reads   particles (instances; sorted: back to front), sprite flipbook, detail map or noise, reduced depth (or the
//         host's own).
// Writes  accumulation target: rgb = sum of premultiplied normals, or light from right, top and front if SIX_WAY;
//         a = amount; and the other textures of lib/attachments.wgsl that the system has.
// Blend   sorted: ONE, ONE_MINUS_SRC_ALPHA: normals are blended, amounts add smoothly, A = 1 - product of (1 - a).
//         weighted: ONE, ONE for normals, amounts as for sorted.
// Source  OTEE "Accumulating the particles"; techniques: NV, BLOG, MS.
// Space   Normals in view space. Depths in metres.

#import "lib/sprite_fragment.wgsl"
#import "lib/order.wgsl"

// Reduced depth, or the host's depth if HOST_DEPTH.
@group(3) @binding(0) var tested_depth: texture_2d<f32>;

override NORMAL_ENCODING: u32 = NORMAL_ENCODING_SIGNED;
override HOST_DEPTH: bool = false;
// True: sprites are drawn in any order, with weighted normals.
override WEIGHTED: bool = false;
// True: counts layers instead. Every shaded fragment adds one.
override OVERDRAW: bool = false;

// One layer: the smallest step of an 8-bit target.
const OVERDRAW_STEP: f32 = 1.0 / 255.0;

@vertex
fn vertex(
    particle: Particle,
    @builtin(instance_index) index: u32,
    @builtin(vertex_index) corner: u32,
) -> SpriteVertex {
    var out = sprite_vertex(particle, index, corner, system.target_from_ndc, 1.0 / f32(system.scale));
    // The x of a hidden sprite keeps it outside the clip volume.
    if !HOST_DEPTH {
        // Depth in the units of the reduced target.
        out.position.z = saturate(sprite_front(out.center_radius) / system.depth_limit) * out.position.w;
    }
    if WEIGHTED {
        let view_depth = -out.center_radius.z;
        let in_front = optical_depth_in_front(system.optical_depth_knots, view_depth, system.smoke_near, system.smoke_far);
        out.weight = order_weight(system.depth_weight, in_front);
    }
    return out;
}

// One output per texture of the target. Those that the system does not have are not written.
struct Accumulated {
    @location(0) texture_0: vec4f,
    @location(1) texture_1: vec4f,
    @location(2) texture_2: vec4f,
    @location(3) texture_3: vec4f,
}

fn accumulated_from(normal_and_amount: vec4f, attachments: Attachments) -> Accumulated {
    let slots = slots_from_attachments(normal_and_amount, attachments);
    return Accumulated(slots[0], slots[1], slots[2], slots[3]);
}

@fragment
fn fragment(in: SpriteVertex) -> Accumulated {
    var scene = SKY_VIEW_DEPTH;
    if reads_scene() {
        scene = textureLoad(tested_depth, vec2i(in.position.xy), 0).r;
        if HOST_DEPTH {
            scene = host_view_depth(scene);
        } else {
            scene *= system.depth_limit;
        }
    }
    let fragment = technique_fragment(in, fragment_frames(in), scene);
    if fragment.hidden && (OVERDRAW || !DEPTH_TESTED) {
        discard;
    }
    if OVERDRAW {
        var none: Attachments;
        return accumulated_from(vec4f(OVERDRAW_STEP), none);
    }
    let weight = fragment.amount * in.weight;
    // The stretch comes with the vertex.
    let values = SpriteValues(in.depths_and_heat, in.tint, 0u);
    let attachments = attachments_from_fragment(fragment, weight, values, in.center_radius);
    if SIX_WAY {
        // Saves blending two targets: six of ten texels of a sprite are clear.
        if fragment.amount <= 0.0 {
            discard;
        }
        return accumulated_from(vec4f(fragment.six_way.positive * weight, fragment.amount), attachments);
    }
    let accumulated = accumulation_from_normal(NORMAL_ENCODING, fragment.normal, fragment.amount, in.weight);
    return accumulated_from(accumulated, attachments);
}
