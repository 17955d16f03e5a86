// tile_bin
// Lists, for every bin of the target, the sprites that touch it, front to back. The lists share one buffer, and each is
// only as long as it must be. If a list overflows the buffer, it is dropped, and its bin reads all sprites instead.
//
// Reads   sorted sprite indices and rectangles.
// Writes  sprite lists, and the start and length of each.

#import "lib/tiles.wgsl"
#import "lib/scan.wgsl"

@group(0) @binding(0) var<uniform> tiles: Tiles;
@group(0) @binding(1) var<storage, read> indices: array<u32>;
@group(0) @binding(2) var<storage, read> sorted_rects: array<vec2u>;
// By bin, then by run: the number of sprites, later the position in the bin's list at which the run begins.
@group(0) @binding(3) var<storage, read_write> counts: array<u32>;
@group(0) @binding(4) var<storage, read_write> lists: array<u32>;
// Start of each bin's list, and its length.
@group(0) @binding(5) var<storage, read_write> bins: array<vec2u>;
@group(0) @binding(6) var<storage, read_write> counters: TileCounters;

fn low_of_bin(bin: u32) -> vec2u {
    return vec2u(bin % tiles.columns, bin / tiles.columns) * tiles.bin_side;
}

@compute @workgroup_size(64)
fn count_sprites(@builtin(global_invocation_id) invocation: vec3u) {
    let bin = invocation.x;
    let run = invocation.y;
    if bin >= tiles.columns * tiles.rows {
        return;
    }
    let low = low_of_bin(bin);
    let end = min(run * RUN + RUN, counters.visible);
    var count = 0u;
    for (var at = run * RUN; at < end; at++) {
        count += u32(rects_meet(sorted_rects[at], low, low + tiles.bin_side));
    }
    counts[bin * tiles.runs + run] = count;
}

// Allocates a bin's list of `length` sprites and `more` further words. Lists are in no particular order, but the
// content of each is deterministic. A list that is longer than its fraction of a 32-bit count is dropped, so that the sum
// cannot wrap. (Adding only as far as there is room, by compare-exchange, takes a millisecond if thousands of bins
// contend.)
fn bin_list(length: u32, more: u32) -> vec2u {
    let fraction = 0xffffffffu / (tiles.columns * tiles.rows);
    let is_counted = length <= fraction && more <= fraction - length;
    let size = select(0u, length + more, is_counted);
    let first = atomicAdd(&counters.entries, size);
    let fits = is_counted && list_fits(first, size, tiles.capacity);
    return select(vec2u(NO_LIST, counters.visible), vec2u(first, length), fits);
}

// Runs that count_sprites has counted.
var<workgroup> counted_runs: u32;

// One workgroup per bin.
@compute @workgroup_size(256)
fn allocate(@builtin(local_invocation_index) local: u32, @builtin(workgroup_id) bin: vec3u) {
    if local == 0u {
        counted_runs = run_count(counters.visible);
    }
    // Browsers refuse barriers in a loop whose end could differ among invocations.
    let runs = workgroupUniformLoad(&counted_runs);
    var length = 0u;
    for (var first = 0u; first < runs; first += SCAN_SIZE) {
        let at = bin.x * tiles.runs + first + local;
        let is_inside = first + local < runs;
        var count = 0u;
        if is_inside {
            count = counts[at];
        }
        let sum = inclusive_sum(local, count);
        if is_inside {
            counts[at] = length + sum - count;
        }
        length += scan_sums[SCAN_SIZE - 1u];
    }
    if local == 0u {
        bins[bin.x] = bin_list(length, 0u);
    }
}

// One bit for every sprite that touches the workgroup's bin, 32 per word. MAX_SPRITES_SINGLE_DISPATCH in
// src/renderer/pass/tile_bin.rs is their number.
var<workgroup> touching: array<atomic<u32>, 1024>;
var<workgroup> begin: u32;

// For few sprites: counts them and fills the list in one dispatch. One workgroup per bin.
@compute @workgroup_size(256)
fn build_lists_in_one_dispatch(@builtin(local_invocation_index) local: u32, @builtin(workgroup_id) bin: vec3u) {
    let low = low_of_bin(bin.x);
    let visible = counters.visible;
    for (var at = local; at < visible; at += SCAN_SIZE) {
        if rects_meet(sorted_rects[at], low, low + tiles.bin_side) {
            atomicOr(&touching[at / 32u], 1u << (at % 32u));
        }
    }
    workgroupBarrier();
    // Words that each invocation processes from here on.
    let each = (tiles.count + 32u * SCAN_SIZE - 1u) / (32u * SCAN_SIZE);
    var count = 0u;
    for (var word = local * each; word < local * each + each; word++) {
        count += countOneBits(atomicLoad(&touching[word]));
    }
    let sum = inclusive_sum(local, count);
    if local == SCAN_SIZE - 1u {
        let list = bin_list(sum, 0u);
        bins[bin.x] = list;
        begin = list.x;
    }
    if workgroupUniformLoad(&begin) == NO_LIST {
        return;
    }
    var position = begin + sum - count;
    for (var word = local * each; word < local * each + each; word++) {
        for (var bits = atomicLoad(&touching[word]); bits != 0u; bits &= bits - 1u) {
            lists[position] = indices[word * 32u + firstTrailingBit(bits)];
            position++;
        }
    }
}

// For per-invocation traversal: one invocation per bin. Allocates room for the bits of tile_refine too.
@compute @workgroup_size(64)
fn allocate_per_invocation(@builtin(global_invocation_id) invocation: vec3u) {
    let bin = invocation.x;
    if bin >= tiles.columns * tiles.rows {
        return;
    }
    var length = 0u;
    for (var run = 0u; run < tiles.runs; run++) {
        let count = counts[bin * tiles.runs + run];
        counts[bin * tiles.runs + run] = length;
        length += count;
    }
    bins[bin] = bin_list(length, refine_words(length));
}

// Bins that a rectangle touches: from `first` to before `last`.
struct TouchedBins {
    first: vec2u,
    last: vec2u,
}

fn touched_bins(rect: vec2u) -> TouchedBins {
    let low = vec2u(rect.x & 0xffffu, rect.x >> 16u);
    let high = vec2u(rect.y & 0xffffu, rect.y >> 16u);
    return TouchedBins(low / tiles.bin_side, (high + tiles.bin_side - 1u) / tiles.bin_side);
}

// Same result as count_sprites and fill, for per-invocation traversal: one invocation per run, which visits each sprite
// once and only the bins that it touches.
@compute @workgroup_size(8)
fn count_per_run(@builtin(global_invocation_id) invocation: vec3u) {
    let run = invocation.x;
    if run >= tiles.runs {
        return;
    }
    for (var bin = 0u; bin < tiles.columns * tiles.rows; bin++) {
        counts[bin * tiles.runs + run] = 0u;
    }
    let end = min(run * RUN + RUN, counters.visible);
    for (var at = run * RUN; at < end; at++) {
        let touched = touched_bins(sorted_rects[at]);
        for (var row = touched.first.y; row < touched.last.y; row++) {
            for (var column = touched.first.x; column < touched.last.x; column++) {
                counts[(row * tiles.columns + column) * tiles.runs + run] += 1u;
            }
        }
    }
}

@compute @workgroup_size(8)
fn fill_per_run(@builtin(global_invocation_id) invocation: vec3u) {
    let run = invocation.x;
    if run >= tiles.runs {
        return;
    }
    let end = min(run * RUN + RUN, counters.visible);
    for (var at = run * RUN; at < end; at++) {
        let index = indices[at];
        let touched = touched_bins(sorted_rects[at]);
        for (var row = touched.first.y; row < touched.last.y; row++) {
            for (var column = touched.first.x; column < touched.last.x; column++) {
                let bin = row * tiles.columns + column;
                let list = bins[bin].x;
                if list != NO_LIST {
                    let position = counts[bin * tiles.runs + run];
                    lists[list + position] = index;
                    counts[bin * tiles.runs + run] = position + 1u;
                }
            }
        }
    }
}

@compute @workgroup_size(64)
fn fill(@builtin(global_invocation_id) invocation: vec3u) {
    let bin = invocation.x;
    let run = invocation.y;
    if bin >= tiles.columns * tiles.rows {
        return;
    }
    let list = bins[bin].x;
    if list == NO_LIST {
        return;
    }
    let low = low_of_bin(bin);
    var position = list + counts[bin * tiles.runs + run];
    let end = min(run * RUN + RUN, counters.visible);
    for (var at = run * RUN; at < end; at++) {
        if rects_meet(sorted_rects[at], low, low + tiles.bin_side) {
            lists[position] = indices[at];
            position++;
        }
    }
}

// True if a list of `length` words that starts at `first` fits.
fn list_fits(first: u32, length: u32, capacity: u32) -> bool {
    return length <= capacity && first <= capacity - length;
}
