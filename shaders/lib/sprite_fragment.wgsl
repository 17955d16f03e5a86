// Fragment of a sprite under every technique, shared by accumulate and forward.

#import "lib/sprite_vertex.wgsl"
#import "lib/attachments.wgsl"
#import "lib/depth.wgsl"
#import "lib/depth_moments.wgsl"
#import "lib/fire.wgsl"
#import "lib/noise_volume.wgsl"
#import "lib/normal.wgsl"
#import "lib/six_way.wgsl"

override FADE_CURVE: u32 = FADE_CURVE_SMOOTHSTEP;
// True: the host's depth is linear.
override LINEAR_DEPTH: bool = false;
// True: the hardware has already rejected fragments behind the scene.
override DEPTH_TESTED: bool = false;
// True: the target has the resolution of the view.
override FULL_RESOLUTION: bool = false;

struct SpriteFragment {
    // View space, about unit length.
    normal: vec3f,
    // View space, if SIX_WAY.
    six_way: SixWay,
    amount: f32,
    // Amount of the sprite's image, before that of the particle.
    thickness: f32,
    // True behind the scene and outside the sphere: the fragment is not shaded.
    hidden: bool,
}

const NO_LIGHT: SixWay = SixWay(vec3f(0.0), vec3f(0.0));
const HIDDEN: SpriteFragment = SpriteFragment(vec3f(0.0, 0.0, 1.0), NO_LIGHT, 0.0, 0.0, true);

// Values of a fragment beside normal and amount. `weight`: amount times the weight of its normal. `sprite_values`: of its
// sprite. `center_radius`: the sprite in view space.
fn attachments_from_fragment(
    fragment: SpriteFragment,
    weight: f32,
    sprite_values: SpriteValues,
    center_radius: vec4f,
) -> Attachments {
    var values: Attachments;
    if SIX_WAY_SLOT != 0u {
        values.six_way = vec4f(fragment.six_way.negative * weight, weight);
    }
    if WEIGHTS_SLOT != 0u {
        values.weights = weight;
    }
    if OPTICAL_DEPTHS_SLOT != 0u {
        values.optical_depths = vec4f(sprite_values.depths_and_heat.xyz * weight, weight);
    }
    if DEPTH_SLOT != 0u {
        values.depth = vec4f(moments_of_sprite(center_radius) * weight, 0.0, weight);
    }
    if HEAT_SLOT != 0u {
        let heat = fragment_heat(fragment, sprite_values.depths_and_heat.w);
        values.heat = vec4f(heat * weight, heat * heat * weight, 0.0, weight);
    }
    if TINT_SLOT != 0u {
        values.tint = vec4f(sprite_values.tint * weight, weight);
    }
    return values;
}

// Heat of a fragment of a sprite with this heat.
fn fragment_heat(fragment: SpriteFragment, heat: f32) -> f32 {
    return heat_at(heat, fragment.thickness, fragment.normal.z, system.fire_core, system.fire_crust);
}

// depth_moments() of a sprite in view space.
fn moments_of_sprite(center_radius: vec4f) -> vec2f {
    let radius = center_radius.w * system.density_reach;
    return depth_moments(-center_radius.z, radius, system.smoke_near, system.smoke_far);
}

// True if the technique reads the scene's depth in the shader.
fn reads_scene() -> bool {
    return !(DEPTH_TESTED && TECHNIQUE == TECHNIQUE_HARD);
}

// View depth of a texel of the host's depth.
fn host_view_depth(texel: f32) -> f32 {
    if LINEAR_DEPTH {
        return view_depth_from_linear(texel + view.depth_offset);
    }
    return view_depth_from_ndc_depth(texel, view.depth_coefficients);
}

// Frames that a rasterized fragment shows.
fn fragment_frames(in: SpriteVertex) -> FlipbookFrames {
    return animation_frames(SPRITE_ANIMATION, in.amount_lod_frame_erosion.z, system.frame_count);
}

fn technique_fragment(in: SpriteVertex, frames: FlipbookFrames, scene: f32) -> SpriteFragment {
    if is_sphere() {
        return sphere_fragment(in, frames, scene);
    }
    var amount = in.amount_lod_frame_erosion.x;
    let view_depth = -in.center_radius.z;
    let radius = in.center_radius.w;

    var texel_depth = view_depth;
    var motion = vec2f(0.0);
    let is_depth_sprite = TECHNIQUE == TECHNIQUE_DEPTH_SPRITE_HARD || TECHNIQUE == TECHNIQUE_DEPTH_SPRITE_SOFT;
    if is_depth_sprite || MOTION {
        let texel = detail_at(in, in.uv, frames);
        motion = texel.yz * system.motion;
        if is_depth_sprite {
            texel_depth = depth_sprite_depth(view_depth, texel.x, radius);
            amount *= visible_slab_fraction(view_depth, radius, view.near);
        }
    }

    let thickness = density_thickness(view_depth, radius, view.near, scene);
    var fade = 1.0;
    switch TECHNIQUE {
        case TECHNIQUE_HARD: {
            if !DEPTH_TESTED { fade = hard_fade(scene - view_depth); }
        }
        case TECHNIQUE_DEPTH_SPRITE_HARD: { fade = hard_fade(scene - texel_depth); }
        // Hidden if nothing is left of the slab.
        case TECHNIQUE_DENSITY: { fade = thickness; }
        default: { fade = fade_before(scene, texel_depth); }
    }
    // Hidden fragments are looked up too: a branch would slow down all fragments, and the hardware or a list has
    // rejected most hidden ones.
    var fragment = sprite_texel(in, in.uv, frames, motion);
    fragment.hidden = fade <= 0.0;
    if TECHNIQUE == TECHNIQUE_DENSITY {
        fragment.amount = density_amount(system.density * fragment.amount * amount, thickness);
    } else {
        fragment.amount *= amount * fade;
    }
    return fragment;
}

// Fragment of a sprite that the scene neither fades nor hides: see is_unfaded().
fn unfaded_fragment(in: SpriteVertex, frames: FlipbookFrames) -> SpriteFragment {
    var motion = vec2f(0.0);
    if MOTION {
        motion = detail_at(in, in.uv, frames).yz * system.motion;
    }
    var fragment = sprite_texel(in, in.uv, frames, motion);
    fragment.amount *= in.amount_lod_frame_erosion.x;
    return fragment;
}

// True if the scene, nowhere nearer than `scene`, neither fades nor hides a sprite. False also where that is not known.
fn is_unfaded(scene: f32, view_depth: f32) -> bool {
    switch TECHNIQUE {
        case TECHNIQUE_HARD: { return scene >= view_depth; }
        case TECHNIQUE_SOFT, TECHNIQUE_SOFT_LINEAR: { return fade_before(scene, view_depth) >= 1.0; }
        default: { return false; }
    }
}

// Texel of the detail map at a position on a sprite: see sample_detail().
fn detail_at(in: SpriteVertex, uv: vec2f, frames: FlipbookFrames) -> vec3f {
    let lod = max(in.amount_lod_frame_erosion.y - system.detail_lod, 0.0);
    return sample_detail(detail, linear_sampler, uv, frames, lod);
}

fn fade_before(scene: f32, view_depth: f32) -> f32 {
    return soft_fade(FADE_CURVE, scene - view_depth, system.fade_scale, system.contrast_power, system.epsilon);
}

// Grain at a position on a sprite: see sample_grain().
fn grain_of(in: SpriteVertex, uv: vec2f, frames: FlipbookFrames) -> vec3f {
    let distance = mix(max(-in.center_radius.z, view.near), 1.0, view.orthographic);
    let scale = select(f32(system.scale), 1.0, FULL_RESOLUTION);
    let fineness = system.grain_fineness * scale * distance / in.center_radius.w;
    let phase = (f32(frames.first) + frames.blend) / system.frame_count;
    return sample_grain(noise, repeat_sampler, uv, phase, system.grain_tiles, fineness, GRAIN_OCTAVES);
}

// Values of the sprite's image at a position, rotated with the sprite.
fn sprite_texel(in: SpriteVertex, uv: vec2f, frames: FlipbookFrames, motion: vec2f) -> SpriteFragment {
    var grain = vec3f(0.0);
    if GRAIN_OCTAVES > 0u {
        grain = grain_of(in, uv, frames);
    }
    let tilt = grain.xy * system.grain_bump;
    var fragment = clean_texel(in, uv, frames, motion, tilt);
    if GRAIN_OCTAVES > 0u {
        fragment.amount = eroded(fragment.amount, grain.z, in.amount_lod_frame_erosion.w);
        fragment.thickness = fragment.amount;
    }
    return fragment;
}

// The same without erosion. `tilt`: of the normals, by the grain.
fn clean_texel(
    in: SpriteVertex,
    uv: vec2f,
    frames: FlipbookFrames,
    motion: vec2f,
    tilt: vec2f,
) -> SpriteFragment {
    let lod = in.amount_lod_frame_erosion.y;
    if SIX_WAY {
        let count = i32(system.frame_count);
        let positive = sample_flipbook(sprite, linear_sampler, uv, offset_frames(frames, count), motion, lod);
        let negative = sample_flipbook(sprite, linear_sampler, uv, offset_frames(frames, 2 * count), motion, lod);
        var light = SixWay(six_way_from_texel(positive.rgb), six_way_from_texel(negative.rgb));
        if GRAIN_OCTAVES > 0u {
            light = tilted_six_way(light, tilt);
        }
        let turned = rotate_six_way(light.positive, light.negative, in.rotation);
        return SpriteFragment(vec3f(0.0, 0.0, 1.0), turned, positive.a, positive.a, false);
    }
    var texel = checkerboard(uv);
    if !CHECKERBOARD {
        texel = sample_sprite(sprite, linear_sampler, uv, frames, motion, lod);
    }
    var normal = texel.xyz;
    if GRAIN_OCTAVES > 0u {
        normal = tilted_normal(normal, tilt);
    }
    normal = rotate_normal(normal, in.rotation);
    if STRETCH {
        normal = stretched_normal(normal, in.stretch);
    }
    return SpriteFragment(normal, NO_LIGHT, texel.w, texel.w, false);
}

fn sphere_fragment(in: SpriteVertex, frames: FlipbookFrames, scene: f32) -> SpriteFragment {
    let center = in.center_radius.xyz;
    let radius = in.center_radius.w;
    // Ray through the pixel. View depth d is at a distance of d · per_depth along it.
    let origin = vec3f(in.view_position.xy * view.orthographic, 0.0);
    let along = normalize(vec3f(in.view_position.xy * (1.0 - view.orthographic), -1.0));
    let per_depth = -1.0 / along.z;
    let end = (scene + system.show_through_distance) * per_depth;
    let interval = ray_sphere(origin, along, center, radius, view.near * per_depth, end);
    let stretch = interval.leave - interval.enter;
    if stretch <= 0.0 || dot(interval.axis, interval.axis) >= radius * radius {
        return HIDDEN;
    }
    let amount = in.amount_lod_frame_erosion.x;
    if is_volumetric() {
        return volumetric_fragment(in, scene, origin, along, interval);
    }
    // The sprite's image is on the disc through the center that faces the ray.
    let position = unrotate(interval.axis.xy, in.rotation) / radius;
    var motion = vec2f(0.0);
    if MOTION {
        motion = detail_at(in, sprite_uv(position), frames).yz * system.motion;
    }
    var fragment = sprite_texel(in, sprite_uv(position), frames, motion);
    let density = system.billboard_density * fragment.amount * amount;
    fragment.amount = spherical_billboard_amount(density, length(interval.axis), radius, stretch);
    return fragment;
}

// Marches from entry to exit, front to back. (MS "Volumetric particles")
fn volumetric_fragment(
    in: SpriteVertex,
    scene: f32,
    origin: vec3f,
    along: vec3f,
    interval: RayInterval,
) -> SpriteFragment {
    let center = in.center_radius.xyz;
    let world_from_view = transpose(mat3x3f(
        view.view_from_world[0].xyz,
        view.view_from_world[1].xyz,
        view.view_from_world[2].xyz,
    ));
    // Along the ray, a coordinate is its value at the entry plus the distance times its slope.
    let span = interval.leave - interval.enter;
    let entry = origin + along * interval.enter;
    let position_at_entry = (entry - center) / in.center_radius.w;
    let position_along = along / in.center_radius.w;
    let noise_at_entry = fract(noise_coordinate(world_from_view * entry, system.noise_size, system.noise_offset));
    let noise_along = world_from_view * along / system.noise_size;
    let opacity = system.volume_opacity * in.amount_lod_frame_erosion.x * span;
    var normal = vec3f(0.0);
    var transmittance = 1.0;
    var begin = 0.0;
    for (var i = 0u; i < MARCH_STEPS; i++) {
        let end = march_boundary(f32(i + 1u) / f32(MARCH_STEPS));
        let distance = 0.5 * (begin + end) * span;
        let position = position_at_entry + position_along * distance;
        let coordinate = noise_at_entry + noise_along * distance;
        let texel = sample_noise_octaves(noise, repeat_sampler, coordinate, NOISE_OCTAVES);
        var amount = density_amount(opacity * (end - begin), volumetric_density(texel.w, volumetric_falloff(position)));
        if TECHNIQUE == TECHNIQUE_VOLUMETRIC_SOFT {
            amount *= fade_before(scene, -(entry.z + along.z * distance));
        }
        // Gradient in view space: a row vector times the inverse rotates forward.
        normal += volumetric_normal(position, texel.xyz * world_from_view) * (amount * transmittance);
        transmittance *= 1.0 - amount;
        begin = end;
    }
    let total = 1.0 - transmittance;
    return SpriteFragment(normal / max(total, 1.0e-6), NO_LIGHT, total, total, false);
}
