//! Formula tests of `shaders/lib/sprite.wgsl`.

use glam::{Vec2, Vec4};
use haze_core::formula::sprite;
use haze_core::settings::SpriteAnimation;

use super::Formula;
use super::inputs::{ARITHMETIC, TRANSCENDENTAL, count, random, test_sprite, v2, v3, with_choices};

pub fn formulas() -> Vec<Formula> {
    [frames(), textures(), levels(), corners()].into_iter().flatten().collect()
}

fn frames() -> Vec<Formula> {
    vec![
        Formula {
            name: "sprite_lod",
            file: "lib/sprite.wgsl",
            wgsl: "y(0, sprite_lod(x(0), x(1)));",
            reference: |x| vec![sprite::sprite_lod(x[0], x[1])],
            cases: random(50, &[(8.0, 512.0), (0.0, 600.0)]),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("sprite_size / max", "0.5 * sprite_size / max"),
                ("1.0e-3)) + 0.5)", "1.0e-3)))"),
                ("max(floor(", "max(("),
            ],
        },
        Formula {
            name: "flipbook_frames",
            file: "lib/sprite.wgsl",
            wgsl: "let f = flipbook_frames(x(0), x(1)); y(0, f32(f.first)); y(1, f32(f.second)); y(2, f.blend);",
            reference: |x| {
                let frames = sprite::flipbook_frames(x[0], x[1]);
                vec![frames.first as f32, frames.second as f32, frames.blend]
            },
            cases: (-40_i32..120).map(|i| vec![i as f32 * 0.37, (1 + i.rem_euclid(9)) as f32]).collect(),
            tolerance: 1e-5,
            mutants: &[("first + 1.5 > frame_count", "false"), ("floor(frame / frame_count)", "0.0")],
        },
        Formula {
            name: "animation_frames",
            file: "lib/sprite.wgsl",
            wgsl: "let f = animation_frames(u32(x(0)), x(1), 4.0); y(0, f32(f.first)); y(1, f32(f.second)); y(2, f.blend);",
            reference: |x| {
                let frames = sprite::animation_frames(SpriteAnimation::ALL[x[0] as usize], x[1], 4.0);
                vec![frames.first as f32, frames.second as f32, frames.blend]
            },
            cases: with_choices(count(SpriteAnimation::ALL), &[(0.0, 9.0)]),
            tolerance: 1e-5,
            mutants: &[
                ("animation == SPRITE_ANIMATION_STILL ||", ""),
                ("|| animation == SPRITE_ANIMATION_NEAREST", ""),
            ],
        },
        Formula {
            name: "offset_frames",
            file: "lib/sprite.wgsl",
            wgsl: "let f = offset_frames(flipbook_frames(x(0), 5.0), i32(x(1))); \
                   y(0, f32(f.first)); y(1, f32(f.second)); y(2, f.blend);",
            reference: |x| {
                let frames = sprite::offset_frames(sprite::flipbook_frames(x[0], 5.0), x[1] as i32);
                vec![frames.first as f32, frames.second as f32, frames.blend]
            },
            cases: random(50, &[(0.0, 9.0), (0.0, 12.0)]),
            tolerance: ARITHMETIC,
            mutants: &[("frames.first + layers", "frames.first"), ("frames.second + layers", "frames.first + layers")],
        },
        Formula {
            name: "sprite_frame",
            file: "lib/sprite.wgsl",
            wgsl: "y(0, sprite_frame(u32(x(0)), x(1), x(2), x(3)));",
            reference: |x| vec![sprite::sprite_frame(SpriteAnimation::ALL[x[0] as usize], x[1], x[2], x[3])],
            cases: with_choices(count(SpriteAnimation::ALL), &[(0.0, 9.0), (-0.2, 1.2), (1.0, 9.0)]),
            tolerance: ARITHMETIC,
            mutants: &[
                ("frame_count - 1.0);", "frame_count);"),
                ("STILL: { return 0.0; }", "STILL: { return frame; }"),
                ("return frame + 0.5;", "return frame;"),
            ],
        },
    ]
}

fn textures() -> Vec<Formula> {
    vec![
        Formula {
            name: "sample_sprite",
            file: "lib/sprite.wgsl",
            wgsl: "let f = flipbook_frames(x(2), 3.0); \
                   let v = sample_sprite(test_sprite, test_sampler, vec2f(x(0), x(1)), f, vec2f(x(4), x(5)), x(3)); \
                   y(0, v.x); y(1, v.y); y(2, v.z); y(3, v.w);",
            reference: |x| {
                let frames = sprite::flipbook_frames(x[2], 3.0);
                sprite::sample_sprite(&test_sprite(), v2(x), frames, v2(&x[4..]), x[3]).to_array().to_vec()
            },
            cases: random(300, &[(0.0, 1.0), (0.0, 1.0), (0.0, 9.0), (0.0, 4.0), (-0.2, 0.2), (-0.2, 0.2)]),
            tolerance: 1e-5,
            mutants: &[
                ("mix(texel, next, frames.blend)", "texel"),
                ("mix(fine, coarse, level - base)", "fine"),
                ("texel.rgb * 2.0 - 1.0", "texel.rgb"),
                ("uv * vec2f(size) - 0.5", "uv * vec2f(size)"),
                ("uv - motion * frames.blend", "uv + motion * frames.blend"),
                ("motion * (1.0 - frames.blend)", "motion * frames.blend"),
            ],
        },
        Formula {
            name: "detail_from_texel",
            file: "lib/sprite.wgsl",
            wgsl: "let v = detail_from_texel(vec3f(x(0), x(1), x(2))); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| sprite::detail_from_texel(v3(x)).to_array().to_vec(),
            cases: random(50, &[(0.0, 1.0); 3]),
            tolerance: ARITHMETIC,
            mutants: &[("- 128.0", "- 127.5"), ("vec3f(1.0, MOTION_RANGE", "vec3f(MOTION_RANGE, MOTION_RANGE")],
        },
        Formula {
            name: "sample_detail",
            file: "lib/sprite.wgsl",
            wgsl: "let f = flipbook_frames(x(2), 3.0); \
                   let v = sample_detail(test_sprite, test_sampler, vec2f(x(0), x(1)), f, x(3)); \
                   y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| {
                let frames = sprite::flipbook_frames(x[2], 3.0);
                sprite::sample_detail(&test_sprite(), v2(x), frames, x[3]).to_array().to_vec()
            },
            cases: random(200, &[(0.0, 1.0), (0.0, 1.0), (0.0, 9.0), (0.0, 4.0)]),
            tolerance: 1e-5,
            mutants: &[("mix(first.x, second.x, frames.blend)", "first.x"), ("first.yz", "second.yz")],
        },
        Formula {
            name: "load_sprite_bilinear",
            file: "lib/sprite.wgsl",
            wgsl: "y4(0, load_sprite_bilinear(test_sprite, vec2f(x(0), x(1)), i32(x(2)), i32(x(3))));",
            reference: |x| {
                let texel = sprite::load_sprite_bilinear(&test_sprite(), v2(x), x[2] as i32, x[3] as u32);
                texel.to_array().to_vec()
            },
            cases: random(200, &[(-0.2, 1.2), (-0.2, 1.2), (0.0, 2.99), (0.0, 3.99)]),
            tolerance: 1e-5,
            mutants: &[
                ("uv * vec2f(size) - 0.5", "uv * vec2f(size)"),
                ("vec2i(high.x, low.y), frame", "low, frame"),
                ("mix(top, bottom, fraction.y)", "mix(bottom, top, fraction.y)"),
            ],
        },
    ]
}

fn levels() -> Vec<Formula> {
    vec![
        Formula {
            name: "last_level",
            file: "lib/sprite.wgsl",
            wgsl: "y(0, last_level(test_sprite));",
            reference: |_| vec![sprite::last_level(&test_sprite())],
            cases: vec![vec![]],
            tolerance: 0.0,
            mutants: &[("+ 1.0e-3)", "+ 1.0)"), ("+ 1.0e-3)", "- 1.0e-3)")],
        },
        Formula {
            name: "sample_sprite_frame",
            file: "lib/sprite.wgsl",
            wgsl: "y4(0, sample_sprite_frame(test_sprite, test_sampler, vec2f(x(0), x(1)), i32(x(2)), x(3)));",
            reference: |x| sprite::sample_sprite_frame(&test_sprite(), v2(x), x[2] as i32, x[3]).to_array().to_vec(),
            cases: random(200, &[(0.0, 1.0), (0.0, 1.0), (0.0, 2.99), (0.0, 5.0)]),
            tolerance: 1e-5,
            mutants: &[("min(lod, last)", "lod * 0.5"), ("mix(fine, coarse, level - base)", "fine")],
        },
        Formula {
            name: "sample_at_level",
            file: "lib/sprite.wgsl",
            // At whole levels, loads and lookups give the same texel.
            wgsl: "LOADS_SPRITE = x(4) > 0.5; \
                   y4(0, sample_at_level(test_sprite, test_sampler, vec2f(x(0), x(1)), i32(x(2)), floor(x(3))));",
            reference: |x| {
                sprite::sample_sprite_frame(&test_sprite(), v2(x), x[2] as i32, x[3].floor()).to_array().to_vec()
            },
            cases: random(200, &[(0.0, 1.0), (0.0, 1.0), (0.0, 2.99), (0.0, 5.0), (0.0, 1.0)]),
            tolerance: 1e-5,
            mutants: &[("min(level, last_level(sprite))", "0.0"), ("uv, frame, level);", "uv, frame, 0.0);")],
        },
        Formula {
            name: "sample_flipbook",
            file: "lib/sprite.wgsl",
            wgsl: "let f = flipbook_frames(x(2), 3.0); \
                   y4(0, sample_flipbook(test_sprite, test_sampler, vec2f(x(0), x(1)), f, vec2f(x(3), x(4)), x(5)));",
            reference: |x| {
                let frames = sprite::flipbook_frames(x[2], 3.0);
                sprite::sample_flipbook(&test_sprite(), v2(x), frames, v2(&x[3..]), x[5]).to_array().to_vec()
            },
            cases: random(200, &[(0.0, 1.0), (0.0, 1.0), (0.0, 9.0), (-0.1, 0.1), (-0.1, 0.1), (0.0, 4.0)]),
            tolerance: 1e-5,
            mutants: &[
                ("uv - motion * frames.blend", "uv"),
                ("uv + motion * (1.0 - frames.blend)", "uv + motion"),
                ("mix(texel, next, frames.blend)", "texel"),
            ],
        },
    ]
}

fn corners() -> Vec<Formula> {
    vec![
        Formula {
            name: "sprite_corner",
            file: "lib/sprite.wgsl",
            wgsl: "y2(0, sprite_corner(u32(x(0))));",
            reference: |x| sprite::sprite_corner(x[0] as u32).to_array().to_vec(),
            cases: (0..4_u8).map(|corner| vec![f32::from(corner)]).collect(),
            tolerance: 0.0,
            mutants: &[("f32(index >> 1u)", "f32(index & 1u)")],
        },
        Formula {
            name: "unrotate",
            file: "lib/sprite.wgsl",
            wgsl: "let v = unrotate(vec2f(x(0), x(1)), vec2f(x(2), x(3))); y(0, v.x); y(1, v.y);",
            reference: |x| sprite::unrotate(v2(x), v2(&x[2..])).to_array().to_vec(),
            cases: random(50, &[(-1.0, 1.0); 4]),
            tolerance: ARITHMETIC,
            mutants: &[("offset.x * rotation.x + offset.y", "offset.x * rotation.x - offset.y")],
        },
        Formula {
            name: "trimmed_corner",
            file: "lib/sprite.wgsl",
            wgsl: "let v = trimmed_corner(sprite_corner(u32(x(0))), vec4f(x(1), x(2), x(3), x(4))); y(0, v.x); y(1, v.y);",
            reference: |x| {
                let corner = [Vec2::NEG_ONE, Vec2::new(1.0, -1.0), Vec2::new(-1.0, 1.0), Vec2::ONE][x[0] as usize];
                sprite::trimmed_corner(corner, Vec4::from_slice(&x[1..])).to_array().to_vec()
            },
            cases: with_choices(4, &[(0.0, 1.0); 4]),
            tolerance: ARITHMETIC,
            mutants: &[("-reach.xy, reach.zw", "-reach.zw, reach.xy"), ("corner > vec2f(0.0)", "vec2<bool>(true)")],
        },
        Formula {
            name: "sprite_uv",
            file: "lib/sprite.wgsl",
            wgsl: "let v = sprite_uv(vec2f(x(0), x(1))); y(0, v.x); y(1, v.y);",
            reference: |x| sprite::sprite_uv(v2(x)).to_array().to_vec(),
            cases: random(50, &[(-1.0, 1.0); 2]),
            tolerance: ARITHMETIC,
            mutants: &[("0.5 - corner.y * 0.5", "0.5 + corner.y * 0.5")],
        },
        Formula {
            name: "checkerboard",
            file: "lib/sprite.wgsl",
            wgsl: "let v = checkerboard(vec2f(x(0), x(1))); y(0, v.z); y(1, v.w);",
            reference: |x| vec![sprite::checkerboard(v2(x)).z, sprite::checkerboard(v2(x)).w],
            cases: random(100, &[(0.0, 1.0); 2]),
            tolerance: 0.0,
            mutants: &[("check.x + check.y", "check.x")],
        },
    ]
}
