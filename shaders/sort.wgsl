// sort
// Stable radix sort, 8 bits at a time: counts the digits block by block, sums up the counts, and moves every key to its
// place. Few keys are sorted in one dispatch, which counts the smaller ones for every key. The result is the same on
// every device and in every run: nothing depends on subgroups or on the order of atomics.
//
// Reads   keys, and the particle indices that belong to them.
// Writes  the same, sorted by one digit, or whole.
// Source  Merrill and Grimshaw, "High performance and scalable radix sorting", 2011; rank sort: Knuth, "The art of
//         computer programming" 3, 5.2 (comparison counting).

#import "lib/tiles.wgsl"
#import "lib/scan.wgsl"

@group(0) @binding(0) var<uniform> tiles: Tiles;
@group(0) @binding(1) var<storage, read> keys: array<u32>;
@group(0) @binding(2) var<storage, read> indices: array<u32>;
@group(0) @binding(3) var<storage, read_write> sorted_keys: array<u32>;
@group(0) @binding(4) var<storage, read_write> sorted_indices: array<u32>;
// By digit, then by block: the count, later the number of keys of that digit in earlier blocks. If WITHOUT_SCAN: by
// block, then by digit.
@group(0) @binding(5) var<storage, read_write> counts: array<u32>;
// Total number of keys per digit.
@group(0) @binding(6) var<storage, read_write> totals: array<u32>;

// Lowest bit of the digit.
override SHIFT: u32 = 0u;
// Few blocks: every workgroup sums up the counts of all blocks itself.
override WITHOUT_SCAN: bool = false;

const DIGITS: u32 = 256u;
// Keys of a block per invocation. BLOCK in src/renderer/pass/sort.rs is ROUNDS times the invocations of a workgroup.
const ROUNDS: u32 = 4u;

var<workgroup> digit_counts: array<atomic<u32>, DIGITS>;
// One bit for every invocation whose key has the digit, 32 per word.
var<workgroup> digit_bits: array<atomic<u32>, 2048>;
var<workgroup> next_positions: array<u32, DIGITS>;

fn digit_of(key: u32) -> u32 {
    return (key >> SHIFT) & (DIGITS - 1u);
}

@compute @workgroup_size(256)
fn count_digits(@builtin(local_invocation_index) local: u32, @builtin(workgroup_id) block: vec3u) {
    for (var round = 0u; round < ROUNDS; round++) {
        let at = (block.x * ROUNDS + round) * DIGITS + local;
        if at < tiles.count {
            atomicAdd(&digit_counts[digit_of(keys[at])], 1u);
        }
    }
    workgroupBarrier();
    counts[select(local * tiles.blocks + block.x, block.x * DIGITS + local, WITHOUT_SCAN)] = atomicLoad(&digit_counts[local]);
}

// One workgroup per digit.
@compute @workgroup_size(256)
fn sum_counts(@builtin(local_invocation_index) local: u32, @builtin(workgroup_id) digit: vec3u) {
    var before = 0u;
    for (var first = 0u; first < tiles.blocks; first += SCAN_SIZE) {
        let at = digit.x * tiles.blocks + first + local;
        let is_inside = first + local < tiles.blocks;
        var count = 0u;
        if is_inside {
            count = counts[at];
        }
        let sum = inclusive_sum(local, count);
        if is_inside {
            counts[at] = before + sum - count;
        }
        before += scan_sums[SCAN_SIZE - 1u];
    }
    if local == 0u {
        totals[digit.x] = before;
    }
}

// Returns the number of keys that have a digit, and how many of these keys are in earlier blocks.
fn total_and_before(digit: u32, block: u32) -> vec2u {
    if WITHOUT_SCAN {
        var sums = vec2u(0u);
        for (var other = 0u; other < tiles.blocks; other++) {
            let count = counts[other * DIGITS + digit];
            sums += vec2u(count, select(0u, count, other < block));
        }
        return sums;
    }
    return vec2u(totals[digit], counts[digit * tiles.blocks + block]);
}

@compute @workgroup_size(256)
fn scatter(@builtin(local_invocation_index) local: u32, @builtin(workgroup_id) block: vec3u) {
    let counted = total_and_before(local, block.x);
    next_positions[local] = inclusive_sum(local, counted.x) - counted.x + counted.y;
    let word = local / 32u;
    let bit = local % 32u;
    for (var round = 0u; round < ROUNDS; round++) {
        for (var i = local; i < 2048u; i += DIGITS) {
            atomicStore(&digit_bits[i], 0u);
        }
        workgroupBarrier();
        let at = (block.x * ROUNDS + round) * DIGITS + local;
        let is_inside = at < tiles.count;
        var key = 0u;
        var digit = 0u;
        if is_inside {
            key = keys[at];
            digit = digit_of(key);
            atomicOr(&digit_bits[word * DIGITS + digit], 1u << bit);
        }
        workgroupBarrier();
        // Invocations whose key has the digit: those before this one, and all.
        var rank = 0u;
        var all = 0u;
        for (var i = 0u; i < 8u; i++) {
            let held = atomicLoad(&digit_bits[i * DIGITS + digit]);
            let in_front = select(select(0u, 0xffffffffu, i < word), (1u << bit) - 1u, i == word);
            rank += countOneBits(held & in_front);
            all += countOneBits(held);
        }
        let position = next_positions[digit] + rank;
        workgroupBarrier();
        if is_inside {
            sorted_keys[position] = key;
            sorted_indices[position] = indices[at];
            if rank + 1u == all {
                next_positions[digit] = position + 1u;
            }
        }
    }
}

// Keys per workgroup of `rank`; RANKED_KEYS in src/renderer/pass/sort.rs.
const RANKED_KEYS: u32 = 8u;
// Invocations that count for the same key.
const COUNTERS: u32 = 32u;

// Number of keys that come before each key of the workgroup.
var<workgroup> ranks: array<atomic<u32>, RANKED_KEYS>;

// Moves every key to its position in one dispatch, for few keys: each is compared with all.
@compute @workgroup_size(256)
fn rank(@builtin(local_invocation_index) local: u32, @builtin(workgroup_id) block: vec3u) {
    let ranked = local / COUNTERS;
    let at = block.x * RANKED_KEYS + ranked;
    let key = keys[min(at, tiles.count - 1u)];
    var before = 0u;
    var other = local % COUNTERS;
    // Of equal keys, those with smaller indices come before it. Two loops have one comparison for each key.
    for (; other < min(at, tiles.count); other += COUNTERS) {
        before += u32(keys[other] <= key);
    }
    for (; other < tiles.count; other += COUNTERS) {
        before += u32(keys[other] < key);
    }
    atomicAdd(&ranks[ranked], before);
    workgroupBarrier();
    if local % COUNTERS == 0u && at < tiles.count {
        let position = atomicLoad(&ranks[ranked]);
        sorted_keys[position] = key;
        sorted_indices[position] = indices[at];
    }
}
