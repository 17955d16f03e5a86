//! Formula tests of `shaders/lib/upsample.wgsl`.

use glam::{Mat4, Vec4};
use haze_core::formula::upsample;
use haze_core::settings::Upsample;

use super::Formula;
use super::inputs::{ARITHMETIC, TRANSCENDENTAL, count, random, v2, v3, v4, with_choices};

/// Fits four texels, each a position and a value, with weights 1 to 4.
fn fit(x: &[f32]) -> upsample::GuidedFit {
    x[..20].chunks(5).zip([1.0, 2.0, 3.0, 4.0]).fold(upsample::GuidedFit::default(), |fit, (x, weight)| {
        upsample::add_texel(&fit, v3(x), weight, Vec4::splat(x[3]))
    })
}

const WGSL_FIT: &str = "var f: GuidedFit; f.nearest = 1.0e6; f.farthest = -1.0e6; for (var i = 0u; i < 4u; i++) { let o = 5u * i; \
     f = add_texel(f, vec3f(x(o), x(o + 1u), x(o + 2u)), f32(i + 1u), vec4f(x(o + 3u))); } \
     y(0, f.total); y(1, f.nearest); y(2, f.farthest); for (var i = 0u; i < 3u; i++) { y(3u + i, f.position[i]); \
     y(6u + i, f.squares[i]); y(9u + i, f.products[i]); } y(12, f.value.x); y(13, f.x_value.x); y(14, f.y_value.x); \
     y(15, f.z_value.x); y(16, f.low.x); y(17, f.high.x);";

const WGSL_FITTED: &str = "var f: GuidedFit; f.nearest = 1.0e6; f.farthest = -1.0e6; for (var i = 0u; i < 4u; i++) { \
     let o = 5u * i; f = add_texel(f, vec3f(x(o), x(o + 1u), x(o + 2u)), f32(i + 1u), vec4f(x(o + 3u))); } \
     y(0, fitted_value(f, 0.5).x);";

macro_rules! wgsl_line {
    () => {
        "var l: DepthLine; for (var i = 0u; i < 4u; i++) { let o = 3u * i; \
         l = add_to_line(l, x(o), x(o + 1u), vec4f(x(o + 2u))); } "
    };
}

pub fn formulas() -> Vec<Formula> {
    [weights(), guided_fits(), carried()].into_iter().flatten().collect()
}

fn weights() -> Vec<Formula> {
    vec![
        Formula {
            name: "upsample_weights",
            file: "lib/upsample.wgsl",
            wgsl: "let w = upsample_weights(u32(x(0)), vec2f(x(1), x(2)), vec4f(x(3), x(4), x(5), x(6)), x(7)); \
                   y(0, w.x); y(1, w.y); y(2, w.z); y(3, w.w);",
            reference: |x| {
                let mode = Upsample::ALL[x[0] as usize];
                upsample::upsample_weights(mode, v2(&x[1..]), v4(&x[3..]), x[7]).to_array().to_vec()
            },
            cases: {
                let mut cases = with_choices(
                    count(Upsample::ALL),
                    &[(0.0, 1.0), (0.0, 1.0), (4.0, 6.0), (4.0, 6.0), (4.0, 6.0), (4.0, 6.0), (4.0, 6.0)],
                );
                // Smooth surfaces, and pixels whose surface is in none of the texels.
                cases.extend(with_choices(
                    count(Upsample::ALL),
                    &[(0.0, 1.0), (0.0, 1.0), (4.9, 5.1), (4.9, 5.1), (4.9, 5.1), (4.9, 5.1), (4.9, 5.1)],
                ));
                cases.extend(with_choices(
                    count(Upsample::ALL),
                    &[(0.0, 1.0), (0.0, 1.0), (4.0, 5.0), (4.0, 5.0), (4.0, 5.0), (4.0, 5.0), (30.0, 60.0)],
                ));
                cases
            },
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("vec4f(SURFACE_DEPTH_TOLERANCE * depth)", "vec4f(SURFACE_DEPTH_TOLERANCE)"),
                ("fraction.x * g.y, g.x * fraction.y", "g.x * fraction.y, fraction.x * g.y"),
                ("if difference.y == closest", "if difference.z == closest"),
                ("-0.5 * sigmas * sigmas", "-sigmas * sigmas"),
            ],
        },
        Formula {
            name: "is_shallow",
            file: "lib/upsample.wgsl",
            wgsl: "y(0, f32(is_shallow(x(0), x(1), x(2))));",
            reference: |x| vec![f32::from(upsample::is_shallow(x[0], x[1], x[2]))],
            cases: random(100, &[(4.0, 5.0), (4.5, 5.5), (0.0, 4.0)]),
            tolerance: 0.0,
            mutants: &[("SMOKE_DEPTH_TOLERANCE * fade", "fade"), ("farthest - nearest <", "farthest <")],
        },
        Formula {
            name: "bilinear_suffices",
            file: "lib/upsample.wgsl",
            wgsl: "y(0, f32(bilinear_suffices(vec4f(x(0), x(1), x(2), x(3)), x(4), x(5))));",
            reference: |x| vec![f32::from(upsample::bilinear_suffices(v4(x), x[4], x[5]))],
            cases: random(200, &[(4.0, 5.0), (4.0, 5.0), (4.0, 5.0), (4.0, 5.0), (4.0, 5.0), (0.0, 4.0)]),
            tolerance: 0.0,
            mutants: &[
                ("is_shallow(low, high, fade)", "is_shallow(low, high, 1.0)"),
                ("min(depths.z, depths.w)), depth)", "min(depths.z, depths.w)), 9.0)"),
                ("max(depths.x, depths.y)", "depths.y"),
            ],
        },
        Formula {
            name: "guided_weight",
            file: "lib/upsample.wgsl",
            wgsl: "y(0, guided_weight(vec3f(x(0), x(1), x(2)), x(3)));",
            reference: |x| vec![upsample::guided_weight(v3(x), x[3])],
            cases: random(100, &[(-2.2, 2.2), (-2.2, 2.2), (-0.5, 0.5), (3.0, 6.0)]),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("abs(position.xy) * 0.5", "abs(position.xy)"),
                ("(2.0 / (SURFACE_DEPTH_TOLERANCE", "(1.0 / (SURFACE_DEPTH_TOLERANCE"),
            ],
        },
    ]
}

fn guided_fits() -> Vec<Formula> {
    vec![
        Formula {
            name: "add_texel",
            file: "lib/upsample.wgsl",
            wgsl: WGSL_FIT,
            reference: |x| {
                let fit = fit(x);
                let vectors = [fit.position, fit.squares, fit.products].map(|v| v.to_array());
                let values = [fit.value, fit.x_value, fit.y_value, fit.z_value, fit.low, fit.high].map(|v| v.x);
                [[fit.total, fit.nearest, fit.farthest].as_slice(), vectors.as_flattened(), &values].concat()
            },
            cases: random(100, &[(-2.0, 2.0); 20]),
            tolerance: ARITHMETIC * 10.0,
            mutants: &[
                ("w.xxy * position.yzz", "w.xyy * position.yzz"),
                ("w * position,", "w,"),
                ("fit.y_value + value * w.y", "fit.y_value + value * w.x"),
                ("value, fit.total == 0.0),\n        min", "value, false),\n        min"),
                ("min(fit.nearest, position.z)", "position.z"),
            ],
        },
        Formula {
            name: "fitted_value",
            file: "lib/upsample.wgsl",
            wgsl: WGSL_FITTED,
            reference: |x| vec![upsample::fitted_value(&fit(x), 0.5).x],
            cases: random(200, &[(-1.5, 1.5); 20]),
            // The fit inverts a matrix whose sums are added in another order.
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("held * held", "held"),
                ("vec3f(0.02, 0.02,", "vec3f(0.0, 0.0,"),
                ("clamp(0.0, fit.nearest, fit.farthest)", "0.0"),
                ("clamp(fitted, fit.low, fit.high)", "fitted"),
                ("mean.xxy * mean.yzz", "mean.xxy"),
            ],
        },
    ]
}

/// A line through four texels, each a depth, a weight and a value.
fn line(x: &[f32]) -> upsample::DepthLine {
    x[..12]
        .chunks(3)
        .fold(upsample::DepthLine::default(), |line, x| upsample::add_to_line(&line, x[0], x[1], Vec4::splat(x[2])))
}

fn carried() -> Vec<Formula> {
    let texels = [[(-1.0, 1.0), (0.1, 1.0), (0.0, 1.0)]; 4].concat();
    vec![
        Formula {
            name: "add_to_line",
            file: "lib/upsample.wgsl",
            wgsl: concat!(
                wgsl_line!(),
                "y(0, l.total); y(1, l.z); y(2, l.z_square); y(3, l.value.x); y(4, l.z_value.x);"
            ),
            reference: |x| {
                let line = line(x);
                vec![line.total, line.z, line.z_square, line.value.x, line.z_value.x]
            },
            cases: random(100, &texels),
            tolerance: ARITHMETIC * 10.0,
            mutants: &[
                ("w * z,", "w,"),
                ("line.z_value + value * w", "line.z_value + value"),
                ("let w = z * weight", "let w = z"),
            ],
        },
        Formula {
            name: "depth_slope",
            file: "lib/upsample.wgsl",
            wgsl: concat!(wgsl_line!(), "y(0, depth_slope(l, x(12)).x);"),
            reference: |x| vec![upsample::depth_slope(&line(x), x[12]).x],
            cases: random(200, &[texels.as_slice(), &[(0.5, 40.0)]].concat()),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("* held / (line", "/ (line"),
                ("- z * z + held * held", "+ held * held"),
                ("line.total - value * z)", "line.total)"),
                ("let held = SLOPE_LENGTH * fade;\n    return", "let held = SLOPE_LENGTH;\n    return"),
            ],
        },
        Formula {
            name: "surface_weights",
            file: "lib/upsample.wgsl",
            wgsl: "let w = surface_weights(vec2f(x(0), x(1)), vec4f(x(2), x(3), x(4), x(5)), x(6)); \
                   y(0, w.x); y(1, w.y); y(2, w.z); y(3, w.w);",
            reference: |x| upsample::surface_weights(v2(x), v4(&x[2..]), x[6]).to_array().to_vec(),
            cases: random(200, &[(0.0, 1.0), (0.0, 1.0), (4.0, 5.0), (4.0, 5.0), (4.0, 5.0), (4.0, 5.0), (4.0, 5.0)]),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("(depths - depth) * (2.0", "(depths - depth) * (1.0"),
                ("upsample_weights(UPSAMPLE_BILINEAR, fraction", "upsample_weights(UPSAMPLE_BILINEAR, fraction.yx"),
                ("sigmas * sigmas) + 1.0e-4);\n}\n\n// Fraction", "sigmas * sigmas) + 1.0e-2);\n}\n\n// Fraction"),
            ],
        },
        Formula {
            name: "carried_value",
            file: "lib/upsample.wgsl",
            wgsl: "var v: mat4x4f; var s: mat4x4f; for (var i = 0u; i < 4u; i++) { let a = x(i); v[i] = vec4f(a, 0.5 * a, 1.0 - a, 1.0); \
                   let b = x(4u + i); s[i] = vec4f(b, b, 0.5 * b, 0.0); } \
                   let c = carried_value(vec4f(x(8), x(9), x(10), x(11)), v, s, vec4f(x(12), x(13), x(14), x(15)), x(16), x(17)); \
                   y(0, c.x); y(1, c.y); y(2, c.z); y(3, c.w);",
            reference: |x| {
                let columns = |x: &[f32], column: fn(f32) -> [f32; 4]| {
                    Mat4::from_cols_array_2d(&[column(x[0]), column(x[1]), column(x[2]), column(x[3])])
                };
                let values = columns(x, |a| [a, 0.5 * a, 1.0 - a, 1.0]);
                let slopes = columns(&x[4..], |b| [b, b, 0.5 * b, 0.0]);
                upsample::carried_value(v4(&x[8..]), values, slopes, v4(&x[12..]), x[16], x[17]).to_array().into()
            },
            cases: {
                let fraction = [(0.01, 0.25); 4];
                let depths = [(4.0, 5.0); 4];
                random(
                    200,
                    &[&[(0.0, 1.0); 4], &[(-0.05, 0.05); 4], &fraction, &depths, &[(3.5, 5.5), (0.5, 2.0)][..]]
                        .concat(),
                )
            },
            tolerance: ARITHMETIC * 100.0,
            mutants: &[
                ("clamp(depth, nearest, farthest) - depths", "depth - depths"),
                ("let total = dot(weights, vec4f(1.0))", "let total = 1.0"),
                ("change * min(min(steps.x, steps.y), min(steps.z, steps.w))", "change"),
                ("change * min(min(steps.x, steps.y), min(steps.z, steps.w))", "change * steps"),
                ("select(low, high, change > vec4f(0.0))", "low"),
                ("+ mean * SMALL_CHANGE", ""),
                ("slopes * (weights * way)", "slopes * way"),
                ("/ (SLOPE_LENGTH * fade);\n    let total", "/ SLOPE_LENGTH;\n    let total"),
            ],
        },
        Formula {
            name: "four_texels_weight",
            file: "lib/upsample.wgsl",
            wgsl: "y(0, four_texels_weight(x(0)));",
            reference: |x| vec![upsample::four_texels_weight(x[0])],
            cases: random(100, &[(0.0, 0.3)]),
            tolerance: ARITHMETIC * 10.0,
            mutants: &[("smoothstep(0.02, 0.2, seen)", "smoothstep(0.0, 0.2, seen)")],
        },
    ]
}
