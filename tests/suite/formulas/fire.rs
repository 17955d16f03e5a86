//! Formula tests of `shaders/lib/fire.wgsl` and `shaders/lib/emission.wgsl`.

use haze_core::formula::fire::{fire_from_moments, heat_at};

use super::Formula;
use super::fixture::{DEFAULTS, visible_system};
use super::inputs::{ARITHMETIC, TRANSCENDENTAL, random, v2};

const FRACTION: (f32, f32) = (0.0, 1.0);

pub fn formulas() -> Vec<Formula> {
    vec![
        Formula {
            name: "heat_at",
            file: "lib/fire.wgsl",
            wgsl: "y(0, heat_at(x(0), x(1), x(2), x(3), x(4)));",
            reference: |x| vec![heat_at(x[0], x[1], x[2], x[3], x[4])],
            cases: random(60, &[FRACTION, FRACTION, (-1.0, 1.0), FRACTION, FRACTION]),
            tolerance: ARITHMETIC,
            mutants: &[
                ("core * (1.0 - thickness)", "core * thickness"),
                ("let front = saturate(facing)", "let front = facing"),
                ("crust * front * front", "crust"),
            ],
        },
        Formula {
            name: "fire_from_moments",
            file: "lib/fire.wgsl",
            wgsl: "let f = fire_from_moments(vec2f(x(0) - 0.1, (x(0) - 0.1) * x(1))); y(0, f.x); y(1, f.y);",
            reference: |x| {
                let heat = x[0] - 0.1;
                fire_from_moments(glam::Vec2::new(heat, heat * x[1])).to_array().to_vec()
            },
            cases: random(100, &[(0.0, 1.1), (0.0, 1.2)]),
            tolerance: ARITHMETIC * 10.0,
            mutants: &[
                ("moments.y / moments.x,", "moments.x,"),
                ("moments.x * moments.x / moments.y", "moments.x"),
                ("if !burns", "if false"),
            ],
        },
        Formula {
            name: "emission",
            file: "lib/emission.wgsl",
            wgsl: "system.fire_intensity = 3.0; y3(0, emission(vec2f(x(0), x(1)), x(2)));",
            reference: |x| {
                let mut visible = visible_system(&DEFAULTS);
                visible.system.fire_intensity = 3.0;
                visible.emission(v2(x), x[2]).to_array().to_vec()
            },
            cases: random(100, &[FRACTION, FRACTION, FRACTION]),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("amount, system.boost) * system.fire_intensity", "amount, system.boost)"),
                ("amount, system.boost)", "amount, 1.0)"),
            ],
        },
    ]
}
