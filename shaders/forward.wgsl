// forward: lights and blends every sprite fragment at full resolution. The classic method, and the baseline of every
// comparison.
// Reads   particles (instances, back to front), sprite flipbook, detail map or noise, scene depth, lights, ramps.
// Writes  the host's color target: linear light.
// Blend   alpha: ONE, ONE_MINUS_SRC_ALPHA (premultiplied) · additive: ONE, ONE · multiply: DST, ZERO.
// Source  OTEE "Typical game particles so far"; techniques: NV, BLOG, MS; age ramp: MS.

#import "lib/sprite_fragment.wgsl"
#import "lib/diffuse.wgsl"
#import "lib/emission.wgsl"
#import "lib/shadow_volume.wgsl"
#import "lib/blending.wgsl"
#import "lib/color.wgsl"

// True if the smoke is lit by its depth.
override BY_DEPTH: bool = false;

override BLEND_MODE: u32 = BLEND_MODE_ALPHA;

@vertex
fn vertex(
    particle: Particle,
    @builtin(instance_index) index: u32,
    @builtin(vertex_index) corner: u32,
) -> SpriteVertex {
    return sprite_vertex(particle, index, corner, vec4f(1.0, 1.0, 0.0, 0.0), 1.0);
}

// Ray through a point in view space, as in view_position().
fn ray_through(position: vec3f) -> vec2f {
    return position.xy / mix(-position.z, 1.0, view.orthographic);
}

@fragment
fn fragment(in: SpriteVertex) -> @location(0) vec4f {
    var scene = SKY_VIEW_DEPTH;
    if reads_scene() {
        // Pixels of the target, which include the view's origin already.
        scene = host_view_depth(textureLoad(scene_depth, vec2i(in.position.xy), 0).r);
    }
    let fragment = technique_fragment(in, fragment_frames(in), scene);
    if fragment.hidden || fragment.amount <= 0.0 {
        discard;
    }
    let amount = fragment.amount;
    var position = in.view_position;
    if is_sphere() {
        position = view_position(in.view_position.xy, max(-in.center_radius.z, view.near), view.orthographic);
    }
    let covered = coverage(amount, system.boost);
    var shade = shade_of_sprites(in.depths_and_heat.xyz);
    if BY_DEPTH {
        shade = shade_on_ray(in.depths_and_heat.xyz, ray_through(position), moments_of_sprite(in.center_radius));
    }
    var light = vec3f(0.0);
    if SIX_WAY {
        light = diffuse_from_six_way(fragment.six_way, position, shade);
    } else {
        let normal = fragment.normal * inverseSqrt(max(dot(fragment.normal, fragment.normal), 1.0e-12));
        light = diffuse_from_lights(normal, covered, position, shade);
    }
    light = (light * system.diffuse_intensity + soft_scatter(amount)) * in.tint;
    if FIRE {
        let heat = fragment_heat(fragment, in.depths_and_heat.w);
        light += emission(fire_from_moments(vec2f(heat, heat * heat)), amount);
    }
    return forward_fragment(BLEND_MODE, bounded_light(light), covered);
}
