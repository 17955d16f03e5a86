// A sprite as the tiled path keeps it: what all of its fragments share, worked out once.

#import "lib/sprite_fragment.wgsl"

struct TileSprite {
    // Squares: rows of the matrix from texels, from the middle, to the place in the square, -1..1.
    place_from_texels: vec4f,
    // View space. Squares: the middle in texels in xy.
    centre_radius: vec4f,
    amount_lod_frame: vec3f,
    weight: f32,
    rotation: vec2f,
    // Which of eight by eight cells of the picture there is something in, a byte for each row from the top.
    filled: vec2u,
}

const ALL_FILLED: vec2u = vec2u(0xffffffffu);

// The cells of a sprite's frames, at its mip level.
fn filled_cells(filled: texture_2d<u32>, frames: FlipbookFrames, lod: f32) -> vec2u {
    if DEBUG_SPRITE || MOTION {
        return ALL_FILLED;
    }
    let level = min(i32(lod), i32(textureDimensions(filled).x) - 1);
    var cells = textureLoad(filled, vec2i(level, frames.first), 0).xy;
    if frames.blend > 0.0 {
        cells |= textureLoad(filled, vec2i(level, frames.second), 0).xy;
    }
    return cells;
}

// True at a place in a square, -1..1, where its picture is not clear.
fn is_filled(cells: vec2u, place: vec2f) -> bool {
    let cell = vec2u(clamp(sprite_uv(place) * 8.0, vec2f(0.0), vec2f(7.0)));
    let rows = select(cells.x, cells.y, cell.y >= 4u);
    return ((rows >> ((cell.y & 3u) * 8u + cell.x)) & 1u) == 1u;
}

// Bits that order as view depths do, near to far: of view z, from front to back. (Herf, "Radix tricks", 2001)
fn front_to_back_bits(view_z: f32) -> u32 {
    let bits = bitcast<u32>(view_z);
    return select(0x7fffffffu - bits, bits, bits >> 31u == 1u);
}

// Ray (as view_position has it) through a place of the target, texels.
fn ray_through_texel(texel: vec2f) -> vec2f {
    let pixel = (texel + system.target_origin) * system.scale;
    return ndc_from_pixel(pixel, view.size) * view.ray_scale + view.ray_offset;
}

// The place of the target, texels, that a ray goes through.
fn texel_of_ray(ray: vec2f) -> vec2f {
    return texel_of_ndc((ray - view.ray_offset) / view.ray_scale);
}

// The same of the picture's NDC.
fn texel_of_ndc(ndc: vec2f) -> vec2f {
    return pixel_from_ndc(ndc, view.size) / system.scale - system.target_origin;
}

// A square's place, -1..1, at a texel.
fn place_in_square(sprite: TileSprite, texel: vec2f) -> vec2f {
    let offset = texel - sprite.centre_radius.xy;
    return vec2f(dot(sprite.place_from_texels.xy, offset), dot(sprite.place_from_texels.zw, offset));
}

// False where a square does not come near a rectangle; half its sides in `half_size`. Exact but for the corners.
fn square_meets(sprite: TileSprite, middle: vec2f, half_size: vec2f) -> bool {
    let reach = vec2f(
        dot(abs(sprite.place_from_texels.xy), half_size),
        dot(abs(sprite.place_from_texels.zw), half_size),
    );
    return all(abs(place_in_square(sprite, middle)) <= reach + 1.0);
}

// What the rasterizer would hand to the fragment at a texel. `ray`: through it.
fn fragment_of(sprite: TileSprite, texel: vec2f, ray: vec2f, place: vec2f) -> SpriteVertex {
    var out: SpriteVertex;
    out.position = vec4f(texel, 0.0, 1.0);
    out.centre_radius = sprite.centre_radius;
    out.amount_lod_frame_age = vec4f(sprite.amount_lod_frame, 0.0);
    out.rotation = sprite.rotation;
    out.weight = sprite.weight;
    if is_sphere() {
        out.view_position = view_position(ray, 1.0, view.orthographic);
    } else {
        out.uv = sprite_uv(place);
    }
    return out;
}
