//! Formula tests of `shaders/lib/tile_sprite.wgsl`, and of the tests of a sprite in `shaders/tile_accumulate.wgsl` and
//! `shaders/tile_refine.wgsl`.

mod cells;

use glam::{UVec2, Vec2, Vec4};
use haze_core::formula::texture::Texture2d;
use haze_core::formula::view::{ndc_from_pixel, pixel_from_ndc};
use haze_core::formula::{depth, sprite, tile_sprite};

use super::Formula;
use super::fixture::{DEFAULTS, DEPTHS, visible_system};
use super::inputs::{ARITHMETIC, HALF, halves, random, test_ramp, v2, v4, with_choices, word};

/// A sprite at a position in the target, rotated.
fn uv_from_texels(x: &[f32]) -> Vec4 {
    v4(x) * 0.1
}

/// WGSL of [`uv_from_texels`], and of the center in numbers 4 and 5.
macro_rules! with_sprite {
    ($wgsl:literal) => {
        concat!(
            "var s: TileSprite; s.uv_from_texels = vec4f(x(0), x(1), x(2), x(3)) * 0.1; \
             s.center_radius = vec4f(x(4), x(5), -5.0, 1.0); ",
            $wgsl
        )
    };
}

const SIDE: (f32, f32) = (-1.0, 1.0);
const TEXEL: (f32, f32) = (0.0, 10.0);

pub fn formulas() -> Vec<Formula> {
    [packing(), cells::formulas(), squares(), texels(), sprites()].into_iter().flatten().collect()
}

fn packing() -> Vec<Formula> {
    vec![
        Formula {
            name: "packed_frames",
            file: "lib/tile_sprite.wgsl",
            wgsl: "y_word(0, packed_frames(FlipbookFrames(i32(x(0)), i32(x(1)), 0.5), x(2)));",
            reference: |x| {
                let frames = sprite::FlipbookFrames { first: x[0] as i32, second: x[1] as i32, blend: 0.5 };
                halves(tile_sprite::packed_frames(frames, x[2])).to_vec()
            },
            cases: random(60, &[(0.0, 2047.9), (0.0, 2047.9), (0.0, 300.0)]),
            tolerance: 0.0,
            mutants: &[
                ("<< 12u) | (u32(min(lod, 255.0))", "<< 12u) | (u32(lod)"),
                ("u32(frames.second) << 12u", "u32(frames.second) << 11u"),
            ],
        },
        Formula {
            name: "packed_blend",
            file: "lib/tile_sprite.wgsl",
            wgsl: "GRAIN_OCTAVES = u32(x(0)); var s: TileSprite; s.blend_erosion = packed_blend(x(1), x(2)); \
                   y2(0, blend_and_erosion(s));",
            reference: |x| vec![x[1], if x[0] > 0.0 { x[2] } else { 0.0 }],
            cases: with_choices(3, &[(0.0, 1.0), (0.0, 1.0)]),
            // Half a step of 16 bits.
            tolerance: 8e-6,
            mutants: &[
                ("vec2f(blend, erosion)", "vec2f(erosion, blend)"),
                ("return unpack2x16unorm(sprite.blend_erosion)", "return unpack2x16snorm(sprite.blend_erosion)"),
            ],
        },
        Formula {
            name: "frames_of",
            file: "lib/tile_sprite.wgsl",
            wgsl: "var s: TileSprite; s.frames_lod = word(0); s.blend_erosion = bitcast<u32>(x(2)); let f = frames_of(s); \
                   y3(0, vec3f(f32(f.first), f32(f.second), f.blend));",
            reference: |x| {
                let frames = tile_sprite::frames_of(word(x), x[2]);
                vec![frames.first as f32, frames.second as f32, frames.blend]
            },
            cases: random(60, &[HALF, HALF, (0.0, 1.0)]),
            tolerance: 0.0,
            mutants: &[(">> 12u) & 0xfffu", ">> 12u) & 0xffu"), ("blend_and_erosion(sprite).x);", "0.0);")],
        },
        Formula {
            name: "lod_of",
            file: "lib/tile_sprite.wgsl",
            wgsl: "var s: TileSprite; s.frames_lod = word(0); y(0, lod_of(s));",
            reference: |x| vec![tile_sprite::lod_of(word(x))],
            cases: random(60, &[HALF, HALF]),
            tolerance: 0.0,
            mutants: &[("sprite.frames_lod >> 24u", "sprite.frames_lod >> 23u")],
        },
        Formula {
            name: "bytes_below",
            file: "lib/tile_sprite.wgsl",
            wgsl: "y_word(0, bytes_below(u32(x(0))));",
            reference: |x| halves(tile_sprite::bytes_below(x[0] as u32)).to_vec(),
            cases: (0..=4_u8).map(|count| vec![f32::from(count)]).collect(),
            tolerance: 0.0,
            // The mutant shifts once, by 32 for four bytes, which WGSL takes modulo 32.
            mutants: &[("((0xffffffffu << (count * 4u)) << (count * 4u))", "(0xffffffffu << ((count * 8u) % 32u))")],
        },
    ]
}

fn squares() -> Vec<Formula> {
    vec![
        Formula {
            name: "uv_in_square",
            file: "lib/tile_sprite.wgsl",
            wgsl: with_sprite!("y2(0, uv_in_square(s, vec2f(x(6), x(7))));"),
            reference: |x| tile_sprite::uv_in_square(uv_from_texels(x), v2(&x[4..]), v2(&x[6..])).to_array().to_vec(),
            cases: random(100, &[SIDE, SIDE, SIDE, SIDE, TEXEL, TEXEL, TEXEL, TEXEL]),
            tolerance: ARITHMETIC,
            mutants: &[
                ("dot(sprite.uv_from_texels.zw, offset)", "dot(sprite.uv_from_texels.yw, offset)"),
                (", offset)) + 0.5;", ", offset));"),
            ],
        },
        Formula {
            name: "reach_in_square",
            file: "lib/tile_sprite.wgsl",
            wgsl: with_sprite!("y2(0, reach_in_square(s, vec2f(x(6), x(7))));"),
            reference: |x| tile_sprite::reach_in_square(uv_from_texels(x), v2(&x[6..])).to_array().to_vec(),
            cases: random(100, &[SIDE, SIDE, SIDE, SIDE, TEXEL, TEXEL, TEXEL, TEXEL]),
            tolerance: ARITHMETIC,
            mutants: &[
                ("abs(sprite.uv_from_texels)", "sprite.uv_from_texels"),
                ("dot(matrix.xy, half_size + 0.01)", "dot(matrix.xy, half_size)"),
            ],
        },
        Formula {
            name: "approximate_amount",
            file: "tile_refine.wgsl",
            wgsl: with_sprite!("s.amount = x(8); sprites[3] = s; y(0, approximate_amount(3u, vec2f(x(6), x(7))));"),
            reference: |x| {
                let uv = tile_sprite::uv_in_square(uv_from_texels(x), v2(&x[4..]), v2(&x[6..]));
                vec![tile_sprite::approximate_amount(x[8], uv)]
            },
            cases: random(200, &[SIDE, SIDE, SIDE, SIDE, TEXEL, TEXEL, TEXEL, TEXEL, (0.0, 1.0)]),
            tolerance: ARITHMETIC,
            mutants: &[("thickness * thickness", "thickness"), ("max(1.0 - dot(position, position), 0.0)", "1.0")],
        },
    ]
}

fn texels() -> Vec<Formula> {
    vec![
        Formula {
            name: "ray_through_texel",
            file: "lib/tile_sprite.wgsl",
            wgsl: "system.scale = u32(x(2)); system.target_origin = vec2f(x(3), x(4)); view.ray_offset = vec2f(0.1, -0.2); \
                   y2(0, ray_through_texel(vec2f(x(0), x(1))));",
            reference: |x| {
                let view = visible_system(&DEFAULTS).view;
                let ray = ndc_from_pixel((v2(x) + v2(&x[3..])) * x[2].floor(), view.size) * view.ray_scale;
                (ray + Vec2::new(0.1, -0.2)).to_array().to_vec()
            },
            cases: random(60, &[TEXEL, TEXEL, (1.0, 4.0), (-3.0, 3.0), (-3.0, 3.0)]),
            tolerance: ARITHMETIC,
            mutants: &[
                ("texel + system.target_origin", "texel"),
                ("* view.ray_scale + view.ray_offset", "* view.ray_scale"),
            ],
        },
        Formula {
            name: "texel_of_ray",
            file: "tile_project.wgsl",
            wgsl: "system.scale = u32(x(2)); system.target_origin = vec2f(x(3), x(4)); view.ray_offset = vec2f(0.1, -0.2); \
                   y2(0, texel_of_ray(vec2f(x(0), x(1))));",
            reference: |x| {
                let view = visible_system(&DEFAULTS).view;
                let ndc = (v2(x) - Vec2::new(0.1, -0.2)) / view.ray_scale;
                (pixel_from_ndc(ndc, view.size) / x[2].floor() - v2(&x[3..])).to_array().to_vec()
            },
            cases: random(60, &[SIDE, SIDE, (1.0, 4.0), (-3.0, 3.0), (-3.0, 3.0)]),
            tolerance: ARITHMETIC * 10.0,
            mutants: &[("(ray - view.ray_offset)", "ray")],
        },
        Formula {
            name: "texel_of_ndc",
            file: "tile_project.wgsl",
            wgsl: "system.scale = u32(x(2)); system.target_origin = vec2f(x(3), x(4)); \
                   y2(0, texel_of_ndc(vec2f(x(0), x(1))));",
            reference: |x| {
                let size = visible_system(&DEFAULTS).view.size;
                (pixel_from_ndc(v2(x), size) / x[2].floor() - v2(&x[3..])).to_array().to_vec()
            },
            cases: random(60, &[SIDE, SIDE, (1.0, 4.0), (-3.0, 3.0), (-3.0, 3.0)]),
            tolerance: ARITHMETIC,
            mutants: &[
                ("/ f32(system.scale) - system.target_origin", "/ f32(system.scale)"),
                ("view.size) / f32(system.scale) -", "view.size) -"),
            ],
        },
    ]
}

fn sprites() -> Vec<Formula> {
    vec![
        Formula {
            name: "tested_view_depth",
            file: "lib/tile_sprite.wgsl",
            wgsl: "LINEAR_DEPTH = true; HOST_DEPTH = x(0) > 0.5; system.target_origin = vec2f(2.0, -1.0); view.origin = vec2f(1.0, 2.0); \
                   y(0, tested_view_depth(test_ramp, vec2u(u32(x(1)), u32(x(2)))));",
            reference: |x| {
                let visible = visible_system(&DEFAULTS);
                let position = UVec2::new(x[1] as u32, x[2] as u32);
                vec![match x[0] > 0.5 {
                    true => {
                        let texel = test_ramp().load(position + UVec2::new(3, 1)).x;
                        depth::view_depth_from_linear(texel + visible.view.depth_offset)
                    }
                    false => test_ramp().load(position).x * visible.system.depth_limit,
                }]
            },
            cases: with_choices(2, &[(0.0, 4.99), (0.0, 2.99)]),
            tolerance: 1e-4,
            mutants: &[
                ("texel, 0).r * system.depth_limit", "texel, 0).r"),
                ("if HOST_DEPTH {\n        // At", "if !HOST_DEPTH {\n        // At"),
                ("system.target_origin + view.origin", "system.target_origin"),
                ("system.target_origin + view.origin", "view.origin"),
            ],
        },
        Formula {
            name: "farthest_visible_depth",
            file: "tile_refine.wgsl",
            wgsl: "system.show_through_distance = x(4); \
                   y(0, farthest_visible_depth(vec2u(u32(x(0)), u32(x(1))), vec2u(u32(x(2)), u32(x(3)))));",
            reference: |x| {
                let limit = visible_system(&DEFAULTS).system.depth_limit;
                let rows = x[1] as i32..x[3] as i32;
                let texels =
                    rows.flat_map(|row| (x[0] as i32..x[2] as i32).map(move |column| glam::IVec2::new(column, row)));
                vec![texels.map(|at| DEPTHS.load(at) * limit).fold(0.0, f32::max) + x[4]]
            },
            cases: random(60, &[(0.0, 3.9), (0.0, 1.9), (3.0, 8.9), (2.0, 4.9), (0.0, 1.0)]),
            tolerance: 1e-4,
            mutants: &[
                ("return farthest + system.show_through_distance", "return farthest"),
                ("max(farthest, tested", "min(farthest, tested"),
            ],
        },
        Formula {
            name: "fragment_of",
            file: "lib/tile_sprite.wgsl",
            wgsl: with_sprite!(
                "TECHNIQUE = select(TECHNIQUE_SOFT, TECHNIQUE_SPHERICAL_BILLBOARD, x(8) > 0.5); \
                 s.amount = 0.25; s.frames_lod = 0x3001002u; s.rotation = vec2f(0.6, 0.8); s.weight = 0.75; \
                 let f = fragment_of(s, vec2f(9.0, 7.0), vec2f(0.2, 0.4), vec2f(x(6), x(7))); y2(0, f.uv); \
                 y3(2, f.view_position); y4(5, f.amount_lod_frame_erosion); y4(9, f.center_radius); y2(13, f.rotation); \
                 y(15, f.weight); y4(16, f.position);"
            ),
            reference: |x| {
                let is_sphere = x[8] > 0.5;
                let uv = if is_sphere { [0.0; 2] } else { [x[6], x[7]] };
                let ray = if is_sphere { [0.2, 0.4, -1.0] } else { [0.0; 3] };
                let fade = [0.25, 3.0, 0.0, 0.0];
                let center = [x[4], x[5], -5.0, 1.0];
                let rest = [0.6, 0.8, 0.75, 9.0, 7.0, 0.0, 1.0];
                [&uv[..], &ray, &fade, &center, &rest].concat()
            },
            cases: random(40, &[SIDE, SIDE, SIDE, SIDE, TEXEL, TEXEL, TEXEL, TEXEL, (0.0, 1.0)]),
            tolerance: ARITHMETIC,
            mutants: &[
                ("out.rotation = sprite.rotation;\n    out.weight", "out.weight"),
                (
                    "if is_sphere() {\n        out.view_position = view_position(ray",
                    "if !is_sphere() {\n        out.view_position = view_position(ray",
                ),
            ],
        },
    ]
}
