// What the tiled path counts with. Mirrors TilesUniform in src/formula/uniforms.rs.

struct Tiles {
    // Particles, and how often all of them are drawn.
    count: u32,
    loops: u32,
    // vec4f's before the first particle.
    first: u32,
    // Blocks of keys that are sorted side by side.
    blocks: u32,
    // Texels along a bin's side.
    bin_side: u32,
    // Bins along the target's sides.
    columns: u32,
    rows: u32,
    // Runs of sprites, front to back, that are put into bins side by side.
    runs: u32,
    // Words that all lists together hold.
    capacity: u32,
    // How much farther than a sprite that is hidden behind the scene all that follow it in a list are hidden, too, metres: 0 where lists
    // are in order of view depth, else more than there are. (No flag: lavapipe of Mesa 22.3 crashes where a branch in a loop hangs on
    // one in a uniform.)
    hidden_after: f32,
    padding0: u32,
    padding1: u32,
}

// The key of what is not shown: behind all that is.
const HIDDEN_KEY: u32 = 0xffffffffu;
// In place of where a bin's list begins: it has none, and reads all sprites.
const EVERYTHING: u32 = 0xffffffffu;

// Texels of a tile, where invocations walk alone: a row of lanes, and a column for each. ALONE in src/renderer/pass/tile_refine.rs.
const TILE_ALONE: vec2u = vec2u(8u, 4u);
// Parts of a bin. Of one of the usual size they are tiles.
const PARTS: vec2u = vec2u(4u, 8u);
// Sprites of a list that share a word for each part: a bit each. As many as there are parts. BATCH in src/renderer/pass/tile_refine.rs.
const BATCH_ALONE: u32 = 32u;

// Words for all parts of a list of so many.
fn words_of(length: u32) -> u32 {
    return (length + BATCH_ALONE - 1u) / BATCH_ALONE * BATCH_ALONE;
}

// Sprites of a run. RUN in src/renderer/pass/tile_bin.rs.
const RUN: u32 = 64u;

// Runs of so many sprites.
fn runs_of(count: u32) -> u32 {
    return (count + RUN - 1u) / RUN;
}

// What a frame turns out to have.
struct Tally {
    // Sprites to draw: the first of the sorted ones.
    shown: u32,
    // Words that the lists would need, but for those that are too long for 32 bits to count them all.
    entries: atomic<u32>,
}

// Texels from (x0, y0) to before (x1, y1), 16 bits each: x0 and y0, x1 and y1.
fn packed_rect(low: vec2u, high: vec2u) -> vec2u {
    return vec2u(low.x | (low.y << 16u), high.x | (high.y << 16u));
}

// True if a packed rectangle and one from `low` to before `high` share a texel.
fn rects_meet(rect: vec2u, low: vec2u, high: vec2u) -> bool {
    let first = vec2u(rect.x & 0xffffu, rect.x >> 16u);
    let last = vec2u(rect.y & 0xffffu, rect.y >> 16u);
    return all(first < high) && all(low < last);
}

// Bits that order as view depths do, near to far: of view z, from front to back. (Herf, "Radix tricks", 2001)
fn front_to_back_bits(view_z: f32) -> u32 {
    let bits = bitcast<u32>(view_z);
    return select(0x7fffffffu - bits, bits, bits >> 31u == 1u);
}

// True where a list of so many from an entry on is whole.
fn list_fits(first: u32, length: u32, capacity: u32) -> bool {
    return length <= capacity && first <= capacity - length;
}
