// tile_gather
// Copies the sprites' rectangles into sorted order, and counts the visible sprites, which tile_bin then lists.
//
// Reads   sorted keys and sprite indices, rectangles.
// Writes  sorted rectangles; the number of visible sprites; the indirect dispatch size of tile_bin.

#import "lib/tiles.wgsl"

@group(0) @binding(0) var<uniform> tiles: Tiles;
@group(0) @binding(1) var<storage, read> keys: array<u32>;
@group(0) @binding(2) var<storage, read> indices: array<u32>;
@group(0) @binding(3) var<storage, read> rects: array<vec2u>;
@group(0) @binding(4) var<storage, read_write> sorted_rects: array<vec2u>;
@group(0) @binding(5) var<storage, read_write> counters: TileCounters;
// Dispatch size: bins, 64 per workgroup; runs; 1.
@group(0) @binding(6) var<storage, read_write> workgroups: array<u32, 3>;

// True: sprites are sorted by key, hidden ones last.
override SORTED: bool = true;

fn is_visible(at: u32) -> bool {
    return !SORTED || keys[at] != HIDDEN_KEY;
}

@compute @workgroup_size(64)
fn gather(@builtin(global_invocation_id) invocation: vec3u) {
    let at = invocation.x;
    if at >= tiles.count {
        return;
    }
    sorted_rects[at] = rects[indices[at]];
    if at + 1u < tiles.count && is_visible(at + 1u) {
        return;
    }
    // The invocation of the last visible sprite writes the count; if none is visible, the first invocation does.
    if is_visible(at) || at == 0u {
        let visible = select(0u, at + 1u, is_visible(at));
        counters.visible = visible;
        workgroups[0] = (tiles.columns * tiles.rows + 63u) / 64u;
        workgroups[1] = run_count(visible);
        workgroups[2] = 1u;
    }
}
