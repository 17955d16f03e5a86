//! Formula tests of `shaders/lib/six_way.wgsl`.

use glam::Vec2;
use haze_core::formula::six_way;

use super::Formula;
use super::inputs::{ARITHMETIC, TRANSCENDENTAL, random, unit_vectors, v2, v3};

/// Ranges of the inputs: brightness under light from each of six sides, direction to the light, anisotropy.
const SIX_WAY_AND_LIGHT: [(f32, f32); 10] = {
    const BRIGHTNESS: (f32, f32) = (0.0, 1.0);
    const AXIS: (f32, f32) = (-1.0, 1.0);
    [BRIGHTNESS, BRIGHTNESS, BRIGHTNESS, BRIGHTNESS, BRIGHTNESS, BRIGHTNESS, AXIS, AXIS, AXIS, (0.1, 0.95)]
};

pub fn formulas() -> Vec<Formula> {
    [responses(), rotations()].into_iter().flatten().collect()
}

fn responses() -> Vec<Formula> {
    vec![
        Formula {
            name: "six_way_from_texel",
            file: "lib/six_way.wgsl",
            wgsl: "let v = six_way_from_texel(vec3f(x(0), x(1), x(2))); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| six_way::six_way_from_texel(v3(x)).to_array().to_vec(),
            cases: random(20, &[(0.0, 1.0); 3]),
            tolerance: ARITHMETIC,
            mutants: &[("texel * texel", "texel")],
        },
        Formula {
            name: "six_way_response",
            file: "lib/six_way.wgsl",
            wgsl: "y(0, six_way_response(vec3f(x(0), x(1), x(2)), vec3f(x(3), x(4), x(5)), vec3f(x(6), x(7), x(8)), x(9)));",
            reference: |x| vec![six_way::six_way_response(v3(x), v3(&x[3..]), v3(&x[6..]), x[9])],
            cases: unit_vectors(random(100, &SIX_WAY_AND_LIGHT), 6),
            tolerance: TRANSCENDENTAL,
            mutants: &[("select(negative, positive,", "select(positive, negative,")],
        },
        Formula {
            name: "henyey_greenstein",
            file: "lib/six_way.wgsl",
            wgsl: "y(0, henyey_greenstein(x(0), x(1)));",
            reference: |x| vec![six_way::henyey_greenstein(x[0], x[1])],
            cases: random(50, &[(-1.0, 1.0), (0.0, 0.9)]),
            tolerance: TRANSCENDENTAL,
            mutants: &[("- 2.0 * anisotropy", "+ 2.0 * anisotropy"), ("inverseSqrt(base) / base", "1.0 / base")],
        },
        Formula {
            name: "six_way_axis_weights",
            file: "lib/six_way.wgsl",
            wgsl: "let v = six_way_axis_weights(vec3f(x(0), x(1), x(2)), x(3)); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| six_way::six_way_axis_weights(v3(x), x[3]).to_array().to_vec(),
            cases: {
                let mut cases = unit_vectors(random(100, &SIX_WAY_AND_LIGHT[6..]), 0);
                cases.extend([0.2, 0.9].map(|anisotropy| vec![0.0, 0.0, -1.0, anisotropy]));
                cases
            },
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("to_light.xy * to_light.xy", "abs(to_light.xy)"),
                ("henyey_greenstein(-to_light.z, g)", "henyey_greenstein(to_light.z, g)"),
                ("1.0 - along", "1.0"),
                ("to_light.z < 0.0", "to_light.z > 0.0"),
            ],
        },
    ]
}

fn rotations() -> Vec<Formula> {
    vec![
        Formula {
            name: "rotate_six_way",
            file: "lib/six_way.wgsl",
            wgsl: "let v = rotate_six_way(vec3f(x(0), x(1), x(2)), vec3f(x(3), x(4), x(5)), vec2f(cos(x(6)), sin(x(6)))); \
                   y(0, v.positive.x); y(1, v.positive.y); y(2, v.positive.z); \
                   y(3, v.negative.x); y(4, v.negative.y); y(5, v.negative.z);",
            reference: |x| {
                let six_way::SixWay { positive, negative } =
                    six_way::rotate_six_way(v3(x), v3(&x[3..]), Vec2::from_angle(x[6]));
                [positive.to_array(), negative.to_array()].concat()
            },
            cases: random(100, &[(0.0, 1.0), (0.0, 1.0), (0.0, 1.0), (0.0, 1.0), (0.0, 1.0), (0.0, 1.0), (-4.0, 4.0)]),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("vec2f(down.x, up.y)", "vec2f(up.x, down.y)"),
                ("select(negative.xy, positive.xy, turned.x)", "positive.xy"),
                ("select(positive.yx, negative.yx, turned.y)", "negative.yx"),
                ("squares.y, positive.z)", "squares.y, negative.z)"),
            ],
        },
        Formula {
            name: "tilted_six_way",
            file: "lib/six_way.wgsl",
            wgsl: "let v = tilted_six_way(SixWay(vec3f(x(0), x(1), x(2)), vec3f(x(3), x(4), x(5))), vec2f(x(6), x(7))); \
                   y3(0, v.positive); y3(3, v.negative);",
            reference: |x| {
                let light = six_way::SixWay { positive: v3(x), negative: v3(&x[3..]) };
                let tilted = six_way::tilted_six_way(light, v2(&x[6..]));
                [tilted.positive.to_array(), tilted.negative.to_array()].concat()
            },
            cases: random(
                60,
                &[(0.0, 1.0), (0.0, 1.0), (0.0, 1.0), (0.0, 1.0), (0.0, 1.0), (0.0, 1.0), (-2.0, 2.0), (-2.0, 2.0)],
            ),
            tolerance: ARITHMETIC,
            mutants: &[
                ("1.0 + vec3f(tilt, 0.0)", "1.0 - vec3f(tilt, 0.0)"),
                ("max(1.0 - vec3f(tilt, 0.0), vec3f(0.0))", "(1.0 - vec3f(tilt, 0.0))"),
            ],
        },
        Formula {
            name: "normal_from_six_way",
            file: "lib/six_way.wgsl",
            wgsl: "let v = normal_from_six_way(vec3f(x(0), x(1), x(2)), vec3f(x(3), x(4), x(5))); \
                   y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| six_way::normal_from_six_way(v3(x), v3(&x[3..])).to_array().to_vec(),
            cases: {
                let mut cases = random(50, &[(0.0, 1.0); 6]);
                // Equal brightness from all sides gives no direction.
                cases.push(vec![0.5; 6]);
                cases
            },
            tolerance: TRANSCENDENTAL,
            mutants: &[("positive - negative", "negative - positive"), ("vec3f(0.0, 0.0, 1.0)", "vec3f(0.0)")],
        },
    ]
}
