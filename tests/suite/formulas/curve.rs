//! Formula tests of `shaders/lib/curve.wgsl`.

use glam::{vec2, vec4};
use haze_core::formula::curve::{self, CurvePoints};

use super::Formula;
use super::inputs::{ARITHMETIC, random};

/// Curve through three points, whose numbers are inputs 1 to 6; the ages increase.
macro_rules! wgsl_curve {
    ($call:literal) => {
        concat!(
            "let b = x(2) + 0.01 + x(4); let last = vec2f(b + 0.01 + x(6), x(7)); var c: Curve; \
             c.points[0] = vec4f(x(2), x(3), b, x(5)); for (var i = 1; i < 4; i++) { c.points[i] = vec4f(last, last); } ",
            $call
        )
    };
}

fn test_curve(x: &[f32]) -> CurvePoints {
    let b = x[2] + 0.01 + x[4];
    let last = vec2(b + 0.01 + x[6], x[7]);
    let pair = (last, last).into();
    [vec4(x[2], x[3], b, x[5]), pair, pair, pair]
}

pub fn formulas() -> Vec<Formula> {
    let cases = || {
        random(100, &[(0.0, 7.99), (-0.1, 1.2), (0.0, 0.3), (0.0, 3.0), (0.0, 0.3), (0.0, 3.0), (0.0, 0.3), (0.0, 3.0)])
    };
    vec![
        Formula {
            name: "curve_point",
            file: "lib/curve.wgsl",
            wgsl: wgsl_curve!("y2(0, curve_point(c, u32(x(0))));"),
            reference: |x| curve::curve_point(&test_curve(x), x[0] as usize).to_array().to_vec(),
            cases: cases(),
            tolerance: 0.0,
            mutants: &[("select(pair.xy, pair.zw,", "select(pair.zw, pair.xy,"), ("index / 2u", "index / 4u")],
        },
        Formula {
            name: "curve_value",
            file: "lib/curve.wgsl",
            wgsl: wgsl_curve!("y(0, curve_value(c, x(1)));"),
            reference: |x| vec![curve::curve_value(&test_curve(x), x[1])],
            cases: cases(),
            // Divided by ages as close as 0.01.
            tolerance: ARITHMETIC * 100.0,
            mutants: &[
                ("(next.y - last.y) * saturate", "next.y * saturate"),
                ("saturate((age - last.x)", "(2.0 * (age - last.x)"),
            ],
        },
        Formula {
            name: "curve_integral",
            file: "lib/curve.wgsl",
            wgsl: wgsl_curve!("y(0, curve_integral(c, x(1)));"),
            reference: |x| vec![curve::curve_integral(&test_curve(x), x[1])],
            cases: cases(),
            tolerance: ARITHMETIC * 10.0,
            mutants: &[
                ("min(age, last.x) * last.y", "0.0"),
                ("0.5 * (next.y - last.y)", "(next.y - last.y)"),
                ("max(age - last.x, 0.0) * last.y", "0.0"),
            ],
        },
        Formula {
            name: "smoothstep_unit",
            file: "lib/curve.wgsl",
            wgsl: "y(0, smoothstep_unit(x(0)));",
            reference: |x| vec![curve::smoothstep_unit(x[0])],
            cases: random(50, &[(-1.0, 2.0)]),
            tolerance: ARITHMETIC,
            mutants: &[("3.0 - 2.0 * s", "2.0 - s"), ("let s = saturate(x)", "let s = x")],
        },
    ]
}
