// accumulate
// What    Blends every sprite's normal and amount into the accumulation target.
// Reads   particles (instances, back to front), sprite flipbook, detail map or noise, reduced depth (or the host's own).
// Writes  accumulation target: rgb = sum of premultiplied normals, a = amount.
// Blend   ONE, ONE_MINUS_SRC_ALPHA: the normal is blended, the amount adds smoothly, A = 1 - product of (1 - a).
// Source  OTEE "Accumulating the particles"; techniques: NV, BLOG, MS.
// Space   Normals in view space. Depths in metres.

#import "lib/sprite_fragment.wgsl"

// Reduced depth, or the host's depth where HOST_DEPTH.
@group(3) @binding(0) var tested_depth: texture_2d<f32>;

override NORMAL_ENCODING: u32 = NORMAL_ENCODING_SIGNED;
override HOST_DEPTH: bool = false;
// Counts layers instead: every fragment that is shaded adds one.
override OVERDRAW: bool = false;

// One layer, in the smallest step of an 8-bit target.
const OVERDRAW_STEP: f32 = 1.0 / 255.0;

@vertex
fn vertex(particle: Particle, @builtin(vertex_index) index: u32) -> SpriteVertex {
    var out = sprite_vertex(particle, index, system.target_from_ndc, 1.0 / system.scale);
    // A hidden sprite stays outside the clip volume by its x.
    if !HOST_DEPTH {
        // Depth as the reduced target stores it.
        out.position.z = saturate(sprite_front(out.centre_radius) / system.depth_limit) * out.position.w;
    }
    return out;
}

@fragment
fn fragment(in: SpriteVertex) -> @location(0) vec4f {
    var scene = SKY_VIEW_DEPTH;
    if reads_scene() {
        scene = textureLoad(tested_depth, vec2i(in.position.xy), 0).r;
        if HOST_DEPTH {
            scene = host_view_depth(scene);
        } else {
            scene *= system.depth_limit;
        }
    }
    let fragment = technique_fragment(in, scene);
    if fragment.hidden && (OVERDRAW || !DEPTH_TESTED) {
        discard;
    }
    if OVERDRAW {
        return vec4f(OVERDRAW_STEP);
    }
    return accumulation_from_normal(NORMAL_ENCODING, fragment.normal, fragment.amount);
}
