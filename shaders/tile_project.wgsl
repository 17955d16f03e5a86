// tile_project
// Projects every particle into the view: computes the data that its fragments share, the texels that it touches, and
// its depth.
//
// Reads   particles.
// Writes  sprites, their rectangles, and keys and indices to sort, last particle first: after a stable sort, sprites of
//         equal depth are then in the reverse of the raster path's drawing order.
// Space   View space; rectangles in texels of the target.

#import "lib/tiles.wgsl"
#import "lib/tile_sprite.wgsl"
#import "lib/order.wgsl"

@group(3) @binding(0) var<uniform> tiles: Tiles;
// PARTICLE_VECTORS per particle.
@group(3) @binding(1) var<storage, read> particles: array<vec4u>;
@group(3) @binding(2) var<storage, read_write> sprites: array<TileSprite>;
@group(3) @binding(3) var<storage, read_write> rects: array<vec2u>;
@group(3) @binding(4) var<storage, read_write> keys: array<u32>;
@group(3) @binding(5) var<storage, read_write> indices: array<u32>;
// If has_values().
@group(3) @binding(6) var<storage, read_write> sprite_values: array<SpriteValues>;

// True: sprites are unsorted and their normals are weighted.
override WEIGHTED: bool = false;

@compute @workgroup_size(64)
fn project(@builtin(global_invocation_id) invocation: vec3u) {
    let index = invocation.x;
    if index >= tiles.count {
        return;
    }
    let at = tiles.first + PARTICLE_VECTORS * index;
    let particle = particle_from_words(particles[at], particles[at + 1u], particles[at + 2u]);
    let placed = project_sprite(particle, 1.0 / f32(system.scale));
    let center = placed.center_radius.xyz;
    let radius = placed.center_radius.w;
    var sprite: TileSprite;
    sprite.center_radius = placed.center_radius;
    let lod = placed.amount_lod_frame_erosion.y;
    let frames = animation_frames(SPRITE_ANIMATION, placed.amount_lod_frame_erosion.z, system.frame_count);
    sprite.amount = placed.amount_lod_frame_erosion.x;
    sprite.frames_lod = packed_frames(frames, lod);
    sprite.blend_erosion = packed_blend(frames.blend, placed.amount_lod_frame_erosion.w);
    sprite.filled = filled_cells(frames, lod);

    var low: vec2f;
    var high: vec2f;
    if is_sphere() {
        let texels_per_pixel = 1.0 / f32(system.scale);
        low = texel_of_ndc(sphere_corner(placed.center_radius, vec2f(-1.0, 1.0), texels_per_pixel));
        high = texel_of_ndc(sphere_corner(placed.center_radius, vec2f(1.0, -1.0), texels_per_pixel));
    } else {
        // A slab whose center has passed the near plane is drawn on that plane.
        let plane = mix(max(-center.z, view.near), 1.0, view.orthographic);
        let middle = texel_of_ray(center.xy / plane);
        // Size of a texel in view space, metres; the y of texels points down.
        let metres = view.ray_scale * vec2f(2.0, -2.0) * (plane * f32(system.scale)) / view.size;
        // Axes of the sprite on the screen, and the rows of the inverse matrix.
        var across = placed.rotation;
        var up = vec2f(-across.y, across.x);
        var to_across = across;
        var to_up = up;
        if STRETCH {
            across = stretched(across, placed.stretch);
            up = stretched(up, placed.stretch);
            to_across = unstretched(to_across, placed.stretch);
            to_up = unstretched(to_up, placed.stretch);
        }
        // v points down.
        sprite.uv_from_texels = vec4f(metres * to_across, metres * -to_up) * (0.5 / radius);
        sprite.center_radius = vec4f(middle, center.z, radius);
        // Filled part of the square: its center, and half its sides.
        let reach = trimmed_extent(frames, lod);
        let texels = radius / metres;
        let position = 0.5 * (reach.zw - reach.xy);
        let half_size = 0.5 * (reach.xy + reach.zw);
        let filled = middle + (across * position.x + up * position.y) * texels;
        let extent = (abs(across) * half_size.x + abs(up) * half_size.y) * abs(texels);
        low = filled - extent;
        high = filled + extent;
    }
    // Texels whose centers lie inside, with a margin of 0.01 texels for rounding.
    let first = clamp(floor(low - 0.01), vec2f(0.0), system.target_size);
    let last = clamp(ceil(high + 0.01), vec2f(0.0), system.target_size);

    sprite.rotation = placed.rotation;
    sprite.weight = 1.0;
    if WEIGHTED {
        let in_front = optical_depth_in_front(system.optical_depth_knots, -center.z, system.smoke_near, system.smoke_far);
        sprite.weight = order_weight(system.depth_weight, in_front);
    }
    let visible = !placed.hidden && index < system.alive_count && all(first < last);
    if has_values() {
        sprite_values[index] = placed.values;
    }
    if visible {
        sprites[index] = sprite;
    } else {
        // A sprite of zeros is invisible in bins that read all sprites.
        sprites[index] = TileSprite();
    }
    rects[index] = select(vec2u(0u), packed_rect(vec2u(first), vec2u(last)), visible);
    let backwards = tiles.count - 1u - index;
    keys[backwards] = select(HIDDEN_KEY, front_to_back_bits(center.z), visible);
    indices[backwards] = index;
}

// Returns the position in the target, texels, that a ray goes through.
fn texel_of_ray(ray: vec2f) -> vec2f {
    return texel_of_ndc((ray - view.ray_offset) / view.ray_scale);
}

// Returns the position in the target, texels, of the view's NDC.
fn texel_of_ndc(ndc: vec2f) -> vec2f {
    return pixel_from_ndc(ndc, view.size) / f32(system.scale) - system.target_origin;
}

// Returns the filled cells of a sprite's frames at its mip level.
fn filled_cells(frames: FlipbookFrames, lod: f32) -> vec2u {
    let cells = alpha_bounds_texel(frames.first, lod).xy;
    if frames.blend > 0.0 {
        return cells | alpha_bounds_texel(frames.second, lod).xy;
    }
    return cells;
}
