//! Tiles by which transfer_lit draws. WGSL: `shaders/lib/smoke_tiles.wgsl`.

use glam::UVec2;

/// Side of a cell, texels.
pub const CELL_SIDE: u32 = 4;

/// Smallest side of a tile, pixels: smaller ones fit the smoke better, and cost more vertices than they save pixels.
pub const MIN_TILE_PIXELS: u32 = 32;

/// Side of a tile, texels: a multiple of [`CELL_SIDE`]. `scale`: pixels per texel.
pub fn tile_side(scale: u32) -> u32 {
    MIN_TILE_PIXELS.div_ceil(scale).next_multiple_of(CELL_SIDE)
}

/// Number of tiles along each side of a target. `side`: of a tile, texels.
pub fn tile_counts(target_size: UVec2, side: u32) -> UVec2 {
    (target_size + side - 1) / side
}

/// First texel of a tile. Tiles are numbered row by row.
pub fn tile_origin(tile: u32, target_size: UVec2, side: u32) -> UVec2 {
    let across = tile_counts(target_size, side).x;
    UVec2::new(tile % across, tile / across) * side
}
