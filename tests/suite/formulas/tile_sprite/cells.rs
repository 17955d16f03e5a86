//! Formula tests of the filled cells of a sprite.

use glam::{UVec2, uvec2};
use haze_core::formula::{sprite, tile_sprite};

use super::super::Formula;
use super::super::inputs::{HALF, flag, halves, random, test_sprite, v2, word};

/// Two words of cells, with about a quarter of the cells filled.
fn cells(x: &[f32]) -> UVec2 {
    uvec2(word(x) & word(&x[1..]), word(&x[2..]) & word(&x[1..]))
}

/// WGSL of [`cells`].
macro_rules! with_cells {
    ($wgsl:literal) => {
        concat!("let cells = vec2u(word(0) & word(1), word(2) & word(1)); ", $wgsl)
    };
}

pub fn formulas() -> Vec<Formula> {
    vec![
        Formula {
            name: "filled_cells",
            file: "tile_project.wgsl",
            wgsl: "let c = filled_cells(flipbook_frames(x(0), 3.0), x(1)); y_word(0, c.x); y_word(2, c.y);",
            reference: |x| {
                let frames = sprite::flipbook_frames(x[0], 3.0);
                let bounds = test_sprite().alpha_bounds(None);
                let cells = |frame: i32| {
                    let words: Vec<u32> = bytemuck::pod_collect_to_vec(bounds.bytes());
                    let level = (x[1] as u32).min(bounds.size().x - 1);
                    let at = 4 * (frame as u32 * bounds.size().x + level) as usize;
                    [words[at], words[at + 1]]
                };
                let second = if frames.blend > 0.0 { cells(frames.second) } else { [0; 2] };
                let [upper, lower] = cells(frames.first);
                [halves(upper | second[0]), halves(lower | second[1])].concat()
            },
            cases: random(60, &[(0.0, 3.0), (0.0, 5.0)]),
            tolerance: 0.0,
            mutants: &[(
                "let cells = alpha_bounds_texel(frames.first, lod)",
                "let cells = alpha_bounds_texel(frames.first, 0.0)",
            )],
        },
        Formula {
            name: "cell_at",
            file: "lib/tile_sprite.wgsl",
            wgsl: "y2(0, vec2f(cell_at(vec2f(x(0), x(1)))));",
            reference: |x| tile_sprite::cell_at(v2(x)).as_vec2().to_array().to_vec(),
            cases: random(100, &[(-0.2, 1.2); 2]),
            tolerance: 0.0,
            mutants: &[("clamp(uv * 8.0, vec2f(0.0)", "clamp(uv * 8.0, vec2f(-9.0)"), ("vec2f(7.0)", "vec2f(6.0)")],
        },
        Formula {
            name: "is_filled",
            file: "lib/tile_sprite.wgsl",
            wgsl: with_cells!("y(0, f32(is_filled(cells, vec2f(x(4), x(5)))));"),
            reference: |x| flag(tile_sprite::is_filled(cells(x), v2(&x[4..]))),
            cases: random(400, &[HALF, HALF, HALF, HALF, (-0.2, 1.2), (-0.2, 1.2)]),
            tolerance: 0.0,
            mutants: &[
                ("select(cells.x, cells.y,", "select(cells.y, cells.x,"),
                ("(bits.x >> 20u) & 7u", "(bits.x >> 21u) & 7u"),
                ("max(bits.x, bits.y) < 0x800000u && ", ""),
            ],
        },
        Formula {
            name: "is_filled_between",
            file: "lib/tile_sprite.wgsl",
            wgsl: with_cells!(
                "let low = vec2f(x(4), x(5)); \
                 y(0, f32(is_filled_between(cells, low, low + vec2f(x(6), x(7)))));"
            ),
            reference: |x| {
                let low = v2(&x[4..]);
                flag(tile_sprite::is_filled_between(cells(x), low, low + v2(&x[6..])))
            },
            cases: random(400, &[HALF, HALF, HALF, HALF, (-0.2, 1.2), (-0.2, 1.2), (0.0, 0.5), (0.0, 0.5)]),
            tolerance: 0.0,
            mutants: &[
                ("(2u << last.x) - (1u << first.x)", "(1u << last.x) - (1u << first.x)"),
                ("min(last.y + 1u, 4u)", "min(last.y, 4u)"),
                ("max(last.y, 3u) - 3u", "max(last.y, 4u) - 4u"),
                ("& ~bytes_below(min(first.y, 4u))", ""),
            ],
        },
        Formula {
            name: "is_full_between",
            file: "lib/tile_sprite.wgsl",
            // Most cells are filled.
            wgsl: with_cells!(
                "let low = vec2f(x(4), x(5)); \
                 y(0, f32(is_full_between(~cells, low, low + vec2f(x(6), x(7)))));"
            ),
            reference: |x| {
                let low = v2(&x[4..]);
                flag(tile_sprite::is_full_between(!cells(x), low, low + v2(&x[6..])))
            },
            cases: random(400, &[HALF, HALF, HALF, HALF, (-0.1, 1.0), (-0.1, 1.0), (0.0, 0.2), (0.0, 0.2)]),
            tolerance: 0.0,
            mutants: &[
                ("all(low >= vec2f(0.0)) && all(high", "all(high"),
                ("all(high < vec2f(1.0)) && !is", "!is"),
                ("!is_filled_between(~cells", "is_filled_between(cells"),
            ],
        },
        Formula {
            name: "square_fills",
            file: "lib/tile_sprite.wgsl",
            wgsl: with_cells!(
                "var s: TileSprite; s.filled = cells; \
                 y(0, f32(square_fills(s, vec2f(x(4), x(5)), vec2f(x(6), x(7)))));"
            ),
            reference: |x| flag(tile_sprite::square_fills(cells(x), v2(&x[4..]), v2(&x[6..]))),
            cases: random(400, &[HALF, HALF, HALF, HALF, (-0.6, 1.6), (-0.6, 1.6), (0.0, 0.3), (0.0, 0.3)]),
            tolerance: 0.0,
            mutants: &[("all(abs(uv - 0.5) <= reach + 0.5) && ", ""), ("uv - reach, uv + reach", "uv, uv + reach")],
        },
        Formula {
            name: "touches",
            file: "tile_accumulate.wgsl",
            wgsl: with_cells!(
                "var s: TileSprite; s.filled = cells; \
                 TECHNIQUE = select(TECHNIQUE_SOFT, TECHNIQUE_SPHERICAL_BILLBOARD, x(6) > 0.5); \
                 y(0, f32(touches(s, vec2f(x(4), x(5)))));"
            ),
            reference: |x| flag(tile_sprite::touches(x[6] > 0.5, cells(x), v2(&x[4..]))),
            cases: random(200, &[HALF, HALF, HALF, HALF, (-0.2, 1.2), (-0.2, 1.2), (0.0, 1.0)]),
            tolerance: 0.0,
            mutants: &[("is_sphere() || is_filled", "is_filled"), ("is_filled(sprite.filled, uv);", "true;")],
        },
        Formula {
            name: "covers",
            file: "tile_accumulate.wgsl",
            wgsl: "TECHNIQUE = select(TECHNIQUE_SOFT, TECHNIQUE_SPHERICAL_BILLBOARD, x(2) > 0.5); \
                   y(0, f32(covers(vec2f(x(0), x(1)))));",
            reference: |x| flag(tile_sprite::covers(x[2] > 0.5, v2(x))),
            cases: random(200, &[(-0.3, 1.3), (-0.3, 1.3), (0.0, 1.0)]),
            tolerance: 0.0,
            mutants: &[("is_sphere() || (all", "(all"), ("all(uv < vec2f(1.0))", "any(uv < vec2f(1.0))")],
        },
    ]
}
