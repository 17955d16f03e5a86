//! Formula tests of `shaders/lib/tonemap.wgsl`.

use glam::UVec2;
use haze_core::formula::tonemap;

use super::Formula;
use super::inputs::{ARITHMETIC, TRANSCENDENTAL, random, v3};

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
            name: "tonemapped",
            file: "lib/tonemap.wgsl",
            wgsl: "let v = tonemapped(vec3f(x(0), x(1), x(2)), x(3)); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| tonemap::tonemapped(v3(x), x[3]).to_array().to_vec(),
            cases: random(60, &[(0.0, 2.0), (0.0, 2.0), (0.0, 2.0), (0.1, 4.0)]),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("aces_fitted(color * exposure)", "aces_fitted(color)"),
                ("srgb_color(aces_fitted", "(aces_fitted"),
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
