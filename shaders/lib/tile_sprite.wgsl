// Sprite data of the tiled path: everything that a sprite's fragments share, computed once.

#import "lib/sprite_fragment.wgsl"

// True: sprites are compared with the host's depth, not with the reduced depth.
override HOST_DEPTH: bool = false;

// Returns the view depth that sprites are compared with at a texel of the target.
fn tested_view_depth(tested_depth: texture_2d<f32>, texel: vec2u) -> f32 {
    if HOST_DEPTH {
        // At scale 1, the only one that reads the host's depth.
        let pixel = vec2i(texel) + vec2i(system.target_origin + view.origin);
        return host_view_depth(textureLoad(tested_depth, pixel, 0).r);
    }
    return textureLoad(tested_depth, texel, 0).r * system.depth_limit;
}

struct TileSprite {
    // Squares: rows of the matrix from texels, relative to the center, to uv.
    uv_from_texels: vec4f,
    // View space. Squares: xy is the center in texels.
    center_radius: vec4f,
    amount: f32,
    weight: f32,
    // Both frames and the mip level. Computing them per texel took a sixteenth of the traversal.
    frames_lod: u32,
    // Weight of the second frame; with grain, pack2x16unorm() of that and the erosion.
    blend_erosion: u32,
    rotation: vec2f,
    // Cells of the sprite image, 8 by 8, that are not fully transparent: one byte per row, from the top.
    filled: vec2u,
}

// 12 bits per frame suffice, because no device has more than 2048 array layers; a sprite's mip level is an integer.
fn packed_frames(frames: FlipbookFrames, lod: f32) -> u32 {
    return u32(frames.first) | (u32(frames.second) << 12u) | (u32(min(lod, 255.0)) << 24u);
}

fn frames_of(sprite: TileSprite) -> FlipbookFrames {
    return FlipbookFrames(i32(sprite.frames_lod & 0xfffu), i32((sprite.frames_lod >> 12u) & 0xfffu), blend_and_erosion(sprite).x);
}

fn packed_blend(blend: f32, erosion: f32) -> u32 {
    if GRAIN_OCTAVES == 0u {
        return bitcast<u32>(blend);
    }
    return pack2x16unorm(vec2f(blend, erosion));
}

fn blend_and_erosion(sprite: TileSprite) -> vec2f {
    if GRAIN_OCTAVES == 0u {
        return vec2f(bitcast<f32>(sprite.blend_erosion), 0.0);
    }
    return unpack2x16unorm(sprite.blend_erosion);
}

fn lod_of(sprite: TileSprite) -> f32 {
    return f32(sprite.frames_lod >> 24u);
}

// Returns the cell of the sprite image at uv, or the nearest one.
fn cell_at(uv: vec2f) -> vec2u {
    // Converts to signed integers first: CPUs have no instruction for a direct conversion to unsigned ones.
    return vec2u(vec2i(clamp(uv * 8.0, vec2f(0.0), vec2f(7.0))));
}

// True if uv is inside the image and its cell is filled. The range is half-open, as in the rasterizer: adjacent squares
// share no texel. A number from 1 to 2 has its eighths in the three highest of its 23 fraction bits; this avoids the
// conversion from float to integer, which is slow on GPUs.
fn is_filled(cells: vec2u, uv: vec2f) -> bool {
    let bits = bitcast<vec2u>(uv + 1.0) - 0x3f800000u;
    let rows = select(cells.x, cells.y, (bits.y & 0x400000u) != 0u);
    let cell = ((bits.y >> 17u) & 24u) + ((bits.x >> 20u) & 7u);
    return max(bits.x, bits.y) < 0x800000u && ((rows >> cell) & 1u) == 1u;
}

// True if any cell between two corners, in uv, is filled.
fn is_filled_between(cells: vec2u, low: vec2f, high: vec2f) -> bool {
    let first = cell_at(low);
    let last = cell_at(high);
    let columns = ((2u << last.x) - (1u << first.x)) * 0x01010101u;
    let upper = bytes_below(min(last.y + 1u, 4u)) & ~bytes_below(min(first.y, 4u));
    let lower = bytes_below(max(last.y, 3u) - 3u) & ~bytes_below(max(first.y, 4u) - 4u);
    return any((cells & vec2u(upper, lower) & vec2u(columns)) != vec2u(0u));
}

// True if both corners, in uv, are inside the image and all cells between them are filled.
fn is_full_between(cells: vec2u, low: vec2f, high: vec2f) -> bool {
    return all(low >= vec2f(0.0)) && all(high < vec2f(1.0)) && !is_filled_between(~cells, low, high);
}

// Returns a word whose lowest `count` bytes are set, up to four. Shifts twice, because WGSL takes shift amounts modulo
// 32.
fn bytes_below(count: u32) -> u32 {
    return ~((0xffffffffu << (count * 4u)) << (count * 4u));
}

// Returns the ray (as in view_position) through a position in the target, texels.
fn ray_through_texel(texel: vec2f) -> vec2f {
    let pixel = (texel + system.target_origin) * f32(system.scale);
    return ndc_from_pixel(pixel, view.size) * view.ray_scale + view.ray_offset;
}

// Returns the uv in a sprite's square at a texel.
fn uv_in_square(sprite: TileSprite, texel: vec2f) -> vec2f {
    let offset = texel - sprite.center_radius.xy;
    return vec2f(dot(sprite.uv_from_texels.xy, offset), dot(sprite.uv_from_texels.zw, offset)) + 0.5;
}

// Returns half the sides of the uv box that contains a rectangle of texels with half sides `half_size`, with a margin
// of 0.01 texels for rounding.
fn reach_in_square(sprite: TileSprite, half_size: vec2f) -> vec2f {
    let matrix = abs(sprite.uv_from_texels);
    return vec2f(dot(matrix.xy, half_size + 0.01), dot(matrix.zw, half_size + 0.01));
}

// False if the sprite's square has nothing within `reach` of uv.
fn square_fills(sprite: TileSprite, uv: vec2f, reach: vec2f) -> bool {
    return all(abs(uv - 0.5) <= reach + 0.5) && is_filled_between(sprite.filled, uv - reach, uv + reach);
}

// Returns the input that the rasterizer would give the fragment shader at a texel. `ray`: through the texel.
fn fragment_of(sprite: TileSprite, texel: vec2f, ray: vec2f, uv: vec2f) -> SpriteVertex {
    var out: SpriteVertex;
    out.position = vec4f(texel, 0.0, 1.0);
    out.center_radius = sprite.center_radius;
    out.amount_lod_frame_erosion = vec4f(sprite.amount, lod_of(sprite), 0.0, blend_and_erosion(sprite).y);
    out.rotation = sprite.rotation;
    out.weight = sprite.weight;
    if is_sphere() {
        out.view_position = view_position(ray, 1.0, view.orthographic);
    } else {
        out.uv = uv;
    }
    return out;
}
