//! Sprite data of the tiled path. WGSL: `shaders/lib/tile_sprite.wgsl`.

use glam::{UVec2, Vec2, Vec4, Vec4Swizzles};

use super::sprite::FlipbookFrames;

/// Cells of a sprite image along each side.
const CELLS: u32 = 8;

/// Packs two frames of 12 bits each, and a mip level of 8 bits.
pub fn packed_frames(frames: FlipbookFrames, lod: f32) -> u32 {
    frames.first as u32 | (frames.second as u32) << 12 | (lod.min(255.0) as u32) << 24
}

/// Frames of a packed word, with the weight of the second.
pub fn frames_of(frames_lod: u32, blend: f32) -> FlipbookFrames {
    FlipbookFrames { first: (frames_lod % 0x1000) as i32, second: (frames_lod / 0x1000 % 0x1000) as i32, blend }
}

/// Mip level of a packed word.
pub fn lod_of(frames_lod: u32) -> f32 {
    (frames_lod / 0x100_0000) as f32
}

/// Cell of the sprite image at uv, or the nearest one.
pub fn cell_at(uv: Vec2) -> UVec2 {
    (uv * CELLS as f32).clamp(Vec2::ZERO, Vec2::splat((CELLS - 1) as f32)).as_uvec2()
}

/// True if a cell is filled. `cells` has one byte per row, from the top.
fn is_cell_filled(cells: UVec2, cell: UVec2) -> bool {
    let rows = if cell.y < 4 { cells.x } else { cells.y };
    rows >> (CELLS * (cell.y % 4) + cell.x) & 1 == 1
}

/// True if uv is inside the image, 0 to before 1, and its cell is filled.
pub fn is_filled(cells: UVec2, uv: Vec2) -> bool {
    uv.cmpge(Vec2::ZERO).all() && uv.cmplt(Vec2::ONE).all() && is_cell_filled(cells, cell_at(uv))
}

/// True if any cell between two corners, in uv, is filled.
pub fn is_filled_between(cells: UVec2, low: Vec2, high: Vec2) -> bool {
    let first = cell_at(low);
    let last = cell_at(high);
    (first.y..=last.y).any(|y| (first.x..=last.x).any(|x| is_cell_filled(cells, UVec2::new(x, y))))
}

/// True if both corners, in uv, are inside the image and all cells between them are filled.
pub fn is_full_between(cells: UVec2, low: Vec2, high: Vec2) -> bool {
    let first = cell_at(low);
    let last = cell_at(high);
    let is_inside = low.cmpge(Vec2::ZERO).all() && high.cmplt(Vec2::ONE).all();
    is_inside && (first.y..=last.y).all(|y| (first.x..=last.x).all(|x| is_cell_filled(cells, UVec2::new(x, y))))
}

/// A word whose lowest `count` bytes are set, up to four.
pub fn bytes_below(count: u32) -> u32 {
    ((1_u64 << (8 * count)) - 1) as u32
}

/// uv in a sprite's square at a texel. `uv_from_texels`: rows of the matrix from texels, relative to the center, to uv.
pub fn uv_in_square(uv_from_texels: Vec4, center: Vec2, texel: Vec2) -> Vec2 {
    let offset = texel - center;
    Vec2::new(uv_from_texels.xy().dot(offset), uv_from_texels.zw().dot(offset)) + 0.5
}

/// Half the sides of the uv box that contains a rectangle of texels with half sides `half_size`, with a margin of 0.01
/// texels for rounding.
pub fn reach_in_square(uv_from_texels: Vec4, half_size: Vec2) -> Vec2 {
    let matrix = uv_from_texels.abs();
    let half_size = half_size + 0.01;
    Vec2::new(matrix.xy().dot(half_size), matrix.zw().dot(half_size))
}

/// False if the sprite's square has nothing within `reach` of uv.
pub fn square_fills(cells: UVec2, uv: Vec2, reach: Vec2) -> bool {
    let is_near = (uv - 0.5).abs().cmple(reach + 0.5).all();
    is_near && is_filled_between(cells, uv - reach, uv + reach)
}

/// True if a texel lies in a sprite. `uv`: position in the sprite's square.
pub fn covers(is_sphere: bool, uv: Vec2) -> bool {
    is_sphere || uv.cmpge(Vec2::ZERO).all() && uv.cmplt(Vec2::ONE).all()
}

/// True if a sprite may have something at `uv`, a position in its square.
pub fn touches(is_sphere: bool, cells: UVec2, uv: Vec2) -> bool {
    is_sphere || is_filled(cells, uv)
}

/// Approximate amount of a sprite at a position in its square: puffs are thick in the center and thin out.
pub fn approximate_amount(amount: f32, uv: Vec2) -> f32 {
    let thickness = (1.0 - (2.0 * uv - 1.0).length_squared()).max(0.0);
    amount * thickness * thickness
}
