// From a particle to one corner of its trimmed camera-facing square, or of the rectangle around its sphere. Trimming
// matters because half of a puff's square is clear and would be shaded and blended for nothing. (Persson, "Particle
// trimming", 2009)

#import "lib/bindings.wgsl"
#import "lib/density_grid.wgsl"
#import "lib/grain.wgsl"
#import "lib/particle.wgsl"
#import "lib/ramp.wgsl"
#import "lib/shadow.wgsl"
#import "lib/shadow_volume.wgsl"
#import "lib/sprite.wgsl"
#import "lib/soft_fade.wgsl"
#import "lib/stretch.wgsl"
#import "lib/technique.wgsl"

// Largest magnitude of a particle's numbers that is drawn. MAX_MAGNITUDE in crates/haze_core/src/frame/particle.rs.
const MAX_MAGNITUDE: f32 = 1.0e9;

struct SpriteVertex {
    @builtin(position) position: vec4f,
    // Squares only.
    @location(0) uv: vec2f,
    // View space. Squares: the point on the sprite. Spheres: a point on the ray through the pixel, at view depth 1.
    @location(1) view_position: vec3f,
    // Amount after near fade and opacity, mip level, frame, and erosion by the grain.
    @location(2) @interpolate(flat, either) amount_lod_frame_erosion: vec4f,
    // View space.
    @location(3) @interpolate(flat, either) center_radius: vec4f,
    // Cosine and sine of the rotation.
    @location(4) @interpolate(flat, either) rotation: vec2f,
    // Weight of the normal under the order `weighted`.
    @location(5) @interpolate(flat, either) weight: f32,
    // As in SpriteValues.
    @location(6) @interpolate(flat, either) depths_and_heat: vec4f,
    @location(7) @interpolate(flat, either) tint: vec3f,
    // As in sprite_stretch().
    @location(8) @interpolate(flat, either) stretch: vec2f,
}

override TECHNIQUE: u32 = TECHNIQUE_SOFT;
override SPRITE_ANIMATION: u32 = SPRITE_ANIMATION_FLIPBOOK;
override CHECKERBOARD: bool = false;
// True: sprites are lit by six-way maps, and their normals are not read.
override SIX_WAY: bool = false;
// True if sprite.motion is not 0.
override MOTION: bool = false;
// True if the smoke gives light of its own.
override FIRE: bool = false;
// True if sprite.age_color or sprite.tint is not 0.
override TINT: bool = false;
// True if sprites are stretched along their motion.
override STRETCH: bool = false;
// Octaves of the noise of the grain; 0 for no grain.
override GRAIN_OCTAVES: u32 = 0u;
// Steps of a march through a volumetric sprite, and octaves of noise of each.
override MARCH_STEPS: u32 = 1u;
override NOISE_OCTAVES: u32 = 1u;

// True for techniques whose sprites are spheres.
fn is_sphere() -> bool {
    return TECHNIQUE == TECHNIQUE_SPHERICAL_BILLBOARD || is_volumetric();
}

fn is_volumetric() -> bool {
    return TECHNIQUE == TECHNIQUE_VOLUMETRIC_HARD || TECHNIQUE == TECHNIQUE_VOLUMETRIC_SOFT;
}

// Extent of a sprite in front of its center and behind it, metres.
fn sprite_thickness(radius: f32) -> f32 {
    return select(radius, 0.0, is_flat());
}

fn is_flat() -> bool {
    return TECHNIQUE == TECHNIQUE_HARD || TECHNIQUE == TECHNIQUE_SOFT || TECHNIQUE == TECHNIQUE_SOFT_LINEAR;
}

// View depth at which the hardware tests a sprite. No part of the sprite is nearer.
fn sprite_front(center_radius: vec4f) -> f32 {
    return max(-center_radius.z - sprite_thickness(center_radius.w), view.near);
}

// NDC of a corner of the rectangle around a sphere's projection, clipped half a texel outside the view, because the
// last texels may extend that far.
fn sphere_corner(center_radius: vec4f, corner: vec2f, texels_per_pixel: f32) -> vec2f {
    let center = center_radius.xyz;
    let radius = center_radius.w;
    let x = sphere_axis_bounds(vec2f(center.x, -center.z), radius, view.near);
    let y = sphere_axis_bounds(vec2f(center.y, -center.z), radius, view.near);
    var ray = select(vec2f(x.x, y.x), vec2f(x.y, y.y), corner > vec2f(0.0));
    if view.orthographic > 0.5 {
        ray = center.xy + corner * radius;
    }
    let edge = 1.0 + 1.0 / (texels_per_pixel * view.size);
    return clamp((ray - view.ray_offset) / view.ray_scale, -edge, edge);
}

// Values of a sprite for textures of the accumulation target that only some systems have.
struct SpriteValues {
    // Optical depths of the smoke in front of the sprite towards the lights with shadow, and the sprite's heat.
    depths_and_heat: vec4f,
    // Color by which the light on it is multiplied.
    tint: vec3f,
    // pack2x16snorm() of its stretch.
    stretch: u32,
}

// True if the path tiled stores SpriteValues of sprites.
fn has_values() -> bool {
    return SHADOW || FIRE || TINT || STRETCH;
}

// Particle in view space, with the values that all fragments of its sprite share, as in SpriteVertex.
struct ProjectedSprite {
    hidden: bool,
    center_radius: vec4f,
    amount_lod_frame_erosion: vec4f,
    rotation: vec2f,
    stretch: vec2f,
    values: SpriteValues,
}

// Erosion of a particle's sprite at an age.
fn erosion_of(age: f32) -> f32 {
    return sprite_erosion(system.grain_erosion, system.grain_dissolve, age);
}

// Half the side of the square that the density of a particle's sprite fills, in cells.
fn density_radius(particle: Particle) -> f32 {
    return particle.position_radius.w * system.size * system.density_reach * system.cells_per_metre;
}

// Mean optical depth over that square, as it casts shadow.
fn sprite_optical_depth(particle: Particle) -> f32 {
    let amount = saturate(particle.rotation_amount_frame_age.y) * system.opacity;
    let kept = kept_fraction(system.eroded_fraction, erosion_of(particle.rotation_amount_frame_age.w));
    let depth = kept * mean_optical_depth(amount, system.mean_alpha, system.peak_alpha);
    return system.shadow_density * depth / (system.density_reach * system.density_reach);
}

// Optical depths of the smoke in front of a particle's sprite, towards the lights with shadow. `center`: view space.
fn optical_depths_of(particle: Particle, center: vec3f) -> vec3f {
    if !SHADOW {
        return vec3f(0.0);
    }
    let in_grid = sample_volume(0.0, (system.grid_from_view * vec4f(center, 1.0)).xyz);
    return foreign_optical_depths(in_grid, own_optical_depth(density_radius(particle), sprite_optical_depth(particle)));
}

// Heat of a particle, 0 to 1.
fn heat_of(particle: Particle) -> f32 {
    if !FIRE {
        return 0.0;
    }
    let by_age = painted_fraction(sample_ramp(heat_ramp, linear_sampler, particle.rotation_amount_frame_age.w));
    return by_age * particle.tint_heat.w;
}

// Color of a particle.
fn tint_of(particle: Particle) -> vec3f {
    if !TINT {
        return vec3f(1.0);
    }
    let by_age = sample_ramp(age_ramp, linear_sampler, particle.rotation_amount_frame_age.w);
    return mix(vec3f(1.0), by_age, system.age_color) * mix(vec3f(1.0), particle.tint_heat.rgb, system.tint);
}

// Stretch of a particle's sprite. `center_radius`: of the sprite, view space.
fn stretch_of(particle: Particle, center_radius: vec4f) -> vec2f {
    var velocity = (system.view_from_particles * vec4f(particle.velocity, 0.0)).xyz;
    if any(system.stretch_axis != vec3f(0.0)) {
        velocity = (view.view_from_world * vec4f(system.stretch_axis, 0.0)).xyz;
    }
    let radius = center_radius.w;
    return sprite_stretch(center_radius.xyz, velocity, system.stretch, radius, system.stretch_limit, view.orthographic);
}

// Projects a particle. `texels_per_pixel` is the target's resolution.
fn project_sprite(particle: Particle, texels_per_pixel: f32) -> ProjectedSprite {
    let center = (system.view_from_particles * vec4f(particle.position_radius.xyz, 1.0)).xyz;
    var radius = particle.position_radius.w * system.size;
    if TECHNIQUE == TECHNIQUE_SPHERICAL_BILLBOARD {
        radius *= system.billboard_radius;
    }
    let view_depth = -center.z;
    let angle = particle.rotation_amount_frame_age.x;
    // A sprite is visible until its far side has passed the near plane, so the near fade uses that side.
    let half_depth = sprite_thickness(radius);
    let back = view_depth + half_depth;
    var amount = saturate(particle.rotation_amount_frame_age.y) * system.opacity
        * near_fade(back, system.near_fade_start, system.near_fade_end);
    let frame = particle.rotation_amount_frame_age.z;
    let age = particle.rotation_amount_frame_age.w;

    // A host's own buffer may contain anything. The comparisons are false for NaN, and numbers beyond MAX_MAGNITUDE are
    // not drawn.
    let motion = dot(abs(particle.velocity), vec3f(1.0));
    let finite = dot(abs(center), vec3f(1.0)) + radius + abs(angle) + abs(frame) + abs(age) + motion < MAX_MAGNITUDE;
    let in_view = back > view.near && view_depth - half_depth < view.far;
    let shown = finite && in_view && radius > 0.0 && amount > 0.0;

    let pixels = pixels_per_metre(view.size.y, view.ray_scale.y, max(view_depth, view.near), view.orthographic);
    var stretch = vec2f(0.0);
    if STRETCH {
        let thin = stretch_of(particle, vec4f(center, radius));
        let wide = max(radius, MIN_RADIUS / (pixels * texels_per_pixel));
        stretch = stretch_of(particle, vec4f(center, wide));
        amount *= widened_fraction(radius, wide, thin, stretch);
        radius = wide;
    }
    let diameter = 2.0 * radius * pixels * texels_per_pixel;
    let lod = sprite_lod(system.sprite_size, diameter);
    let shown_frame = sprite_frame(SPRITE_ANIMATION, frame, age, system.frame_count);
    return ProjectedSprite(
        !shown,
        vec4f(center, radius),
        vec4f(amount, lod, shown_frame, erosion_of(age)),
        vec2f(cos(angle), sin(angle)),
        stretch,
        SpriteValues(
            vec4f(optical_depths_of(particle, center), heat_of(particle)),
            tint_of(particle),
            pack2x16snorm(stretch),
        ),
    );
}

const FULL_ALPHA_BOUNDS: vec4u = vec4u(0xffffffffu);

// Part of a frame that is not clear, at a sprite's mip level: a bit for each cell in xy, the extent in z.
// AlphaBoundsTexel in crates/haze_core/src/assets/sprite/alpha_bounds.rs.
fn alpha_bounds_texel(frame: i32, lod: f32) -> vec4u {
    if CHECKERBOARD || MOTION {
        return FULL_ALPHA_BOUNDS;
    }
    let level = min(i32(lod), i32(textureDimensions(sprite_alpha_bounds).x) - 1);
    return textureLoad(sprite_alpha_bounds, vec2i(level, frame + select(0, i32(system.frame_count), SIX_WAY)), 0);
}

// Extent of a sprite with these frames from its center to the left, bottom, right and top, as fractions of half its side.
fn trimmed_extent(frames: FlipbookFrames, lod: f32) -> vec4f {
    let reach = unpack4x8unorm(alpha_bounds_texel(frames.first, lod).z);
    if frames.blend > 0.0 {
        return max(reach, unpack4x8unorm(alpha_bounds_texel(frames.second, lod).z));
    }
    return reach;
}

// Computes one corner of a sprite. `index` is that of its particle. `target_from_ndc` maps the view's NDC to the target's.
fn sprite_vertex(
    particle: Particle,
    index: u32,
    corner_index: u32,
    target_from_ndc: vec4f,
    texels_per_pixel: f32,
) -> SpriteVertex {
    var out: SpriteVertex;
    let sprite = project_sprite(particle, texels_per_pixel);
    // Hidden sprites collapse outside the clip volume.
    if sprite.hidden || index >= system.alive_count {
        out.position = vec4f(2.0, 2.0, 2.0, 1.0);
        return out;
    }
    out.center_radius = sprite.center_radius;
    out.amount_lod_frame_erosion = sprite.amount_lod_frame_erosion;
    out.rotation = sprite.rotation;
    out.weight = 1.0;
    out.depths_and_heat = sprite.values.depths_and_heat;
    out.tint = sprite.values.tint;
    out.stretch = sprite.stretch;
    let center = sprite.center_radius.xyz;
    let corner = sprite_corner(corner_index);
    var clip: vec4f;
    if is_sphere() {
        let ndc = sphere_corner(out.center_radius, corner, texels_per_pixel);
        clip = vec4f(ndc, 0.0, 1.0);
        out.view_position = view_position(ndc * view.ray_scale + view.ray_offset, 1.0, view.orthographic);
    } else {
        let frames = animation_frames(SPRITE_ANIMATION, out.amount_lod_frame_erosion.z, system.frame_count);
        let position = trimmed_corner(corner, trimmed_extent(frames, out.amount_lod_frame_erosion.y));
        var turned = vec2f(
            position.x * out.rotation.x - position.y * out.rotation.y,
            position.x * out.rotation.y + position.y * out.rotation.x,
        );
        if STRETCH {
            turned = stretched(turned, out.stretch);
        }
        // A slab whose center has passed the near plane is drawn on the near plane.
        out.view_position = vec3f(center.xy + turned * sprite.center_radius.w, min(center.z, -view.near));
        clip = view.clip_from_view * vec4f(out.view_position, 1.0);
        out.uv = sprite_uv(position);
    }
    let front = view.clip_from_view * vec4f(0.0, 0.0, -sprite_front(out.center_radius), 1.0);
    let depth = saturate(front.z / front.w);
    out.position = vec4f(clip.xy * target_from_ndc.xy + clip.w * target_from_ndc.zw, depth * clip.w, clip.w);
    return out;
}
