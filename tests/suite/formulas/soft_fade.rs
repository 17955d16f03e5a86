//! Formula tests of `shaders/lib/soft_fade.wgsl`.

use haze_core::formula::soft_fade;
use haze_core::settings::FadeCurve;

use super::Formula;
use super::inputs::{ARITHMETIC, TRANSCENDENTAL, count, random, with_choices};

pub fn formulas() -> Vec<Formula> {
    [curves(), fades()].into_iter().flatten().collect()
}

fn curves() -> Vec<Formula> {
    vec![
        Formula {
            name: "fade_linear",
            file: "lib/soft_fade.wgsl",
            wgsl: "y(0, fade_linear(x(0)));",
            reference: |x| vec![soft_fade::fade_linear(x[0])],
            cases: random(50, &[(0.0, 1.0)]),
            tolerance: 0.0,
            mutants: &[("    return x;\n", "    return 1.0 - x;\n")],
        },
        Formula {
            name: "fade_smoothstep",
            file: "lib/soft_fade.wgsl",
            wgsl: "y(0, fade_smoothstep(x(0)));",
            reference: |x| vec![soft_fade::fade_smoothstep(x[0])],
            cases: random(50, &[(0.0, 1.0)]),
            tolerance: ARITHMETIC,
            mutants: &[("3.0 - 2.0 * x", "2.0 - x")],
        },
        Formula {
            name: "fade_contrast",
            file: "lib/soft_fade.wgsl",
            wgsl: "y(0, fade_contrast(x(0), x(1)));",
            reference: |x| vec![soft_fade::fade_contrast(x[0], x[1])],
            cases: random(200, &[(0.0, 1.0), (0.1, 16.0)]),
            tolerance: TRANSCENDENTAL,
            // The second mutant does not reflect the upper half of the curve, as happens without NV's saturate.
            mutants: &[("0.5 * pow(2.0 * x, contrast_power)", "pow(2.0 * x, contrast_power)"), ("(1.0 - x)", "(x)")],
        },
        Formula {
            name: "fade_exponential",
            file: "lib/soft_fade.wgsl",
            wgsl: "y(0, fade_exponential(x(0), x(1)));",
            reference: |x| vec![soft_fade::fade_exponential(x[0], x[1])],
            cases: random(200, &[(0.0, 1.0), (0.1, 16.0)]),
            tolerance: TRANSCENDENTAL,
            // The first mutant is the formula as it reads when the exponent is lost in print.
            mutants: &[
                ("exp2(-2.0 * pow(2.0 * x, contrast_power))", "pow(0.25 * 2.0 * x, contrast_power)"),
                ("2.0 * x", "x"),
            ],
        },
        Formula {
            name: "fade_always",
            file: "lib/soft_fade.wgsl",
            wgsl: "y(0, fade_always(x(0), x(1)));",
            reference: |x| vec![soft_fade::fade_always(x[0], x[1])],
            cases: random(100, &[(-2.0, 2.0), (0.2, 4.0)]),
            tolerance: ARITHMETIC,
            mutants: &[("saturate(-distance", "saturate(distance"), ("1.0 - saturate", "saturate")],
        },
    ]
}

fn fades() -> Vec<Formula> {
    vec![
        Formula {
            name: "soft_fade",
            file: "lib/soft_fade.wgsl",
            wgsl: "y(0, soft_fade(u32(x(0)), x(1), x(2), x(3), x(4)));",
            reference: |x| vec![soft_fade::soft_fade(FadeCurve::ALL[x[0] as usize], x[1], x[2], x[3], x[4])],
            cases: with_choices(count(FadeCurve::ALL), &[(-0.5, 2.0), (0.2, 4.0), (0.5, 4.0), (0.0, 0.2)]),
            tolerance: TRANSCENDENTAL,
            // The first mutant uses an unsigned distance, which lets sprites fade in again behind the surface.
            mutants: &[
                (
                    "if curve != FADE_CURVE_ALWAYS && distance < max(epsilon, 0.0) {\n        return 0.0;\n    }\n    \
                     let x = saturate(distance *",
                    "let x = saturate(abs(distance) *",
                ),
                ("curve != FADE_CURVE_ALWAYS && distance < max(epsilon, 0.0)", "distance < max(epsilon, 0.0)"),
                ("distance < max(epsilon, 0.0)", "distance < 0.0"),
                ("saturate(distance * fade_scale)", "saturate(distance / fade_scale)"),
                (
                    "case FADE_CURVE_CONTRAST: { return fade_contrast",
                    "case FADE_CURVE_CONTRAST: { return fade_exponential",
                ),
            ],
        },
        Formula {
            name: "near_fade",
            file: "lib/soft_fade.wgsl",
            wgsl: "y(0, near_fade(x(0), x(1), x(1) + x(2)));",
            reference: |x| vec![soft_fade::near_fade(x[0], x[1], x[1] + x[2])],
            cases: random(100, &[(0.0, 3.0), (0.0, 1.0), (0.0, 1.0)]),
            tolerance: ARITHMETIC * 10.0,
            mutants: &[("view_depth - start", "end - view_depth")],
        },
    ]
}
