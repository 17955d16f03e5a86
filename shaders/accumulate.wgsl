// accumulate
// What    Blends every sprite's normal and amount into the accumulation target.
// Reads   particles (instances, back to front), sprite flipbook, reduced depth (or the host's own).
// Writes  accumulation target: rgb = sum of premultiplied normals, a = amount.
// Blend   ONE, ONE_MINUS_SRC_ALPHA: the normal is blended, the amount adds smoothly, A = 1 - product of (1 - a).
// Source  OTEE "Accumulating the particles"; soft fade: NV, BLOG.
// Space   Normals in view space. Depths in metres.

#import "lib/sprite_vertex.wgsl"
#import "lib/depth.wgsl"

// Reduced depth, or the host's depth where HOST_DEPTH. The same may be attached, for the hardware to test.
@group(3) @binding(0) var tested_depth: texture_2d<f32>;

override FADE_CURVE: u32 = FADE_CURVE_SMOOTHSTEP;
override NORMAL_ENCODING: u32 = NORMAL_ENCODING_SIGNED;
override HOST_DEPTH: bool = false;
// Counts layers instead: every fragment that is shaded adds one.
override OVERDRAW: bool = false;

// One layer, in the smallest step of an 8-bit target.
const OVERDRAW_STEP: f32 = 1.0 / 255.0;

@vertex
fn vertex(particle: Particle, @builtin(vertex_index) index: u32) -> SpriteVertex {
    var out = sprite_vertex(particle, index, system.target_from_ndc, 1.0 / system.scale);
    if !HOST_DEPTH {
        // Depth as the reduced target stores it. A hidden sprite stays outside the clip volume by its x.
        out.position.z = out.depth_amount_lod_frame.x / system.depth_limit * out.position.w;
    }
    return out;
}

@fragment
fn fragment(in: SpriteVertex) -> @location(0) vec4f {
    var scene = textureLoad(tested_depth, vec2i(in.position.xy), 0).r;
    if HOST_DEPTH {
        scene = view_depth_from_ndc_depth(scene, view.depth_coefficients);
    } else {
        scene *= system.depth_limit;
    }
    let distance = scene - in.depth_amount_lod_frame.x;
    let fade = soft_fade(FADE_CURVE, distance, system.fade_scale, system.contrast_power, system.epsilon);
    if fade <= 0.0 {
        discard;
    }
    if OVERDRAW {
        return vec4f(OVERDRAW_STEP);
    }
    let fragment = sprite_fragment(in);
    return accumulation_from_normal(NORMAL_ENCODING, fragment.xyz, fragment.w * fade);
}
