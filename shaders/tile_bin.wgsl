// tile_bin
// What    Lists, for every bin of the target, the sprites that touch it, front to back. Each list is as long as it need be; those
//         that find no more room are left out, and their bins read all sprites instead.
// Reads   sorted numbers and rectangles.
// Writes  lists of sprites, and where each begins.

#import "lib/tiles.wgsl"
#import "lib/scan.wgsl"

@group(0) @binding(0) var<uniform> tiles: Tiles;
@group(0) @binding(1) var<storage, read> numbers: array<u32>;
@group(0) @binding(2) var<storage, read> sorted_rects: array<vec2u>;
// By bin, and by run in it: how many sprites there are, and then where they begin.
@group(0) @binding(3) var<storage, read_write> counts: array<u32>;
@group(0) @binding(4) var<storage, read_write> lists: array<u32>;
// Where the bin's list begins, and its length.
@group(0) @binding(5) var<storage, read_write> bins: array<vec2u>;
@group(0) @binding(6) var<storage, read_write> tally: Tally;

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
    let end = min(run * RUN + RUN, tally.shown);
    var count = 0u;
    for (var at = run * RUN; at < end; at++) {
        count += u32(rects_meet(sorted_rects[at], low, low + tiles.bin_side));
    }
    counts[bin * tiles.runs + run] = count;
}

// A bin's list of so many, and as many words more. Lists lie in any order, what is in them does not. A list that is longer than its
// share of what 32 bits count is left out, so that none can wrap. (To add only as far as there is room, by exchange, takes a
// millisecond where thousands of bins wait for each other.)
fn bin_list(length: u32, more: u32) -> vec2u {
    let share = 0xffffffffu / (tiles.columns * tiles.rows);
    let is_counted = length <= share && more <= share - length;
    let size = select(0u, length + more, is_counted);
    let first = atomicAdd(&tally.entries, size);
    let fits = is_counted && list_fits(first, size, tiles.capacity);
    return select(vec2u(EVERYTHING, tally.shown), vec2u(first, length), fits);
}

// One workgroup for each bin.
@compute @workgroup_size(256)
fn allocate(@builtin(local_invocation_index) local: u32, @builtin(workgroup_id) bin: vec3u) {
    // Those that count_sprites came to.
    let runs = runs_of(tally.shown);
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

// A bit for every sprite that touches the workgroup's bin, 32 in a word. FEW in src/renderer/pass/tile_bin.rs has as many.
var<workgroup> touching: array<atomic<u32>, 1024>;
var<workgroup> begin: u32;

// Where sprites are few: counts them and fills the list, too. One workgroup for each bin.
@compute @workgroup_size(256)
fn list_few(@builtin(local_invocation_index) local: u32, @builtin(workgroup_id) bin: vec3u) {
    let low = low_of_bin(bin.x);
    let shown = tally.shown;
    for (var at = local; at < shown; at += SCAN_SIZE) {
        if rects_meet(sorted_rects[at], low, low + tiles.bin_side) {
            atomicOr(&touching[at / 32u], 1u << (at % 32u));
        }
    }
    workgroupBarrier();
    // Each invocation goes on with so many words.
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
    if workgroupUniformLoad(&begin) == EVERYTHING {
        return;
    }
    var place = begin + sum - count;
    for (var word = local * each; word < local * each + each; word++) {
        for (var bits = atomicLoad(&touching[word]); bits != 0u; bits &= bits - 1u) {
            lists[place] = numbers[word * 32u + firstTrailingBit(bits)];
            place++;
        }
    }
}

// Where invocations walk alone: one invocation for each bin, and with room for what tile_refine finds of each sprite.
@compute @workgroup_size(64)
fn allocate_alone(@builtin(global_invocation_id) invocation: vec3u) {
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
    bins[bin] = bin_list(length, words_of(length));
}

// Bins from the first to before the last that a rectangle touches.
struct TouchedBins {
    first: vec2u,
    last: vec2u,
}

fn touched_bins(rect: vec2u) -> TouchedBins {
    let low = vec2u(rect.x & 0xffffu, rect.x >> 16u);
    let high = vec2u(rect.y & 0xffffu, rect.y >> 16u);
    return TouchedBins(low / tiles.bin_side, (high + tiles.bin_side - 1u) / tiles.bin_side);
}

// The same as count_sprites and fill, one invocation for each run: goes from sprite to sprite, and to no bin that it does not touch.
@compute @workgroup_size(8)
fn count_alone(@builtin(global_invocation_id) invocation: vec3u) {
    let run = invocation.x;
    if run >= tiles.runs {
        return;
    }
    for (var bin = 0u; bin < tiles.columns * tiles.rows; bin++) {
        counts[bin * tiles.runs + run] = 0u;
    }
    let end = min(run * RUN + RUN, tally.shown);
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
fn fill_alone(@builtin(global_invocation_id) invocation: vec3u) {
    let run = invocation.x;
    if run >= tiles.runs {
        return;
    }
    let end = min(run * RUN + RUN, tally.shown);
    for (var at = run * RUN; at < end; at++) {
        let number = numbers[at];
        let touched = touched_bins(sorted_rects[at]);
        for (var row = touched.first.y; row < touched.last.y; row++) {
            for (var column = touched.first.x; column < touched.last.x; column++) {
                let bin = row * tiles.columns + column;
                let list = bins[bin].x;
                if list != EVERYTHING {
                    let place = counts[bin * tiles.runs + run];
                    lists[list + place] = number;
                    counts[bin * tiles.runs + run] = place + 1u;
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
    if list == EVERYTHING {
        return;
    }
    let low = low_of_bin(bin);
    var place = list + counts[bin * tiles.runs + run];
    let end = min(run * RUN + RUN, tally.shown);
    for (var at = run * RUN; at < end; at++) {
        if rects_meet(sorted_rects[at], low, low + tiles.bin_side) {
            lists[place] = numbers[at];
            place++;
        }
    }
}
