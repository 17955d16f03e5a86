// tile_accumulate
// Accumulates every sprite's normal, or its six-way light, and amount, like accumulate, but per texel: traverses the
// sprites of a bin front to back, sums them in registers, and writes each texel once.
//
// Reads   sprite lists, sprite flipbook, detail map or noise, reduced depth (or the host's own).
// Writes  accumulation target, as accumulate does.
// Source  OTEE "Accumulating the particles"; front-to-back blending: Porter and Duff, "Compositing digital images",
//         1984.
// Space   Normals in view space. Depths in metres.

#import "lib/tiles.wgsl"
#import "lib/tile_sprite.wgsl"

@group(3) @binding(0) var<uniform> tiles: Tiles;
@group(3) @binding(1) var<storage, read> sprites: array<TileSprite>;
@group(3) @binding(2) var<storage, read> rects: array<vec2u>;
@group(3) @binding(3) var<storage, read> indices: array<u32>;
@group(3) @binding(4) var<storage, read> lists: array<u32>;
// Start of each bin's list, and its length.
@group(3) @binding(5) var<storage, read> bins: array<vec2u>;
// Reduced depth, or the host's depth if HOST_DEPTH.
@group(3) @binding(6) var tested_depth: texture_2d<f32>;
// Textures of the target. The renderer replaces the formats by those of the system's textures.
@group(3) @binding(7) var texture_0: texture_storage_2d<rgba16float, write>;
@group(3) @binding(8) var texture_1: texture_storage_2d<rgba16float, write>;
@group(3) @binding(9) var texture_2: texture_storage_2d<rgba16float, write>;
@group(3) @binding(10) var texture_3: texture_storage_2d<rgba16float, write>;

// If has_values().
@group(3) @binding(11) var<storage, read> sprite_values: array<SpriteValues>;

override NORMAL_ENCODING: u32 = NORMAL_ENCODING_SIGNED;
override WEIGHTED: bool = false;
// True: the traversal stops where the smoke is opaque.
override STOPS: bool = true;
// True: an invocation has 2x2 texels, not one below the other. See `quads`.
override QUADS: bool = false;

// Transmittance at which the traversal may stop: 2⁻¹⁰, a quarter of an 8-bit step.
const OPAQUE: f32 = 0.0009765625;

// A texel, and its accumulated values so far.
struct Texel {
    // Position in the target, texels.
    position: vec2f,
    ray: vec2f,
    scene: f32,
    // If the front of a sprite is beyond this view depth, it and all later sprites of the list are hidden.
    end: f32,
    // Premultiplied sum over all sprites in front: normals, or light from right, top and front if SIX_WAY.
    normals: vec3f,
    // Sums of the other textures.
    attachments: Attachments,
    transmittance: f32,
}

fn init_texel(position: vec2u) -> Texel {
    var texel: Texel;
    texel.position = vec2f(position) + 0.5;
    texel.ray = ray_through_texel(texel.position);
    texel.transmittance = 1.0;
    texel.scene = tested_view_depth(tested_depth, position);
    texel.end = texel.scene + system.show_through_distance + tiles.occlusion_margin;
    return texel;
}

// Returns the texel with one more sprite, behind all accumulated ones. `values`: those of the sprite. `uv`: position in its
// square. `is_cover`: the scene fades it nowhere in the tile.
fn accumulate_sprite(
    texel: Texel,
    sprite: TileSprite,
    values: SpriteValues,
    uv: vec2f,
    is_touched: bool,
    is_cover: bool,
) -> Texel {
    var in = fragment_of(sprite, texel.position, texel.ray, uv);
    if STRETCH {
        in.stretch = unpack2x16snorm(values.stretch);
    }
    var fragment: SpriteFragment;
    if is_cover {
        fragment = unfaded_fragment(in, frames_of(sprite));
    } else {
        fragment = technique_fragment(in, frames_of(sprite), texel.scene);
    }
    let amount = select(0.0, fragment.amount, is_touched && !fragment.hidden);
    let seen = select(texel.transmittance, 1.0, WEIGHTED);
    var next = texel;
    let weight = amount * seen * select(1.0, in.weight, WEIGHTED);
    if SIX_WAY {
        next.normals += fragment.six_way.positive * weight;
    } else {
        next.normals += accumulation_from_normal(NORMAL_ENCODING, fragment.normal, 1.0, weight).rgb;
    }
    let attachments = attachments_from_fragment(fragment, weight, values, in.center_radius);
    next.attachments = add_attachments(texel.attachments, attachments);
    next.transmittance *= 1.0 - amount;
    return next;
}

// True if the smoke in front hides all further sprites.
fn is_opaque(texel: Texel) -> bool {
    return STOPS && texel.transmittance <= OPAQUE;
}

// True also if the scene hides all further sprites. `front`: view depth before which no further sprite begins.
fn is_opaque_or_occluded(texel: Texel, front: f32) -> bool {
    return is_opaque(texel) || front > texel.end;
}

fn write_texel(position: vec2u, texel: Texel) {
    let slots = slots_from_attachments(vec4f(texel.normals, 1.0 - texel.transmittance), texel.attachments);
    textureStore(texture_0, position, slots[0]);
    if ATTACHMENT_COUNT > 1u {
        textureStore(texture_1, position, slots[1]);
    }
    if ATTACHMENT_COUNT > 2u {
        textureStore(texture_2, position, slots[2]);
    }
    if ATTACHMENT_COUNT > 3u {
        textureStore(texture_3, position, slots[3]);
    }
}

fn sprite_index(list: vec2u, at: u32) -> u32 {
    if list.x == NO_LIST {
        return indices[at];
    }
    return lists[list.x + at];
}

// Cooperative traversal, for adapters with cheap barriers: a workgroup reads a batch of sprites once and shares it in
// workgroup memory. Each invocation has two texels, one below the other, or 2x2, so that it has other work while it waits
// for a texture lookup.
const TILE: vec2u = vec2u(8u, 16u);
// Texels of a workgroup of `quads`, and of 32 of its invocations, which many GPUs run side by side. On a large target, where
// fewer invocations suffice to keep the adapter busy, more texels share what is done once a sprite.
const QUAD_TILE: vec2u = vec2u(32u, 16u);
const QUAD_BLOCK: vec2u = vec2u(16u, 8u);
// Parts of the list that a workgroup of `split` or `split_finely` traverses at the same time, where a target has too few
// texels to keep the adapter busy: most of the time is then spent waiting for lookups. A tile of `split_finely` is 8x8 texels.
const SPLIT: u32 = 4u;
const FINE_SPLIT: u32 = 8u;
const BATCH: u32 = 64u;

// Sprites of a batch that touch the tile, part by part, front to back.
var<workgroup> batch: array<TileSprite, BATCH>;
var<workgroup> batch_values: array<SpriteValues, BATCH>;
// One bit for each sprite of the batch.
var<workgroup> touching: array<atomic<u32>, 2>;
// 1 if any texel of the tile is not done.
var<workgroup> unfinished: atomic<u32>;
// Front of the batch's first sprite in each part, view depth.
var<workgroup> fronts: array<f32, FINE_SPLIT>;
// Bits of the farthest view depth of the scene in the tile. It is positive, so that its bits order as an integer.
var<workgroup> farthest: atomic<u32>;
// The same of the nearest one, inverted.
var<workgroup> nearest: atomic<u32>;
// Texels of one part, as the targets' textures. The amount's position has the transmittance.
var<workgroup> behind: array<array<vec4f, MAX_TARGET_ATTACHMENTS>, 64>;

// Texels of an invocation: a above b. If QUADS, also c above d, to their right.
struct Texels {
    a: Texel,
    b: Texel,
    c: Texel,
    d: Texel,
}

@compute @workgroup_size(8, 8)
fn cooperative(@builtin(local_invocation_id) local: vec3u, @builtin(workgroup_id) workgroup: vec3u) {
    let low = workgroup.xy * TILE;
    write_pair(first_texel(low, local), traverse_part(low, TILE, local, 1u));
}

@compute @workgroup_size(8, 4, 4)
fn quads(@builtin(local_invocation_id) local: vec3u, @builtin(workgroup_id) workgroup: vec3u) {
    let low = workgroup.xy * QUAD_TILE;
    let position = first_texel(low, local);
    let texels = traverse_part(low, QUAD_TILE, local, 1u);
    write_pair(position, texels);
    write_pair(position + vec2u(1u, 0u), Texels(texels.c, texels.d, texels.c, texels.d));
}

@compute @workgroup_size(8, 8, SPLIT)
fn split(@builtin(local_invocation_id) local: vec3u, @builtin(workgroup_id) workgroup: vec3u) {
    traverse_parts(workgroup.xy * TILE, TILE, local, SPLIT);
}

@compute @workgroup_size(8, 4, FINE_SPLIT)
fn split_finely(@builtin(local_invocation_id) local: vec3u, @builtin(workgroup_id) workgroup: vec3u) {
    let tile = vec2u(8u, 8u);
    traverse_parts(workgroup.xy * tile, tile, local, FINE_SPLIT);
}

// Traverses all parts, and adds each behind the one in front of it, from the back. `low`: first texel of the tile.
fn traverse_parts(low: vec2u, tile: vec2u, local: vec3u, parts: u32) {
    let index = local.y * 8u + local.x;
    var texels = traverse_part(low, tile, local, parts);
    for (var part = parts - 1u; part > 0u; part--) {
        if local.z == part {
            behind[index] = slots_of(texels.a);
        }
        workgroupBarrier();
        if local.z + 1u == part {
            texels.a = with_behind(texels.a, behind[index]);
        }
        workgroupBarrier();
        if local.z == part {
            behind[index] = slots_of(texels.b);
        }
        workgroupBarrier();
        if local.z + 1u == part {
            texels.b = with_behind(texels.b, behind[index]);
        }
        workgroupBarrier();
    }
    if local.z == 0u {
        write_pair(first_texel(low, local), texels);
    }
}

fn first_texel(low: vec2u, local: vec3u) -> vec2u {
    if QUADS {
        return low + vec2u(local.z & 1u, local.z >> 1u) * QUAD_BLOCK + local.xy * 2u;
    }
    return low + local.xy * vec2u(1u, 2u);
}

fn slots_of(texel: Texel) -> array<vec4f, MAX_TARGET_ATTACHMENTS> {
    return slots_from_attachments(vec4f(texel.normals, texel.transmittance), texel.attachments);
}

// Returns the texel with another one behind it.
fn with_behind(texel: Texel, slots: array<vec4f, MAX_TARGET_ATTACHMENTS>) -> Texel {
    let seen = select(texel.transmittance, 1.0, WEIGHTED);
    var seen_slots = slots;
    for (var slot = 0u; slot < ATTACHMENT_COUNT; slot++) {
        seen_slots[slot] *= seen;
    }
    var next = texel;
    next.normals += seen_slots[0].rgb;
    next.attachments = add_attachments(texel.attachments, attachments_from_slots(seen_slots));
    next.transmittance *= slots[0].a;
    return next;
}

fn write_pair(position: vec2u, texels: Texels) {
    let size = vec2u(system.target_size);
    let below = position + vec2u(0u, 1u);
    if all(position < size) {
        write_texel(position, texels.a);
    }
    if all(below < size) {
        write_texel(below, texels.b);
    }
}

// Traverses a part of a tile's list: that of the invocation, of so many parts. All invocations of a workgroup call it.
// `low`: first texel of the tile.
fn traverse_part(low: vec2u, tile: vec2u, local_position: vec3u, parts: u32) -> Texels {
    let last_texel = vec2u(system.target_size) - 1u;
    let part = select(local_position.z, 0u, QUADS);
    let local = select(0u, local_position.z * 32u, QUADS) + local_position.y * 8u + local_position.x;
    let position = first_texel(low, local_position);
    var a = init_texel(min(position, last_texel));
    var b = init_texel(min(position + vec2u(0u, 1u), last_texel));
    var c = a;
    var d = b;
    if QUADS {
        c = init_texel(min(position + vec2u(1u, 0u), last_texel));
        d = init_texel(min(position + vec2u(1u, 1u), last_texel));
        let scene = min(min(a.scene, b.scene), min(c.scene, d.scene));
        atomicMax(&nearest, ~bitcast<u32>(max(scene, 0.0)));
    }
    atomicMax(&farthest, bitcast<u32>(max(max(max(a.scene, b.scene), max(c.scene, d.scene)), 0.0)));
    let bin = low / tiles.bin_side;
    let list = bins[bin.y * tiles.columns + bin.x];
    // Far from where the counter of the loop would wrap.
    let entries = min(list.y * tiles.loops, 0x7fffffffu);
    // Entries of each part, and of each part of a batch.
    let length = (entries + parts - 1u) / parts;
    let fraction = BATCH / parts;
    let start = part * length;
    let stop = min(start + length, entries);
    let middle = vec2f(low) + 0.5 * vec2f(tile);
    workgroupBarrier();
    let begin = bitcast<f32>(~atomicLoad(&nearest));
    let end = bitcast<f32>(atomicLoad(&farthest)) + system.show_through_distance;
    for (var first = 0u; first < length; first += fraction) {
        if local == 0u && part == 0u {
            atomicStore(&touching[0], 0u);
            atomicStore(&touching[1], 0u);
        }
        let front = fronts[part];
        let is_over = is_opaque_or_occluded(a, front) && is_opaque_or_occluded(b, front) &&
            (!QUADS || (is_opaque_or_occluded(c, front) && is_opaque_or_occluded(d, front)));
        if start + first < stop && !is_over {
            atomicStore(&unfinished, 1u);
        }
        if workgroupUniformLoad(&unfinished) == 0u {
            break;
        }
        var sprite: TileSprite;
        var values: SpriteValues;
        var is_kept = false;
        if local < fraction && start + first + local < stop {
            // `debug.draw_count`: repeats the list.
            let index = sprite_index(list, (start + first + local) % list.y);
            if local == 0u {
                fronts[part] = sprite_front(sprites[index].center_radius);
            }
            // Most sprites of a bin do not touch this tile: reads only the rectangle of those.
            if rects_meet(rects[index], low, low + tile) {
                sprite = sprites[index];
                if has_values() {
                    values = sprite_values[index];
                }
                // Only texel centers count.
                let reach = reach_in_square(sprite, 0.5 * vec2f(tile - 1u));
                let uv = uv_in_square(sprite, middle);
                let meets = is_sphere() || square_fills(sprite, uv, reach);
                is_kept = meets && sprite_front(sprite.center_radius) <= end;
                if QUADS && is_full_between(sprite.filled, uv - reach, uv + reach) &&
                    is_unfaded(begin, -sprite.center_radius.z) {
                    // The mark of a sprite that covers the tile. Any other that meets it has a filled cell.
                    sprite.filled = vec2u(0u);
                }
            }
        }
        let entry = part * fraction + local;
        if is_kept {
            atomicOr(&touching[entry / 32u], 1u << (entry % 32u));
        }
        workgroupBarrier();
        let kept = vec2u(atomicLoad(&touching[0]), atomicLoad(&touching[1]));
        if is_kept {
            let at = count_below(kept, entry);
            batch[at] = sprite;
            if has_values() {
                batch_values[at] = values;
            }
        }
        if local == 0u && part == 0u {
            atomicStore(&unfinished, 0u);
        }
        workgroupBarrier();
        let last = count_below(kept, (part + 1u) * fraction);
        // llvmpipe's textureLoad takes the mip level of a lane that has left the loop. No lane leaves it under exact filtering,
        // which tests use.
        for (
            var at = count_below(kept, part * fraction);
            at < last && (EXACT_FILTERING || !are_opaque(a, b, c, d));
            at++
        ) {
            // Otherwise, the loop has ended.
            let is_done = EXACT_FILTERING && are_opaque(a, b, c, d);
            let sprite = batch[at];
            var values: SpriteValues;
            if has_values() {
                values = batch_values[at];
            }
            let in_a = uv_in_square(sprite, a.position);
            let in_b = in_a + sprite.uv_from_texels.yw;
            let in_c = in_a + sprite.uv_from_texels.xz;
            let in_d = in_c + sprite.uv_from_texels.yw;
            if QUADS && !is_done && !is_sphere() && all(sprite.filled == vec2u(0u)) {
                a = accumulate_sprite(a, sprite, values, in_a, true, true);
                b = accumulate_sprite(b, sprite, values, in_b, true, true);
                c = accumulate_sprite(c, sprite, values, in_c, true, true);
                d = accumulate_sprite(d, sprite, values, in_d, true, true);
                continue;
            }
            let touches_a = !is_done && touches(sprite, in_a);
            let touches_b = !is_done && touches(sprite, in_b);
            let touches_c = QUADS && !is_done && touches(sprite, in_c);
            let touches_d = QUADS && !is_done && touches(sprite, in_d);
            if touches_a || touches_b || touches_c || touches_d {
                a = accumulate_sprite(a, sprite, values, in_a, touches_a, false);
                b = accumulate_sprite(b, sprite, values, in_b, touches_b, false);
                if QUADS {
                    c = accumulate_sprite(c, sprite, values, in_c, touches_c, false);
                    d = accumulate_sprite(d, sprite, values, in_d, touches_d, false);
                }
            }
        }
    }
    return Texels(a, b, c, d);
}

// True if the smoke in front hides all further sprites from an invocation's texels.
fn are_opaque(a: Texel, b: Texel, c: Texel, d: Texel) -> bool {
    return is_opaque(a) && is_opaque(b) && (!QUADS || (is_opaque(c) && is_opaque(d)));
}

// Number of bits below a bit of 0 to 64.
fn count_below(bits: vec2u, bit: u32) -> u32 {
    return countOneBits(bits.x & bits_below(min(bit, 32u))) + countOneBits(bits.y & bits_below(max(bit, 32u) - 32u));
}

fn values_of(index: u32) -> SpriteValues {
    if has_values() {
        return sprite_values[index];
    }
    return SpriteValues();
}

// True if a sprite may have something at `uv`, a position in its square.
fn touches(sprite: TileSprite, uv: vec2f) -> bool {
    return is_sphere() || is_filled(sprite.filled, uv);
}

// Per-invocation traversal, for CPUs, where a barrier costs more than it saves: every invocation traverses the list for
// a column of texels. llvmpipe executes both sides of every branch, so nothing is tested here: tile_refine has found
// the sprites of each tile. The lanes of a SIMD vector are a row of columns. LOADS_SPRITE requires the same mip level,
// and so the same sprite, in all lanes; therefore no column leaves the loop before all are done.
const STRIDE: u32 = 8u;

// Number of columns of each tile that are done.
var<workgroup> done_columns: array<atomic<u32>, 8>;

@compute @workgroup_size(8, 8)
fn per_invocation(@builtin(global_invocation_id) invocation: vec3u, @builtin(local_invocation_id) local_position: vec3u) {
    let low = invocation.xy * vec2u(1u, PER_INVOCATION_TILE.y);
    let size = vec2u(system.target_size);
    if any(low >= size) {
        return;
    }
    let last = size - 1u;
    var a = init_texel(low);
    var b = init_texel(min(low + vec2u(0u, 1u), last));
    var c = init_texel(min(low + vec2u(0u, 2u), last));
    var d = init_texel(min(low + vec2u(0u, 3u), last));
    let columns = min(size.x - low.x / PER_INVOCATION_TILE.x * PER_INVOCATION_TILE.x, PER_INVOCATION_TILE.x);
    let bin = low / tiles.bin_side;
    let list = bins[bin.y * tiles.columns + bin.x];
    let part = low % tiles.bin_side / (tiles.bin_side / PARTS);
    let length = refine_words(list.y);
    // Far from where the counter of the loop would wrap; the same in traverse_part.
    let end = min(length * tiles.loops, 0x7fffffffu);
    var is_column_done = false;
    var bits = 0u;
    var batch = 0u;
    var next = 0u;
    loop {
        // Skips to the next batch that has a sprite of this tile; repeats the list for `debug.draw_count`.
        while bits == 0u && next < end {
            batch = next % length;
            bits = bits_of(list, batch, part.y * PARTS.x + part.x);
            next += BITS_PER_WORD;
        }
        if bits == 0u {
            break;
        }
        var last_front = 0.0;
        for (var count = 0u; count < STRIDE && bits != 0u; count++) {
            let index = sprite_index(list, batch + firstTrailingBit(bits));
            let sprite = sprites[index];
            let values = values_of(index);
            bits &= bits - 1u;
            let in_a = uv_in_square(sprite, a.position);
            let in_b = in_a + sprite.uv_from_texels.yw;
            let in_c = in_b + sprite.uv_from_texels.yw;
            let in_d = in_c + sprite.uv_from_texels.yw;
            a = accumulate_sprite(a, sprite, values, in_a, !is_opaque(a) && covers(in_a), false);
            b = accumulate_sprite(b, sprite, values, in_b, !is_opaque(b) && covers(in_b), false);
            c = accumulate_sprite(c, sprite, values, in_c, !is_opaque(c) && covers(in_c), false);
            d = accumulate_sprite(d, sprite, values, in_d, !is_opaque(d) && covers(in_d), false);
            last_front = sprite_front(sprite.center_radius);
        }
        if STOPS || is_flat() {
            let above = is_opaque_or_occluded(a, last_front) && is_opaque_or_occluded(b, last_front);
            if !is_column_done && above && is_opaque_or_occluded(c, last_front) && is_opaque_or_occluded(d, last_front) {
                is_column_done = true;
                atomicAdd(&done_columns[local_position.y], 1u);
            }
            if atomicLoad(&done_columns[local_position.y]) == columns {
                break;
            }
        }
    }
    write_texel(low, a);
    if low.y + 1u < size.y { write_texel(low + vec2u(0u, 1u), b); }
    if low.y + 2u < size.y { write_texel(low + vec2u(0u, 2u), c); }
    if low.y + 3u < size.y { write_texel(low + vec2u(0u, 3u), d); }
}

// Returns the sprites of a batch that may be visible in a part of their bin, one bit each.
fn bits_of(list: vec2u, batch: u32, part: u32) -> u32 {
    let all = bits_below(min(list.y - batch, BITS_PER_WORD));
    if list.x == NO_LIST {
        return all;
    }
    return lists[list.x + list.y + batch + part] & all;
}

fn bits_below(count: u32) -> u32 {
    return select((1u << count) - 1u, 0xffffffffu, count >= 32u);
}

// True if a texel lies in a sprite. `uv`: position in the sprite's square.
fn covers(uv: vec2f) -> bool {
    return is_sphere() || (all(uv >= vec2f(0.0)) && all(uv < vec2f(1.0)));
}
