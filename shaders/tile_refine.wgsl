// tile_refine
// Finds, for per-invocation traversal, which sprites of a bin may be visible in each of its tiles (parts of a few
// texels), so that tile_accumulate need not test them per texel.
//
// Reads   sprite lists of the bins, sprites, rectangles, reduced depth (or the host's own).
// Writes  behind every list: for each batch of its sprites one word per part of the bin, one bit per sprite. Once the
//         scene hides all further sprites in a part, its bits are 0; once the part is opaque, its bits are 1.

#import "lib/tiles.wgsl"
#import "lib/tile_sprite.wgsl"

@group(3) @binding(0) var<uniform> tiles: Tiles;
@group(3) @binding(1) var<storage, read> sprites: array<TileSprite>;
@group(3) @binding(2) var<storage, read> rects: array<vec2u>;
@group(3) @binding(3) var<storage, read> bins: array<vec2u>;
@group(3) @binding(4) var tested_depth: texture_2d<f32>;
@group(3) @binding(5) var<storage, read_write> lists: array<u32>;

// Farthest view depth at which each part of the bin shows anything.
var<workgroup> ends: array<f32, BITS_PER_WORD>;
// Bits of the nearest end. It is positive, so that its bits order as an integer.
var<workgroup> nearest_end: atomic<u32>;
// For each sprite of a batch, one bit for every part in which it may be visible.
var<workgroup> marks: array<u32, BITS_PER_WORD>;
// Approximate optical depth of all sprites so far at the center of the bin, in 1/256.
var<workgroup> depth: atomic<u32>;
// Number of parts whose remaining words are known.
var<workgroup> finished_parts: atomic<u32>;

// True: the traversal stops where the smoke is opaque.
override STOPS: bool = true;

// Optical depth at the center of a bin at which almost all of its texels are opaque: four times the depth at which a
// traversal stops.
const OPAQUE_DEPTH: u32 = 28u;

// Returns the farthest view depth at which these texels show anything.
fn farthest_visible_depth(low: vec2u, high: vec2u) -> f32 {
    var farthest = 0.0;
    for (var y = low.y; y < high.y; y++) {
        for (var x = low.x; x < high.x; x++) {
            farthest = max(farthest, tested_view_depth(tested_depth, vec2u(x, y)));
        }
    }
    return farthest + system.show_through_distance;
}

// Returns the parts of a bin in which a sprite may be visible, one bit each.
fn visible_parts(index: u32, low: vec2u, part: vec2u) -> u32 {
    let sprite = sprites[index];
    let rect = rects[index];
    let front = sprite_front(sprite.center_radius);
    let reach = reach_in_square(sprite, 0.5 * vec2f(part - 1u));
    // Steps from part to part.
    let uv = uv_in_square(sprite, vec2f(low) + 0.5 * vec2f(part));
    let across = sprite.uv_from_texels.xz * f32(part.x);
    let down = sprite.uv_from_texels.yw * f32(part.y);
    var marks = 0u;
    for (var bit = 0u; bit < BITS_PER_WORD; bit++) {
        let at = vec2u(bit % PARTS.x, bit / PARTS.x);
        var is_there = false;
        if is_sphere() {
            is_there = rects_meet(rect, low + at * part, low + at * part + part);
        } else {
            is_there = square_fills(sprite, uv + across * f32(at.x) + down * f32(at.y), reach);
        }
        marks |= select(0u, 1u << bit, is_there);
    }
    // Few sprites are behind part of the scene. llvmpipe reads workgroup memory slowly and executes both sides of a
    // branch, but it can skip a loop: the test therefore selects the loop's start.
    for (var bit = select(0u, BITS_PER_WORD, front <= bitcast<f32>(atomicLoad(&nearest_end))); bit < BITS_PER_WORD; bit++) {
        marks &= ~select(0u, 1u << bit, front > ends[bit]);
    }
    return marks;
}

// Returns the approximate amount of a sprite at a texel: puffs are thick in the center and thin out.
fn approximate_amount(index: u32, texel: vec2f) -> f32 {
    let sprite = sprites[index];
    let position = 2.0 * uv_in_square(sprite, texel) - 1.0;
    let thickness = max(1.0 - dot(position, position), 0.0);
    return sprite.amount * thickness * thickness;
}

@compute @workgroup_size(32)
fn refine(@builtin(local_invocation_index) local: u32, @builtin(workgroup_id) bin: vec3u) {
    let list = bins[bin.x];
    // A bin without a list reads all sprites.
    let count = select(list.y, 0u, list.x == NO_LIST);
    let low = vec2u(bin.x % tiles.columns, bin.x / tiles.columns) * tiles.bin_side;
    let part = tiles.bin_side / PARTS;
    let first = low + vec2u(local % PARTS.x, local / PARTS.x) * part;
    let end = farthest_visible_depth(first, min(first + part, vec2u(system.target_size)));
    ends[local] = end;
    atomicStore(&nearest_end, bitcast<u32>(end));
    workgroupBarrier();
    atomicMin(&nearest_end, bitcast<u32>(end));
    workgroupBarrier();
    var is_settled = any(first >= vec2u(system.target_size));
    if is_settled {
        atomicAdd(&finished_parts, 1u);
    }
    // Value of all remaining words.
    var rest = 0u;
    var batch = 0u;
    for (; batch < count; batch += BITS_PER_WORD) {
        let at = batch + local;
        var mark = 0u;
        if at < count {
            let index = lists[list.x + at];
            mark = visible_parts(index, low, part);
            atomicAdd(&depth, u32(i32(256.0 * approximate_amount(index, vec2f(low) + 0.5 * f32(tiles.bin_side)))));
        }
        marks[local] = mark;
        workgroupBarrier();
        var word = 0u;
        for (var bit = 0u; bit < BITS_PER_WORD; bit++) {
            word |= ((marks[bit] >> local) & 1u) << bit;
        }
        lists[list.x + count + at] = word;
        if !is_settled {
            // The few texels that are not opaque yet then visit all further sprites.
            let is_opaque = STOPS && !is_sphere() && atomicLoad(&depth) >= 256u * OPAQUE_DEPTH;
            // The scene hides this sprite and all further ones.
            let is_hidden = sprite_front(sprites[lists[list.x + batch]].center_radius) > end + tiles.occlusion_margin;
            is_settled = is_opaque || is_hidden;
            if is_settled {
                rest = select(0u, 0xffffffffu, is_opaque);
                atomicAdd(&finished_parts, 1u);
            }
        }
        if workgroupUniformLoad(&finished_parts) == BITS_PER_WORD {
            break;
        }
    }
    for (batch += BITS_PER_WORD; batch < count; batch += BITS_PER_WORD) {
        lists[list.x + count + batch + local] = rest;
    }
}
