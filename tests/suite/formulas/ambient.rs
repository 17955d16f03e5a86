//! Formula tests of `shaders/lib/ambient.wgsl`.

use haze_core::formula::ambient::{hemisphere_coordinate, openness_position, six_way_hemisphere};

use super::Formula;
use super::inputs::{ARITHMETIC, random, unit_vectors, v3};

const SIDE: (f32, f32) = (-1.0, 1.0);
const FRACTION: (f32, f32) = (0.0, 1.0);

pub fn formulas() -> Vec<Formula> {
    vec![
        Formula {
            name: "hemisphere_coordinate",
            file: "lib/ambient.wgsl",
            wgsl: "y(0, hemisphere_coordinate(vec3f(x(0), x(1), x(2)), vec3f(x(3), x(4), x(5))));",
            reference: |x| vec![hemisphere_coordinate(v3(x), v3(&x[3..]))],
            cases: unit_vectors(unit_vectors(random(60, &[SIDE, SIDE, SIDE, SIDE, SIDE, SIDE]), 0), 3),
            tolerance: ARITHMETIC,
            mutants: &[("0.75 + 0.25 * dot", "0.5 + 0.5 * dot"), ("0.25 * dot", "-0.25 * dot")],
        },
        Formula {
            name: "six_way_hemisphere",
            file: "lib/ambient.wgsl",
            wgsl: "y(0, six_way_hemisphere(vec3f(x(0), x(1), x(2)), vec3f(x(3), x(4), x(5)), vec3f(x(6), x(7), x(8))));",
            reference: |x| vec![six_way_hemisphere(v3(x), v3(&x[3..]), v3(&x[6..]))],
            cases: unit_vectors(
                random(60, &[FRACTION, FRACTION, FRACTION, FRACTION, FRACTION, FRACTION, SIDE, SIDE, SIDE]),
                6,
            ),
            tolerance: ARITHMETIC * 10.0,
            mutants: &[("positive - negative", "negative - positive"), ("0.5 * (dot", "(dot")],
        },
        Formula {
            name: "openness_position",
            file: "lib/ambient.wgsl",
            wgsl: "let p = openness_position(x(0)); y(0, p.x); y(1, p.y);",
            reference: |x| openness_position(x[0]).to_array().to_vec(),
            cases: random(30, &[(-0.2, 1.2)]),
            tolerance: ARITHMETIC,
            mutants: &[("1.0 - openness", "openness")],
        },
    ]
}
