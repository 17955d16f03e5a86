// tile_gather
// What    Puts the rectangles of sprites in order, as their numbers are, and finds how many are shown: so many tile_bin lists.
// Reads   sorted keys and numbers, rectangles.
// Writes  sorted rectangles; how many sprites there are to draw; workgroups for those that list them.

#import "lib/tiles.wgsl"

@group(0) @binding(0) var<uniform> tiles: Tiles;
@group(0) @binding(1) var<storage, read> keys: array<u32>;
@group(0) @binding(2) var<storage, read> numbers: array<u32>;
@group(0) @binding(3) var<storage, read> rects: array<vec2u>;
@group(0) @binding(4) var<storage, read_write> sorted_rects: array<vec2u>;
@group(0) @binding(5) var<storage, read_write> tally: Tally;
// By bins, 64 to each, and runs.
@group(0) @binding(6) var<storage, read_write> workgroups: array<u32, 3>;

// Sprites come in order of their keys, and the hidden ones last.
override SORTED: bool = true;

fn is_shown(at: u32) -> bool {
    return !SORTED || keys[at] != HIDDEN_KEY;
}

@compute @workgroup_size(64)
fn gather(@builtin(global_invocation_id) invocation: vec3u) {
    let at = invocation.x;
    if at >= tiles.count {
        return;
    }
    sorted_rects[at] = rects[numbers[at]];
    if at + 1u < tiles.count && is_shown(at + 1u) {
        return;
    }
    // The last that is shown knows how many are; the first, if none is.
    if is_shown(at) || at == 0u {
        let shown = select(0u, at + 1u, is_shown(at));
        tally.shown = shown;
        workgroups[0] = (tiles.columns * tiles.rows + 63u) / 64u;
        workgroups[1] = runs_of(shown);
        workgroups[2] = 1u;
    }
}
