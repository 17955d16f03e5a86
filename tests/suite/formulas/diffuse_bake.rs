//! Formula tests of `shaders/lib/diffuse_bake.wgsl`.

use glam::vec4;
use haze_core::formula::diffuse_bake;

use super::Formula;
use super::inputs::{
    ARITHMETIC, SpriteFrameTexture, TRANSCENDENTAL, random, test_sprite, unit_vectors, v2, v3, with_choices,
};

pub fn formulas() -> Vec<Formula> {
    [cube(), motif(), baked()].into_iter().flatten().collect()
}

fn cube() -> Vec<Formula> {
    vec![
        Formula {
            name: "cube_direction",
            file: "lib/diffuse_bake.wgsl",
            wgsl: "let v = cube_direction(i32(x(0)), vec2f(x(1), x(2))); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| diffuse_bake::cube_direction(x[0] as i32, v2(&x[1..])).to_array().to_vec(),
            cases: with_choices(6, &[(-1.0, 1.0), (-1.0, 1.0)]),
            tolerance: 0.0,
            mutants: &[("vec3f(1.0, position.y, -position.x)", "vec3f(1.0, position.y, position.x)")],
        },
        Formula {
            name: "cube_coordinate",
            file: "lib/diffuse_bake.wgsl",
            wgsl: "let c = cube_coordinate(vec3f(x(0), x(1), x(2))); y(0, f32(c.face)); y(1, c.position.x); y(2, c.position.y);",
            reference: |x| {
                let cube = diffuse_bake::cube_coordinate(v3(x));
                vec![cube.face as f32, cube.position.x, cube.position.y]
            },
            cases: random(300, &[(-1.0, 1.0); 3]),
            tolerance: ARITHMETIC,
            mutants: &[
                ("CubeCoordinate(3, vec2f(d.x, d.z))", "CubeCoordinate(3, vec2f(d.x, -d.z))"),
                ("size.y >= size.z {", "size.y <= size.z {"),
            ],
        },
    ]
}

fn motif() -> Vec<Formula> {
    vec![
        Formula {
            name: "motif_normal",
            file: "lib/diffuse_bake.wgsl",
            wgsl: "let v = motif_normal(vec2f(x(0), x(1))); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| diffuse_bake::motif_normal(v2(x)).to_array().to_vec(),
            cases: random(100, &[(-1.0, 1.0); 2]),
            tolerance: TRANSCENDENTAL,
            mutants: &[("sqrt(1.0 - square)", "1.0 - square")],
        },
        Formula {
            name: "motif_position",
            file: "lib/diffuse_bake.wgsl",
            wgsl: "let v = motif_position(vec3f(x(0), x(1), x(2))); y(0, v.x); y(1, v.y);",
            reference: |x| diffuse_bake::motif_position(v3(x)).to_array().to_vec(),
            cases: unit_vectors(random(100, &[(-1.0, 1.0); 3]), 0),
            tolerance: TRANSCENDENTAL,
            mutants: &[("normal.z >= 0.0", "normal.z >= -2.0")],
        },
    ]
}

fn baked() -> Vec<Formula> {
    vec![
        Formula {
            name: "sample_baked",
            file: "lib/diffuse_bake.wgsl",
            wgsl: "let v = sample_baked(test_sprite, test_sampler, vec2f(x(1), x(2)), i32(x(0))); \
                   y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| {
                diffuse_bake::sample_baked(&SpriteFrameTexture(test_sprite(), x[0] as u32), v2(&x[1..]))
                    .to_array()
                    .to_vec()
            },
            cases: with_choices(3, &[(-1.2, 1.2); 2]),
            tolerance: 1e-5,
            // The last mutant puts the border between texels, which would show seams between cube faces.
            mutants: &[
                ("low, layer, 0)", "low, 0, 0)"),
                ("position * 0.5 + 0.5", "vec2f(position.x, -position.y) * 0.5 + 0.5"),
                (
                    "let texel = saturate(position * 0.5 + 0.5) * (size - 1.0)",
                    "let texel = saturate(position * 0.5 + 0.5) * size - 0.5",
                ),
            ],
        },
        Formula {
            name: "spherical_harmonics",
            file: "lib/diffuse_bake.wgsl",
            wgsl: "var c: array<vec4f, 9>; for (var i = 0u; i < 9u; i++) { \
                   c[i] = vec4f(x(3u + i), x(12u + i), x(21u + i), 0.0); } \
                   let v = spherical_harmonics(c, vec3f(x(0), x(1), x(2))); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| {
                let coefficients = std::array::from_fn(|i| vec4(x[3 + i], x[12 + i], x[21 + i], 0.0));
                diffuse_bake::spherical_harmonics(&coefficients, v3(x)).to_array().to_vec()
            },
            cases: unit_vectors(random(100, &[(-1.0, 1.0); 30]), 0),
            tolerance: ARITHMETIC * 5.0,
            mutants: &[
                ("n.x * n.z * c[7].rgb", "n.x * n.z * c[6].rgb"),
                ("3.0 * n.z * n.z - 1.0", "3.0 * n.y * n.y - 1.0"),
                ("max(light, vec3f(0.0))", "light"),
            ],
        },
    ]
}
