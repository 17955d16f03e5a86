// forward
// What    The classic way: every sprite fragment lit and blended at full resolution. The baseline of every comparison.
// Reads   particles (instances, back to front), sprite flipbook, scene depth, lights, ramps.
// Writes  the host's colour target, linear HDR.
// Blend   alpha: ONE, ONE_MINUS_SRC_ALPHA (premultiplied) · additive: ONE, ONE · multiply: DST, ZERO.
// Source  OTEE "Typical game particles so far"; soft fade: NV, BLOG.

#import "lib/sprite_vertex.wgsl"
#import "lib/diffuse.wgsl"
#import "lib/depth.wgsl"

override FADE_CURVE: u32 = FADE_CURVE_SMOOTHSTEP;

const BLEND_MODE_ALPHA: u32 = 0u;
const BLEND_MODE_ADDITIVE: u32 = 1u;
const BLEND_MODE_MULTIPLY: u32 = 2u;
override BLEND_MODE: u32 = BLEND_MODE_ALPHA;

@vertex
fn vertex(particle: Particle, @builtin(vertex_index) index: u32) -> SpriteVertex {
    return sprite_vertex(particle, index, vec4f(1.0, 1.0, 0.0, 0.0), 1.0);
}

@fragment
fn fragment(in: SpriteVertex) -> @location(0) vec4f {
    let ndc_depth = textureLoad(scene_depth, vec2i(in.position.xy), 0).r;
    let distance = view_depth_from_ndc_depth(ndc_depth, view.depth_coefficients) - in.depth_amount_lod_frame.x;
    let fade = soft_fade(FADE_CURVE, distance, system.fade_scale, system.contrast_power, system.epsilon);
    if fade <= 0.0 {
        discard;
    }
    let fragment = sprite_fragment(in);
    let amount = fragment.w * fade;
    if amount <= 0.0 {
        discard;
    }
    let normal = fragment.xyz * inverseSqrt(max(dot(fragment.xyz, fragment.xyz), 1.0e-12));
    let light = diffuse_from_lights(normal, in.view_position) * system.diffuse_intensity + soft_scatter(amount);
    let covered = coverage(amount, system.boost);
    switch BLEND_MODE {
        case BLEND_MODE_ADDITIVE: { return vec4f(light * covered, 0.0); }
        case BLEND_MODE_MULTIPLY: { return vec4f(mix(vec3f(1.0), min(light, vec3f(1.0)), covered), 1.0); }
        default: { return vec4f(light, 1.0) * covered; }
    }
}
