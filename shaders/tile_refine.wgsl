// tile_refine
// What    Lists, for every tile of a few texels, those of its bin's sprites that it may show something of, front to back. Where
//         invocations walk alone: what is found once here, every texel would find there.
//         `mark`: in which parts of its bin a sprite may be seen; `refine`: the lists of tiles, by that and by depth.
// Reads   lists of bins, sprites, rectangles, reduced depth (or the host's own).
// Writes  lists of tiles, and where each begins. One that finds no more room is its bin's.

#import "lib/tiles.wgsl"
#import "lib/tile_sprite.wgsl"

@group(3) @binding(0) var<uniform> tiles: Tiles;
@group(3) @binding(1) var<storage, read> sprites: array<TileSprite>;
@group(3) @binding(2) var<storage, read> rects: array<vec2u>;
@group(3) @binding(3) var<storage, read> bins: array<vec2u>;
@group(3) @binding(4) var tested_depth: texture_2d<f32>;
@group(3) @binding(5) var<storage, read_write> lists: array<u32>;
@group(3) @binding(6) var<storage, read_write> tile_lists: array<vec2u>;
@group(3) @binding(7) var<storage, read_write> tally: Tally;

// Parts of a bin of the usual size are tiles. A bit for each.
const PARTS: vec2u = vec2u(4u, 8u);

// The parts of a bin in which a sprite may be seen.
fn marks_of(number: u32, low: vec2u) -> u32 {
    let part = tiles.bin_side / PARTS;
    var marks = 0u;
    if is_sphere() {
        let rect = rects[number];
        for (var bit = 0u; bit < 32u; bit++) {
            let first = low + vec2u(bit % PARTS.x, bit / PARTS.x) * part;
            marks |= select(0u, 1u << bit, rects_meet(rect, first, first + part));
        }
    } else {
        let sprite = sprites[number];
        let half_size = 0.5 * vec2f(part - 1u);
        for (var bit = 0u; bit < 32u; bit++) {
            let first = low + vec2u(bit % PARTS.x, bit / PARTS.x) * part;
            marks |= select(0u, 1u << bit, square_fills(sprite, vec2f(first) + 0.5 * vec2f(part), half_size));
        }
    }
    return marks;
}

@compute @workgroup_size(64)
fn mark(@builtin(local_invocation_index) local: u32, @builtin(workgroup_id) bin: vec3u) {
    let list = bins[bin.x];
    let count = select(list.y, 0u, list.x == EVERYTHING);
    let low = vec2u(bin.x % tiles.columns, bin.x / tiles.columns) * tiles.bin_side;
    for (var at = local; at < count; at += 64u) {
        let number = lists[list.x + at];
        lists[list.x + count + at] = marks_of(number, low);
        lists[list.x + 2u * count + at] = bitcast<u32>(sprite_front(sprites[number].centre_radius));
    }
}

// The farthest view depth at which a tile shows anything.
fn shown_depth(low: vec2u, high: vec2u) -> f32 {
    var farthest = 0.0;
    for (var y = low.y; y < high.y; y++) {
        for (var x = low.x; x < high.x; x++) {
            farthest = max(farthest, tested_view_depth(textureLoad(tested_depth, vec2u(x, y), 0).r));
        }
    }
    return farthest + system.fade_through;
}

@compute @workgroup_size(8, 8)
fn refine(@builtin(global_invocation_id) invocation: vec3u) {
    let size = vec2u(system.target_size);
    let all_tiles = tiles_along(size);
    let low = invocation.xy * TILE_ALONE;
    if any(low >= size) {
        return;
    }
    let end = shown_depth(low, min(low + TILE_ALONE, size));
    let bin = low / tiles.bin_side;
    let list = bins[bin.y * tiles.columns + bin.x];
    let part = low % tiles.bin_side / (tiles.bin_side / PARTS);
    let bit = part.y * PARTS.x + part.x;
    let count = select(list.y, 0u, list.x == EVERYTHING);
    let marks = list.x + count;
    let fronts = marks + count;
    var length = 0u;
    for (var at = 0u; at < count; at++) {
        length += u32(bitcast<f32>(lists[fronts + at]) <= end) & (lists[marks + at] >> bit);
    }
    // As bin_list() has it.
    let is_counted = length <= HALF / (all_tiles.x * all_tiles.y);
    let first = atomicAdd(&tally.entries, select(0u, length, is_counted));
    let fits = is_counted && list.x != EVERYTHING && list_fits(first, length, tiles.capacity);
    tile_lists[invocation.y * all_tiles.x + invocation.x] = select(list, vec2u(first, length), fits);
    // Mesa 22 crashes where the loop is not the first one again.
    let end_of_list = first + select(0u, length, fits);
    var place = first;
    for (var at = 0u; at < count; at++) {
        let is_shown = u32(bitcast<f32>(lists[fronts + at]) <= end) & (lists[marks + at] >> bit);
        if place != end_of_list && (is_shown & 1u) == 1u {
            lists[place] = lists[list.x + at];
            place++;
        }
    }
}
