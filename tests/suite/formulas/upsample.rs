//! Formula tests of `shaders/lib/upsample.wgsl`.

use glam::Vec4;
use haze::formula::upsample;
use haze::settings::Upsample;

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
     y(0, f.total); y(1, f.nearest); y(2, f.farthest); for (var i = 0u; i < 3u; i++) { y(3u + i, f.place[i]); \
     y(6u + i, f.squares[i]); y(9u + i, f.products[i]); } y(12, f.value.x); y(13, f.x_value.x); y(14, f.y_value.x); \
     y(15, f.z_value.x); y(16, f.low.x); y(17, f.high.x);";

const WGSL_FITTED: &str = "var f: GuidedFit; f.nearest = 1.0e6; f.farthest = -1.0e6; for (var i = 0u; i < 4u; i++) { \
     let o = 5u * i; f = add_texel(f, vec3f(x(o), x(o + 1u), x(o + 2u)), f32(i + 1u), vec4f(x(o + 3u))); } \
     y(0, fitted_value(f, 0.5).x);";

pub fn formulas() -> Vec<Formula> {
    [weights(), guided_fits()].into_iter().flatten().collect()
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
            name: "bilinear_suffices",
            file: "lib/upsample.wgsl",
            wgsl: "y(0, f32(bilinear_suffices(vec4f(x(0), x(1), x(2), x(3)), x(4), x(5))));",
            reference: |x| vec![f32::from(upsample::bilinear_suffices(v4(x), x[4], x[5]))],
            cases: random(200, &[(4.0, 5.0), (4.0, 5.0), (4.0, 5.0), (4.0, 5.0), (4.0, 5.0), (0.0, 4.0)]),
            tolerance: 0.0,
            mutants: &[
                ("SMOKE_DEPTH_TOLERANCE * fade", "fade"),
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
                ("abs(place.xy) * 0.5", "abs(place.xy)"),
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
                let vectors = [fit.place, fit.squares, fit.products].map(|v| v.to_array());
                let values = [fit.value, fit.x_value, fit.y_value, fit.z_value, fit.low, fit.high].map(|v| v.x);
                [[fit.total, fit.nearest, fit.farthest].as_slice(), vectors.as_flattened(), &values].concat()
            },
            cases: random(100, &[(-2.0, 2.0); 20]),
            tolerance: ARITHMETIC * 10.0,
            mutants: &[
                ("w.xxy * place.yzz", "w.xyy * place.yzz"),
                ("w * place,", "w,"),
                ("fit.y_value + value * w.y", "fit.y_value + value * w.x"),
                ("value, fit.total == 0.0),\n        min", "value, false),\n        min"),
                ("min(fit.nearest, place.z)", "place.z"),
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
