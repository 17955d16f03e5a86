// From a particle to one corner of its camera-facing square.

#import "lib/bindings.wgsl"
#import "lib/sprite.wgsl"
#import "lib/soft_fade.wgsl"
#import "lib/normal.wgsl"

// One instance. The layout is that of `Particle` in src/particle.rs.
struct Particle {
    // World space; radius in w.
    @location(0) position_radius: vec4f,
    // Rotation, amount, frame, age.
    @location(1) rotation_amount_frame_age: vec4f,
}

// Largest number of a particle that is drawn. LARGEST in src/particle.rs.
const LARGEST: f32 = 1.0e9;

struct SpriteVertex {
    @builtin(position) position: vec4f,
    @location(0) uv: vec2f,
    // View space.
    @location(1) view_position: vec3f,
    // The sprite's view depth, amount after near fade and opacity, mip level, frame.
    @location(2) @interpolate(flat, either) depth_amount_lod_frame: vec4f,
    // Cosine and sine of the rotation.
    @location(3) @interpolate(flat, either) rotation: vec2f,
}

// `target_from_ndc` moves the picture's NDC to the target's; `texels_per_pixel` is the target's resolution.
fn sprite_vertex(
    particle: Particle,
    corner_index: u32,
    target_from_ndc: vec4f,
    texels_per_pixel: f32,
) -> SpriteVertex {
    var out: SpriteVertex;
    let centre = (view.view_from_world * vec4f(particle.position_radius.xyz, 1.0)).xyz;
    let radius = particle.position_radius.w;
    let view_depth = -centre.z;
    let angle = particle.rotation_amount_frame_age.x;
    let amount = saturate(particle.rotation_amount_frame_age.y) * system.opacity
        * near_fade(view_depth, system.near_fade_start, system.near_fade_end);
    let frame = particle.rotation_amount_frame_age.z;

    // Hidden sprites collapse outside the clip volume. A host's own buffer may hold anything: the comparisons are false
    // for NaN, and what is beyond LARGEST has no place in a picture.
    let finite = dot(abs(centre), vec3f(1.0)) + radius + abs(angle) + abs(frame) < LARGEST;
    if !(finite && view_depth > view.near && radius > 0.0 && amount > 0.0) {
        out.position = vec4f(2.0, 2.0, 2.0, 1.0);
        return out;
    }

    let rotation = vec2f(cos(angle), sin(angle));
    let corner = sprite_corner(corner_index);
    let turned = vec2f(
        corner.x * rotation.x - corner.y * rotation.y,
        corner.x * rotation.y + corner.y * rotation.x,
    );
    let view_position = centre + vec3f(turned * radius, 0.0);
    let clip = view.clip_from_view * vec4f(view_position, 1.0);

    // Pixels across the sprite: its size in NDC times half the picture's height.
    let pixels_per_metre = 0.5 * view.size.y / view.ray_scale.y * mix(1.0 / view_depth, 1.0, view.orthographic);
    let diameter = 2.0 * radius * pixels_per_metre * texels_per_pixel;

    out.position = vec4f(clip.xy * target_from_ndc.xy + clip.w * target_from_ndc.zw, clip.zw);
    out.uv = sprite_uv(corner);
    out.view_position = view_position;
    out.depth_amount_lod_frame = vec4f(
        view_depth,
        amount,
        sprite_lod(system.sprite_size, diameter),
        frame,
    );
    out.rotation = rotation;
    return out;
}

// Normal (view space) and amount (not faded against the scene yet) of a sprite fragment.
fn sprite_fragment(vertex: SpriteVertex) -> vec4f {
    let frames = flipbook_frames(vertex.depth_amount_lod_frame.w, system.frame_count);
    let texel = sample_sprite(sprite, linear_sampler, vertex.uv, frames, vertex.depth_amount_lod_frame.z);
    let normal = rotate_normal(texel.xyz, vertex.rotation);
    return vec4f(normal, texel.a * vertex.depth_amount_lod_frame.y);
}
