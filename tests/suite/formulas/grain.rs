//! Formula tests of `shaders/lib/grain.wgsl`.

use haze_core::formula::grain;

use super::Formula;
use super::inputs::{ARITHMETIC, random, test_noise, v2, v3};

const FRACTION: (f32, f32) = (0.0, 1.0);

pub fn formulas() -> Vec<Formula> {
    vec![
        Formula {
            name: "octave_fraction",
            file: "lib/grain.wgsl",
            wgsl: "y(0, octave_fraction(x(0)));",
            reference: |x| vec![grain::octave_fraction(x[0])],
            cases: random(60, &[(0.0, 4.0)]),
            tolerance: ARITHMETIC,
            mutants: &[("- 0.5)", ")"), ("1.5 / max(fineness, 1.0e-6)", "1.5 * fineness")],
        },
        Formula {
            name: "sample_grain",
            file: "lib/grain.wgsl",
            wgsl: "let uv = vec2f(x(0), x(1)); \
                   y3(0, sample_grain(test_noise, test_sampler, uv, x(2), x(3), x(4), u32(x(5))));",
            reference: |x| grain::sample_grain(test_noise(), v2(x), x[2], x[3], x[4], x[5] as u32).to_array().to_vec(),
            cases: random(200, &[FRACTION, FRACTION, FRACTION, (0.5, 4.0), (0.1, 1.5), (1.0, 3.99)]),
            // Rounding errors of coordinates are multiplied by 9 in the third octave.
            tolerance: 2e-4,
            mutants: &[
                ("GRAIN_RIGHT * uv.x + GRAIN_DOWN * uv.y", "GRAIN_RIGHT * uv.y + GRAIN_DOWN * uv.x"),
                ("* tiles + phase", "* tiles - phase"),
                ("-dot(gradient, GRAIN_DOWN)", "dot(gradient, GRAIN_DOWN)"),
                ("sum.w - MIDDLE_DENSITY * total", "sum.w - MIDDLE_DENSITY"),
                ("2.0 * sum.xyz", "sum.xyz"),
                ("fine *= 3.0", "fine *= 1.0"),
                ("position *= 3.0", "position *= 2.0"),
                ("weight *= 0.5", "weight *= 1.0"),
            ],
        },
        Formula {
            name: "sprite_erosion",
            file: "lib/grain.wgsl",
            wgsl: "y(0, sprite_erosion(x(0), x(1), x(2)));",
            reference: |x| vec![grain::sprite_erosion(x[0], x[1], x[2])],
            cases: random(60, &[FRACTION, FRACTION, (-0.2, 1.3)]),
            tolerance: ARITHMETIC,
            mutants: &[("dissolve * saturate(age)", "dissolve"), ("saturate(age)", "age")],
        },
        Formula {
            name: "eroded",
            file: "lib/grain.wgsl",
            wgsl: "y(0, eroded(x(0), x(1), x(2)));",
            reference: |x| vec![grain::eroded(x[0], x[1], x[2])],
            cases: random(100, &[FRACTION, (-1.0, 1.0), FRACTION]),
            // A difference is divided by as little as 0.01.
            tolerance: 1e-4,
            mutants: &[
                ("MIDDLE_DENSITY - density", "MIDDLE_DENSITY + density"),
                ("(amount - threshold) /", "amount /"),
                ("/ max(1.0 - threshold, 0.01)", ""),
            ],
        },
        Formula {
            name: "kept_fraction",
            file: "lib/grain.wgsl",
            wgsl: "y(0, kept_fraction(x(0), x(1)));",
            reference: |x| vec![grain::kept_fraction(x[0], x[1])],
            cases: random(60, &[FRACTION, FRACTION]),
            tolerance: ARITHMETIC,
            mutants: &[("(1.0 - eroded_fraction) * erosion", "eroded_fraction * erosion")],
        },
        Formula {
            name: "tilted_normal",
            file: "lib/grain.wgsl",
            wgsl: "y3(0, tilted_normal(vec3f(x(0), x(1), x(2)), vec2f(x(3), x(4))));",
            reference: |x| grain::tilted_normal(v3(x), v2(&x[3..])).to_array().to_vec(),
            cases: random(100, &[(-1.0, 1.0), (-1.0, 1.0), (0.1, 1.0), (-2.0, 2.0), (-2.0, 2.0)]),
            tolerance: ARITHMETIC * 10.0,
            mutants: &[
                ("vec3f(tilt, 0.0)", "vec3f(tilt.yx, 0.0)"),
                ("inverseSqrt(max(dot(turned, turned), 1.0))", "inverseSqrt(dot(turned, turned))"),
            ],
        },
    ]
}
