//! Formula tests of the tiled path's counts, rectangles and lists: `shaders/lib/tiles.wgsl`, `shaders/tile_bin.wgsl`,
//! `shaders/tile_gather.wgsl`, `shaders/lib/scan.wgsl` and `shaders/sort.wgsl`.

use glam::{UVec2, uvec2};
use haze_core::formula::tiles;
use haze_core::formula::uniforms::TilesUniform;

use super::Formula;
use super::inputs::{HALF, flag, halves, random, word};

/// Texel coordinates of a rectangle's corners, packed, and of another rectangle.
fn rects(x: &[f32]) -> (UVec2, [UVec2; 2]) {
    let corner = |at: usize| uvec2(x[at] as u32, x[at + 1] as u32);
    (tiles::packed_rect(corner(0), corner(0) + corner(2)), [corner(4), corner(4) + corner(6)])
}

/// Uniforms with 5 by 3 bins of 8 texels.
const TILES: TilesUniform = TilesUniform {
    count: 0,
    loops: 1,
    first: 0,
    blocks: 1,
    bin_side: 8,
    columns: 5,
    rows: 3,
    runs: 1,
    capacity: 0,
    occlusion_margin: 0.0,
    padding: [0; 2],
};

pub fn formulas() -> Vec<Formula> {
    [counts(), rectangles(), lists(), traversal(), sort()].into_iter().flatten().collect()
}

fn counts() -> Vec<Formula> {
    let around_multiples =
        || [0, 1, 31, 32, 33, 63, 64, 65, 127, 128, 129, 5000].map(|n: u16| vec![f32::from(n)]).to_vec();
    vec![
        Formula {
            name: "refine_words",
            file: "lib/tiles.wgsl",
            wgsl: "y(0, f32(refine_words(u32(x(0)))));",
            reference: |x| vec![tiles::refine_words(x[0] as u32) as f32],
            cases: around_multiples(),
            tolerance: 0.0,
            mutants: &[("length + BITS_PER_WORD - 1u", "length + BITS_PER_WORD")],
        },
        Formula {
            name: "run_count",
            file: "lib/tiles.wgsl",
            wgsl: "y(0, f32(run_count(u32(x(0)))));",
            reference: |x| vec![tiles::run_count(x[0] as u32) as f32],
            cases: around_multiples(),
            tolerance: 0.0,
            mutants: &[("count + RUN - 1u", "count"), ("count + RUN - 1u", "count + RUN")],
        },
        Formula {
            name: "front_to_back_bits",
            file: "lib/tiles.wgsl",
            wgsl: "y_word(0, front_to_back_bits(x(0)));",
            reference: |x| halves(tiles::front_to_back_bits(x[0])).to_vec(),
            cases: random(100, &[(-50.0, 20.0)]),
            tolerance: 0.0,
            mutants: &[("0x7fffffffu - bits, bits", "bits, bits"), ("bits >> 31u == 1u", "false")],
        },
        Formula {
            name: "list_fits",
            file: "tile_bin.wgsl",
            wgsl: "y(0, f32(list_fits(word(0), word(2), word(4))));",
            reference: |x| flag(tiles::list_fits(word(x), word(&x[2..]), word(&x[4..]))),
            cases: {
                let mut cases = random(200, &[HALF; 6]);
                // The sum of start and length wraps around.
                cases.push(vec![65535.0, 65535.0, 0.0, 9.0, 32768.0, 0.0]);
                cases.push(vec![0.0, 7.0, 0.0, 3.0, 0.0, 10.0]);
                cases
            },
            tolerance: 0.0,
            mutants: &[
                ("length <= capacity && first <= capacity - length", "first + length <= capacity"),
                ("first <= capacity - length", "first < capacity - length"),
            ],
        },
        Formula {
            name: "inclusive_sum",
            file: "lib/scan.wgsl",
            wgsl: "let sum = inclusive_sum(local_index, (local_index * 7u) % 5u + u32(x(0))); \
                   if local_index % 8u == 5u { y(local_index / 8u, f32(sum)); }",
            reference: |x| {
                let value = |local: u32| local * 7 % 5 + x[0] as u32;
                (0..32).map(|of| (0..=8 * of + 5).map(value).sum::<u32>() as f32).collect()
            },
            cases: vec![vec![0.0], vec![3.0], vec![1000.0]],
            tolerance: 0.0,
            mutants: &[("step *= 2u", "step *= 4u"), ("if local >= step", "if local > step")],
        },
    ]
}

fn rectangles() -> Vec<Formula> {
    vec![
        Formula {
            name: "packed_rect",
            file: "lib/tiles.wgsl",
            wgsl: "let r = packed_rect(vec2u(u32(x(0)), u32(x(1))), vec2u(u32(x(2)), u32(x(3)))); \
                   y_word(0, r.x); y_word(2, r.y);",
            reference: |x| {
                let rect = tiles::packed_rect(uvec2(x[0] as u32, x[1] as u32), uvec2(x[2] as u32, x[3] as u32));
                [halves(rect.x), halves(rect.y)].concat()
            },
            cases: random(50, &[HALF; 4]),
            tolerance: 0.0,
            mutants: &[("low.x | (low.y << 16u)", "low.y | (low.x << 16u)")],
        },
        Formula {
            name: "rects_meet",
            file: "lib/tiles.wgsl",
            wgsl: "let a = vec2u(u32(x(0)), u32(x(1))); let b = vec2u(u32(x(4)), u32(x(5))); \
                   let r = packed_rect(a, a + vec2u(u32(x(2)), u32(x(3)))); \
                   y(0, f32(rects_meet(r, b, b + vec2u(u32(x(6)), u32(x(7))))));",
            reference: |x| {
                let (rect, [low, high]) = rects(x);
                flag(tiles::rects_meet(rect, low, high))
            },
            cases: random(
                400,
                &[(0.0, 9.9), (0.0, 9.9), (1.0, 5.9), (1.0, 5.9), (0.0, 9.9), (0.0, 9.9), (1.0, 5.9), (1.0, 5.9)],
            ),
            tolerance: 0.0,
            mutants: &[("all(first < high)", "all(first <= high)"), ("all(low < last)", "any(low < last)")],
        },
        Formula {
            name: "low_of_bin",
            file: "tile_bin.wgsl",
            wgsl: "tiles.columns = 5u; tiles.bin_side = 8u; y2(0, vec2f(low_of_bin(u32(x(0)))));",
            reference: |x| tiles::low_of_bin(&TILES, x[0] as u32).as_vec2().to_array().to_vec(),
            cases: (0..15_u8).map(|bin| vec![f32::from(bin)]).collect(),
            tolerance: 0.0,
            mutants: &[("bin % tiles.columns, bin /", "bin / tiles.columns, bin %")],
        },
        Formula {
            name: "touched_bins",
            file: "tile_bin.wgsl",
            wgsl: "tiles.bin_side = 8u; let a = vec2u(u32(x(0)), u32(x(1))); \
                   let t = touched_bins(packed_rect(a, a + vec2u(u32(x(2)), u32(x(3))))); \
                   y2(0, vec2f(t.first)); y2(2, vec2f(t.last));",
            reference: |x| {
                let [first, last] = tiles::touched_bins(&TILES, rects(&[x, &[0.0; 4]].concat()).0);
                [first.as_vec2().to_array(), last.as_vec2().to_array()].concat()
            },
            cases: random(100, &[(0.0, 40.9), (0.0, 24.9), (1.0, 20.9), (1.0, 20.9)]),
            tolerance: 0.0,
            mutants: &[("high + tiles.bin_side - 1u", "high"), ("high + tiles.bin_side - 1u", "high + tiles.bin_side")],
        },
    ]
}

/// Contents of the buffer of lists. The lists of the tests have five sprites; the words of `tile_refine` follow.
const LISTS: [u32; 16] = [3, 1, 4, 1, 5, 9, 2, 6, 0x5555_5555, 0x0f0f_0f0f, 0x1234_5678, 8, 9, 7, 9, 3];
const NUMBERS: [u32; 16] = [9, 8, 7, 6, 5, 4, 3, 2, 1, 0, 19, 18, 17, 16, 15, 14];

/// A list of five sprites that starts at a word from 0 to 3, or a bin without a list.
fn list(x: &[f32]) -> UVec2 {
    uvec2(if x[0] > 3.0 { tiles::NO_LIST } else { x[0] as u32 }, 5)
}

fn lists() -> Vec<Formula> {
    vec![
        Formula {
            name: "bin_list",
            file: "tile_bin.wgsl",
            wgsl: "tiles.columns = 5u; tiles.rows = 3u; tiles.capacity = word(6); counters.visible = 77u; \
                   atomicStore(&counters.entries, word(0)); let l = bin_list(word(2), word(4)); y_word(0, l.x); \
                   y_word(2, l.y); y_word(4, atomicLoad(&counters.entries));",
            reference: |x| {
                let tiles = TilesUniform { capacity: word(&x[6..]), ..TILES };
                let (list, entries) = tiles::bin_list(&tiles, 77, word(x), word(&x[2..]), word(&x[4..]));
                [halves(list.x), halves(list.y), halves(entries)].concat()
            },
            // Lists of up to twice their part of a 32-bit count, 0x1111_1111.
            cases: random(300, &[(0.0, 20000.0), HALF, (0.0, 4400.0), HALF, (0.0, 4400.0), HALF, (0.0, 20000.0), HALF]),
            tolerance: 0.0,
            mutants: &[
                ("length <= fraction && more <= fraction - length", "true"),
                ("is_counted && list_fits", "list_fits"),
                ("list_fits(first, size, tiles.capacity)", "true"),
                ("vec2u(first, length), fits", "vec2u(first, size), fits"),
            ],
        },
        Formula {
            name: "is_visible",
            file: "tile_gather.wgsl",
            wgsl: "SORTED = x(0) > 0.5; keys[3] = select(u32(x(1)), HIDDEN_KEY, x(1) > 5.0); y(0, f32(is_visible(3u)));",
            reference: |x| {
                let key = if x[1] > 5.0 { tiles::HIDDEN_KEY } else { x[1] as u32 };
                flag(tiles::is_visible(x[0] > 0.5, key))
            },
            cases: random(50, &[(0.0, 1.0), (0.0, 10.0)]),
            tolerance: 0.0,
            mutants: &[("!SORTED || keys", "keys"), ("!SORTED || keys[at] != HIDDEN_KEY", "true")],
        },
    ]
}

fn traversal() -> Vec<Formula> {
    vec![
        Formula {
            name: "sprite_index",
            file: "tile_accumulate.wgsl",
            wgsl: "lists = array<u32, 16>(3u, 1u, 4u, 1u, 5u, 9u, 2u, 6u, 0x55555555u, 0x0f0f0f0fu, 0x12345678u, 8u, 9u, \
                   7u, 9u, 3u); \
                   indices = array<u32, 16>(9u, 8u, 7u, 6u, 5u, 4u, 3u, 2u, 1u, 0u, 19u, 18u, 17u, 16u, 15u, 14u); \
                   let list = vec2u(select(u32(x(0)), NO_LIST, x(0) > 3.0), 5u); \
                   y(0, f32(sprite_index(list, u32(x(1)))));",
            reference: |x| vec![tiles::sprite_index(&LISTS, &NUMBERS, list(x), x[1] as u32) as f32],
            cases: random(60, &[(0.0, 6.0), (0.0, 4.9)]),
            tolerance: 0.0,
            mutants: &[("lists[list.x + at]", "lists[at]"), ("return indices[at];", "return at;")],
        },
        Formula {
            name: "bits_of",
            file: "tile_accumulate.wgsl",
            wgsl: "lists = array<u32, 16>(3u, 1u, 4u, 1u, 5u, 9u, 2u, 6u, 0x55555555u, 0x0f0f0f0fu, 0x12345678u, 8u, 9u, \
                   7u, 9u, 3u); let list = vec2u(select(u32(x(0)), NO_LIST, x(0) > 3.0), 5u); \
                   y_word(0, bits_of(list, 0u, u32(x(1))));",
            reference: |x| halves(tiles::bits_of(&LISTS, list(x), 0, x[1] as u32)).to_vec(),
            cases: random(60, &[(0.0, 6.0), (0.0, 5.9)]),
            tolerance: 0.0,
            mutants: &[("batch + part] & all", "batch + part]"), ("list.y - batch, BITS", "BITS_PER_WORD, BITS")],
        },
        Formula {
            name: "bits_below",
            file: "tile_accumulate.wgsl",
            wgsl: "y_word(0, bits_below(u32(x(0))));",
            reference: |x| halves(tiles::bits_below(x[0] as u32)).to_vec(),
            cases: (0..=33_u8).map(|count| vec![f32::from(count)]).collect(),
            tolerance: 0.0,
            mutants: &[("0xffffffffu, count >= 32u", "0u, count >= 32u"), ("(1u << count) - 1u", "(2u << count) - 1u")],
        },
        Formula {
            name: "count_below",
            file: "tile_accumulate.wgsl",
            wgsl: "y(0, f32(count_below(vec2u(0xda5a0f01u, 0x8000ffffu), u32(x(0)))));",
            reference: |x| vec![tiles::count_below(UVec2::new(0xda5a_0f01, 0x8000_ffff), x[0] as u32) as f32],
            cases: (0..=64_u8).map(|bit| vec![f32::from(bit)]).collect(),
            tolerance: 0.0,
            mutants: &[("min(bit, 32u)", "min(bit, 31u)"), ("max(bit, 32u) - 32u", "max(bit, 32u) - 31u")],
        },
        Formula {
            name: "is_opaque",
            file: "tile_accumulate.wgsl",
            wgsl: "STOPS = x(0) > 0.5; var t: Texel; t.transmittance = x(1); y(0, f32(is_opaque(t)));",
            reference: |x| flag(tiles::is_opaque(x[0] > 0.5, x[1])),
            cases: random(100, &[(0.0, 1.0), (0.0, 0.002)]),
            tolerance: 0.0,
            mutants: &[
                ("STOPS && texel.transmittance", "texel.transmittance"),
                ("transmittance <= OPAQUE", "transmittance <= 0.0"),
            ],
        },
        Formula {
            name: "is_opaque_or_occluded",
            file: "tile_accumulate.wgsl",
            wgsl: "STOPS = x(0) > 0.5; var t: Texel; t.transmittance = x(1); t.end = x(3); \
                   y(0, f32(is_opaque_or_occluded(t, x(2))));",
            reference: |x| flag(tiles::is_opaque_or_occluded(x[0] > 0.5, x[1], x[2], x[3])),
            cases: random(200, &[(0.0, 1.0), (0.0, 0.002), (1.0, 5.0), (1.0, 5.0)]),
            tolerance: 0.0,
            mutants: &[("is_opaque(texel) || front", "front"), ("front > texel.end", "front > texel.scene")],
        },
    ]
}

fn sort() -> Vec<Formula> {
    vec![Formula {
        name: "digit_of",
        file: "sort.wgsl",
        wgsl: "SHIFT = u32(x(2)); y(0, f32(digit_of(word(0))));",
        reference: |x| vec![tiles::digit_of(word(x), x[2] as u32) as f32],
        cases: random(60, &[HALF, HALF, (0.0, 24.9)]),
        tolerance: 0.0,
        mutants: &[("(key >> SHIFT)", "key"), ("& (DIGITS - 1u)", "% 255u")],
    }]
}
