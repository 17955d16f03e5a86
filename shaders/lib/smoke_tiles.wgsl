// Tiles of the lit target, by which transfer_lit draws only where there is smoke.

#import "lib/bindings.wgsl"
#import "lib/cells.wgsl"

// Distance of the farthest texel that an upsampler reads for a pixel, texels.
const UPSAMPLE_REACH: i32 = 2;
// Smallest side of a tile, pixels.
const MIN_TILE_PIXELS: u32 = 32u;

// Output of light_target or mark_cells: 1 for each cell with smoke, otherwise 0.
@group(3) @binding(3) var smoke_cells: texture_2d<f32>;
// Output of depth_slopes or mark_cells: 1 for each cell with a slope, otherwise 0.
@group(3) @binding(5) var slope_cells: texture_2d<f32>;

// Side of a tile, texels: a multiple of CELL_SIDE. `scale`: pixels per texel.
fn tile_side(scale: u32) -> u32 {
    let texels = (MIN_TILE_PIXELS + scale - 1u) / scale;
    return (texels + CELL_SIDE - 1u) / CELL_SIDE * CELL_SIDE;
}

// Number of tiles along each side of a target. `side`: of a tile, texels.
fn tile_counts(target_size: vec2u, side: u32) -> vec2u {
    return (target_size + side - 1u) / side;
}

// First texel of a tile. Tiles are numbered row by row.
fn tile_origin(tile: u32, target_size: vec2u, side: u32) -> vec2u {
    let across = tile_counts(target_size, side).x;
    return vec2u(tile % across, tile / across) * side;
}

// True if a cell is marked that holds one of the texels in a rectangle, or one that an upsampler reads for their pixels.
fn cells_have(cells: texture_2d<f32>, first_texel: vec2u, last_texel: vec2u) -> bool {
    let reach = select(UPSAMPLE_REACH, 0, system.scale == 1u);
    let end = vec2i(system.target_size) - 1;
    let low = clamp(vec2i(first_texel) - reach, vec2i(0), end) / i32(CELL_SIDE);
    let high = clamp(vec2i(last_texel) + reach, vec2i(0), end) / i32(CELL_SIDE);
    for (var y = low.y; y <= high.y; y++) {
        for (var x = low.x; x <= high.x; x++) {
            if textureLoad(cells, vec2i(x, y), 0).r > 0.0 {
                return true;
            }
        }
    }
    return false;
}

// True if a cell of a tile is marked.
fn tile_has(cells: texture_2d<f32>, first_texel: vec2u) -> bool {
    return cells_have(cells, first_texel, first_texel + tile_side(system.scale) - 1u);
}

// Pixel of the view at a corner of a tile; 0 or 1 along each side.
fn tile_corner(first_texel: vec2u, side: vec2f) -> vec2f {
    let texel = min(vec2f(first_texel) + side * f32(tile_side(system.scale)), system.target_size);
    return (texel + system.target_origin) * f32(system.scale);
}
