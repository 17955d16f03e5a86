//! Counts, rectangles and sort keys of the tiled path. WGSL: `shaders/lib/tiles.wgsl`, `shaders/tile_bin.wgsl`,
//! `shaders/tile_gather.wgsl`, `shaders/tile_accumulate.wgsl` and `shaders/sort.wgsl`.

use glam::UVec2;

use super::uniforms::TilesUniform;

/// Start of the list of a bin without a list: the bin reads all sprites.
pub const NO_LIST: u32 = u32::MAX;
/// Key of hidden sprites: sorts behind all visible ones.
pub const HIDDEN_KEY: u32 = u32::MAX;
/// Transmittance at which a traversal may stop: 2⁻¹⁰, a quarter of an 8-bit step.
pub const OPAQUE: f32 = 1.0 / 1024.0;
/// Sprites of a list that share one word per part, one bit each.
pub const BITS_PER_WORD: u32 = 32;
/// Sprites that one invocation assigns to bins.
pub const RUN: u32 = 64;

/// Number of words that `tile_refine` needs for a list of this length.
pub fn refine_words(length: u32) -> u32 {
    length.next_multiple_of(BITS_PER_WORD)
}

/// Number of runs of `count` sprites.
pub fn run_count(count: u32) -> u32 {
    count.div_ceil(RUN)
}

/// Packs the texels from `low` to before `high`, 16 bits each: x and y of `low`, x and y of `high`.
pub fn packed_rect(low: UVec2, high: UVec2) -> UVec2 {
    let pack = |corner: UVec2| corner.y * 0x1_0000 + corner.x;
    UVec2::new(pack(low), pack(high))
}

/// Corners of a packed rectangle.
fn unpacked_rect(rect: UVec2) -> [UVec2; 2] {
    rect.to_array().map(|corner| UVec2::new(corner % 0x1_0000, corner / 0x1_0000))
}

/// True if a packed rectangle and the rectangle from `low` to before `high` share a texel.
pub fn rects_meet(rect: UVec2, low: UVec2, high: UVec2) -> bool {
    let [first, last] = unpacked_rect(rect);
    first.cmplt(high).all() && low.cmplt(last).all()
}

/// Maps view z to bits that sort by view depth, near to far: the nearest is the largest z. (Herf, "Radix tricks", 2001)
pub fn front_to_back_bits(view_z: f32) -> u32 {
    let bits = view_z.to_bits();
    if view_z.is_sign_negative() { bits } else { 0x7fff_ffff - bits }
}

/// True if a list of `length` words that starts at `first` fits.
pub fn list_fits(first: u32, length: u32, capacity: u32) -> bool {
    u64::from(first) + u64::from(length) <= u64::from(capacity)
}

/// First texel of a bin.
pub fn low_of_bin(tiles: &TilesUniform, bin: u32) -> UVec2 {
    UVec2::new(bin % tiles.columns, bin / tiles.columns) * tiles.bin_side
}

/// Bins that a packed rectangle touches: the first, and the one after the last.
pub fn touched_bins(tiles: &TilesUniform, rect: UVec2) -> [UVec2; 2] {
    let [low, high] = unpacked_rect(rect);
    [low / tiles.bin_side, high.map(|side| side.div_ceil(tiles.bin_side))]
}

/// Allocates a bin's list of `length` sprites and `more` further words behind the `entries` words in use. Returns start
/// and length of the list, and the words in use after it. A list that does not fit, or that is longer than its fraction of
/// a 32-bit count, becomes the list of all `shown` sprites.
pub fn bin_list(tiles: &TilesUniform, shown: u32, entries: u32, length: u32, more: u32) -> (UVec2, u32) {
    let fraction = u64::from(u32::MAX / (tiles.columns * tiles.rows));
    let size = u64::from(length) + u64::from(more);
    if size > fraction {
        return (UVec2::new(NO_LIST, shown), entries);
    }
    let fits = list_fits(entries, size as u32, tiles.capacity);
    let list = if fits { UVec2::new(entries, length) } else { UVec2::new(NO_LIST, shown) };
    (list, entries + size as u32)
}

/// A word whose lowest `count` bits are set.
pub fn bits_below(count: u32) -> u32 {
    ((1_u64 << count.min(32)) - 1) as u32
}

/// Number of bits below a bit of 0 to 64.
pub fn count_below(bits: UVec2, bit: u32) -> u32 {
    let words = u64::from(bits.x) | (u64::from(bits.y) << 32);
    (u128::from(words) & ((1 << bit) - 1)).count_ones()
}

/// Sprites of a batch that may be visible in a part of their bin, one bit each. `lists` has the words of `tile_refine`
/// behind the list.
pub fn bits_of(lists: &[u32], list: UVec2, batch: u32, part: u32) -> u32 {
    let all = bits_below((list.y - batch).min(BITS_PER_WORD));
    if list.x == NO_LIST { all } else { lists[(list.x + list.y + batch + part) as usize] & all }
}

/// Index of a sprite of a list: an entry of the list, or of all sorted sprites if the bin has no list.
pub fn sprite_index(lists: &[u32], numbers: &[u32], list: UVec2, at: u32) -> u32 {
    if list.x == NO_LIST { numbers[at as usize] } else { lists[(list.x + at) as usize] }
}

/// True if the smoke in front hides all further sprites. `stops`: the traversal may stop there.
pub fn is_opaque(stops: bool, transmittance: f32) -> bool {
    stops && transmittance <= OPAQUE
}

/// True also if the scene hides all further sprites: none begins before the view depth `front`, and none that begins
/// beyond `end` is visible.
pub fn is_opaque_or_occluded(stops: bool, transmittance: f32, front: f32, end: f32) -> bool {
    is_opaque(stops, transmittance) || front > end
}

/// True if a sorted sprite is visible. Without a sort, every sprite counts as visible.
pub fn is_visible(sorted: bool, key: u32) -> bool {
    !sorted || key != HIDDEN_KEY
}

/// Digit of a sort key, 8 bits from bit `shift` on.
pub fn digit_of(key: u32, shift: u32) -> u32 {
    key >> shift & 0xff
}
