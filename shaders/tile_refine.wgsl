// tile_refine
// What    Finds for every tile of a few texels, where invocations walk alone, which of its bin's sprites it may show something of:
//         what is found once here, every texel would find there.
// Reads   lists of bins, sprites, rectangles, reduced depth (or the host's own).
// Writes  behind every list: of each batch of its sprites, a word for each part of the bin, a bit for each sprite. None where all
//         the rest is hidden; all where the part is opaque before it.

#import "lib/tiles.wgsl"
#import "lib/tile_sprite.wgsl"

@group(3) @binding(0) var<uniform> tiles: Tiles;
@group(3) @binding(1) var<storage, read> sprites: array<TileSprite>;
@group(3) @binding(2) var<storage, read> rects: array<vec2u>;
@group(3) @binding(3) var<storage, read> bins: array<vec2u>;
@group(3) @binding(4) var tested_depth: texture_2d<f32>;
@group(3) @binding(5) var<storage, read_write> lists: array<u32>;

// The farthest view depth at which each part of the bin shows anything.
var<workgroup> ends: array<f32, BATCH_ALONE>;
// Bits of the nearest of them, which is positive.
var<workgroup> nearest_end: atomic<u32>;
// Of each sprite of a batch: a bit for every part that it may be seen in.
var<workgroup> marks: array<u32, BATCH_ALONE>;
// Optical depth of all sprites so far in the middle of the bin, about, in 256ths.
var<workgroup> depth: atomic<u32>;
// Parts whose other words are known.
var<workgroup> settled_parts: atomic<u32>;

// Walks stop where the smoke is opaque.
override STOPS: bool = true;

// Optical depth of the middle of a bin where hardly a texel of it is not opaque: four times what a walk stops at.
const OPAQUE_DEPTH: u32 = 28u;

// The farthest view depth at which texels show anything.
fn shown_depth(low: vec2u, high: vec2u) -> f32 {
    var farthest = 0.0;
    for (var y = low.y; y < high.y; y++) {
        for (var x = low.x; x < high.x; x++) {
            farthest = max(farthest, tested_view_depth(textureLoad(tested_depth, vec2u(x, y), 0).r));
        }
    }
    return farthest + system.fade_through;
}

// The parts of a bin in which a sprite may be seen.
fn marks_of(number: u32, low: vec2u, part: vec2u) -> u32 {
    let sprite = sprites[number];
    let rect = rects[number];
    let front = sprite_front(sprite.centre_radius);
    let reach = reach_in_square(sprite, 0.5 * vec2f(part - 1u));
    // From part to part.
    let uv = uv_in_square(sprite, vec2f(low) + 0.5 * vec2f(part));
    let across = sprite.uv_from_texels.xz * f32(part.x);
    let down = sprite.uv_from_texels.yw * f32(part.y);
    var marks = 0u;
    for (var bit = 0u; bit < BATCH_ALONE; bit++) {
        let at = vec2u(bit % PARTS.x, bit / PARTS.x);
        var is_there = false;
        if is_sphere() {
            is_there = rects_meet(rect, low + at * part, low + at * part + part);
        } else {
            is_there = square_fills(sprite, uv + across * f32(at.x) + down * f32(at.y), reach);
        }
        marks |= select(0u, 1u << bit, is_there);
    }
    // Few are behind some of the scene. A CPU reads what lanes share slowly, and skips a loop, but not a branch.
    for (var bit = select(0u, BATCH_ALONE, front <= bitcast<f32>(atomicLoad(&nearest_end))); bit < BATCH_ALONE; bit++) {
        marks &= ~select(0u, 1u << bit, front > ends[bit]);
    }
    return marks;
}

// What a sprite has at a texel, about: puffs are thick in the middle, and thin out.
fn puff_amount(number: u32, texel: vec2f) -> f32 {
    let sprite = sprites[number];
    let place = 2.0 * uv_in_square(sprite, texel) - 1.0;
    let thickness = max(1.0 - dot(place, place), 0.0);
    return sprite.amount * thickness * thickness;
}

@compute @workgroup_size(32)
fn refine(@builtin(local_invocation_index) local: u32, @builtin(workgroup_id) bin: vec3u) {
    let list = bins[bin.x];
    // A bin without a list reads all sprites.
    let count = select(list.y, 0u, list.x == EVERYTHING);
    let low = vec2u(bin.x % tiles.columns, bin.x / tiles.columns) * tiles.bin_side;
    let part = tiles.bin_side / PARTS;
    let first = low + vec2u(local % PARTS.x, local / PARTS.x) * part;
    let end = shown_depth(first, min(first + part, vec2u(system.target_size)));
    ends[local] = end;
    atomicStore(&nearest_end, bitcast<u32>(end));
    workgroupBarrier();
    atomicMin(&nearest_end, bitcast<u32>(end));
    workgroupBarrier();
    var is_settled = any(first >= vec2u(system.target_size));
    if is_settled {
        atomicAdd(&settled_parts, 1u);
    }
    // What the words are from then on.
    var rest = 0u;
    var batch = 0u;
    for (; batch < count; batch += BATCH_ALONE) {
        let at = batch + local;
        var mark = 0u;
        if at < count {
            let number = lists[list.x + at];
            mark = marks_of(number, low, part);
            atomicAdd(&depth, u32(i32(256.0 * puff_amount(number, vec2f(low) + 0.5 * f32(tiles.bin_side)))));
        }
        marks[local] = mark;
        workgroupBarrier();
        var word = 0u;
        for (var bit = 0u; bit < BATCH_ALONE; bit++) {
            word |= ((marks[bit] >> local) & 1u) << bit;
        }
        lists[list.x + count + at] = word;
        if !is_settled {
            // The few texels that do come to more look at all of it.
            let is_opaque = STOPS && !is_sphere() && atomicLoad(&depth) >= 256u * OPAQUE_DEPTH;
            // Behind the scene, and so are all further on.
            let is_hidden = sprite_front(sprites[lists[list.x + batch]].centre_radius) > end + tiles.hidden_after;
            is_settled = is_opaque || is_hidden;
            if is_settled {
                rest = select(0u, 0xffffffffu, is_opaque);
                atomicAdd(&settled_parts, 1u);
            }
        }
        if workgroupUniformLoad(&settled_parts) == BATCH_ALONE {
            break;
        }
    }
    for (batch += BATCH_ALONE; batch < count; batch += BATCH_ALONE) {
        lists[list.x + count + batch + local] = rest;
    }
}
