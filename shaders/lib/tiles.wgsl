// Uniforms, constants and counts of the tiled path. Tiles mirrors TilesUniform in crates/haze_core/src/formula/uniforms.rs.

struct Tiles {
    // Number of particles, and how often all particles are drawn.
    count: u32,
    loops: u32,
    // Offset of the first particle, in units of vec4f.
    first: u32,
    // Blocks of keys that the sort handles in parallel.
    blocks: u32,
    // Side of a bin, texels.
    bin_side: u32,
    // Number of bins along the target's sides.
    columns: u32,
    rows: u32,
    // Runs of sprites, front to back, that are binned in parallel.
    runs: u32,
    // Words of the buffer that all lists share.
    capacity: u32,
    // Distance behind a hidden sprite at which all later sprites of a list are hidden too, metres: 0 if lists are
    // ordered by view depth, else larger than any depth. (Not a bool: see docs/tiled.md.)
    occlusion_margin: f32,
    padding0: u32,
    padding1: u32,
}

// Key of hidden sprites: sorts behind all visible ones.
const HIDDEN_KEY: u32 = 0xffffffffu;
// Start of the list of a bin without a list: the bin reads all sprites.
const NO_LIST: u32 = 0xffffffffu;

// Texels of a tile in per-invocation traversal: one row of lanes, each with one column. PER_INVOCATION_TILE in
// src/renderer/pass/tile_refine.rs.
const PER_INVOCATION_TILE: vec2u = vec2u(8u, 4u);
// Parts of a bin. With the usual bin side of 32 texels, a part is a tile.
const PARTS: vec2u = vec2u(4u, 8u);
// Sprites of a list that share one word per part, one bit each. Equal to the number of parts. In crates/haze_core/src/formula/tiles.rs
// too.
const BITS_PER_WORD: u32 = 32u;

// Returns the number of words that tile_refine needs for a list of this length.
fn refine_words(length: u32) -> u32 {
    return (length + BITS_PER_WORD - 1u) / BITS_PER_WORD * BITS_PER_WORD;
}

// Sprites per run. RUN in crates/haze_core/src/formula/tiles.rs.
const RUN: u32 = 64u;

// Returns the number of runs of `count` sprites.
fn run_count(count: u32) -> u32 {
    return (count + RUN - 1u) / RUN;
}

// Counts of a frame.
struct TileCounters {
    // Number of visible sprites: the first of the sorted ones.
    visible: u32,
    // Words that the lists need, without those that are too long to be counted in 32 bits.
    entries: atomic<u32>,
}

// Packs the texels from (x0, y0) to before (x1, y1), 16 bits each: x0 and y0, x1 and y1.
fn packed_rect(low: vec2u, high: vec2u) -> vec2u {
    return vec2u(low.x | (low.y << 16u), high.x | (high.y << 16u));
}

// True if a packed rectangle and the rectangle from `low` to before `high` share a texel.
fn rects_meet(rect: vec2u, low: vec2u, high: vec2u) -> bool {
    let first = vec2u(rect.x & 0xffffu, rect.x >> 16u);
    let last = vec2u(rect.y & 0xffffu, rect.y >> 16u);
    return all(first < high) && all(low < last);
}

// Maps view z to bits that sort by view depth, near to far. (Herf, "Radix tricks", 2001)
fn front_to_back_bits(view_z: f32) -> u32 {
    let bits = bitcast<u32>(view_z);
    return select(0x7fffffffu - bits, bits, bits >> 31u == 1u);
}
