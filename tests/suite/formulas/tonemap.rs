//! Formula tests of `shaders/lib/tonemap.wgsl`.

use glam::UVec2;
use haze_core::formula::tonemap;
use haze_core::settings::Tonemap;

use super::Formula;
use super::inputs::{ARITHMETIC, TRANSCENDENTAL, count, random, v3, with_choices};

pub fn formulas() -> Vec<Formula> {
    vec![
        Formula {
            name: "aces_fitted",
            file: "lib/tonemap.wgsl",
            wgsl: "let v = aces_fitted(vec3f(x(0), x(1), x(2))); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| tonemap::aces_fitted(v3(x)).to_array().to_vec(),
            cases: [random(60, &[(-0.1, 1.0); 3]), random(30, &[(0.0, 50.0); 3])].concat(),
            tolerance: 10.0 * ARITHMETIC,
            mutants: &[("0.35458", "0.45458"), ("output * fitted", "fitted * output"), ("0.432951", "0.532951")],
        },
        Formula {
            name: "aces_keeping_hue",
            file: "lib/tonemap.wgsl",
            wgsl: "y3(0, aces_keeping_hue(vec3f(x(0), x(1), x(2))));",
            reference: |x| tonemap::aces_keeping_hue(v3(x)).to_array().to_vec(),
            cases: [random(60, &[(-0.1, 1.0); 3]), random(30, &[(0.0, 50.0); 3])].concat(),
            tolerance: 100.0 * ARITHMETIC,
            mutants: &[("bright - dark", "bright"), ("(light - least) *", "light *"), ("- least;\n", ";\n")],
        },
        Formula {
            name: "agx",
            file: "lib/tonemap.wgsl",
            wgsl: "y3(0, agx(vec3f(x(0), x(1), x(2))));",
            reference: |x| tonemap::agx(v3(x)).to_array().to_vec(),
            cases: [random(60, &[(-0.1, 1.0); 3]), random(30, &[(0.0, 50.0); 3])].concat(),
            tolerance: 4.0 * TRANSCENDENTAL,
            mutants: &[
                ("0.0784336, 0.878469", "0.0884336, 0.868469"),
                ("outset * code", "inset * code"),
                ("40.14 * x4 * x", "40.14 * x4"),
                ("vec3f(2.2)", "vec3f(2.4)"),
                ("+ 12.47393", "+ 11.47393"),
            ],
        },
        Formula {
            name: "pbr_neutral",
            file: "lib/tonemap.wgsl",
            wgsl: "y3(0, pbr_neutral(vec3f(x(0), x(1), x(2))));",
            reference: |x| tonemap::pbr_neutral(v3(x)).to_array().to_vec(),
            cases: [random(60, &[(-0.1, 1.0); 3]), random(30, &[(0.0, 50.0); 3])].concat(),
            tolerance: 100.0 * ARITHMETIC,
            mutants: &[
                ("6.25 * least * least", "6.25 * least"),
                ("least < 0.08", "least < 0.02"),
                ("peak < start", "peak < 1.0"),
                ("+ room - start", "- start"),
                ("0.15 *", "0.25 *"),
            ],
        },
        Formula {
            name: "tonemapped",
            file: "lib/tonemap.wgsl",
            wgsl: "y3(0, tonemapped(vec3f(x(1), x(2), x(3)), u32(x(0)), x(4)));",
            reference: |x| tonemap::tonemapped(v3(&x[1..]), Tonemap::ALL[x[0] as usize], x[4]).to_array().to_vec(),
            cases: with_choices(count(Tonemap::ALL), &[(0.0, 2.0), (0.0, 2.0), (0.0, 2.0), (0.1, 4.0)]),
            tolerance: 4.0 * TRANSCENDENTAL,
            mutants: &[
                ("color * exposure", "color"),
                ("srgb_color(shown)", "shown"),
                ("= agx(exposed)", "= aces_fitted(exposed)"),
                ("= pbr_neutral(exposed)", "= aces_fitted(exposed)"),
                ("= aces_keeping_hue(exposed)", "= aces_fitted(exposed)"),
                ("= aces_fitted(exposed)", "= agx(exposed)"),
            ],
        },
        Formula {
            name: "dither",
            file: "lib/tonemap.wgsl",
            wgsl: "y(0, dither(vec2u(u32(x(0)), u32(x(1)))) * 255.0);",
            reference: |x| vec![tonemap::dither(UVec2::new(x[0] as u32, x[1] as u32)) * 255.0],
            cases: random(50, &[(0.0, 4000.0); 2]),
            tolerance: ARITHMETIC,
            mutants: &[("unit(hash.y)", "unit(hash.z)"), ("vec3u(at, 0u)", "vec3u(at.yx, 0u)")],
        },
    ]
}
