//! Formula tests of `shaders/lib/blending.wgsl`.

use haze_core::formula::blending;
use haze_core::settings::BlendMode;

use super::Formula;
use super::inputs::{ARITHMETIC, count, v3, with_choices};

pub fn formulas() -> Vec<Formula> {
    vec![forward(), deferred()]
}

fn forward() -> Formula {
    Formula {
        name: "forward_fragment",
        file: "lib/blending.wgsl",
        wgsl: "let v = forward_fragment(u32(x(0)), vec3f(x(1), x(2), x(3)), x(4)); \
                   y(0, v.x); y(1, v.y); y(2, v.z); y(3, v.w);",
        reference: |x| blending::forward_fragment(BlendMode::ALL[x[0] as usize], v3(&x[1..]), x[4]).to_array().to_vec(),
        cases: with_choices(count(BlendMode::ALL), &[(0.0, 2.0), (0.0, 2.0), (0.0, 2.0), (0.0, 1.0)]),
        tolerance: ARITHMETIC,
        mutants: &[
            // The first mutant is not premultiplied.
            ("vec4f(light, 1.0) * coverage", "vec4f(light, coverage)"),
            ("light * coverage, 0.0", "light * coverage, coverage"),
            ("min(light, vec3f(1.0))", "light"),
        ],
    }
}

fn deferred() -> Formula {
    Formula {
        name: "deferred_fragment",
        file: "lib/blending.wgsl",
        wgsl: "let v = deferred_fragment(x(0) > 0.5, vec3f(x(1), x(2), x(3)), x(4)); \
               y(0, v.x); y(1, v.y); y(2, v.z); y(3, v.w);",
        reference: |x| blending::deferred_fragment(x[0] > 0.5, v3(&x[1..]), x[4]).to_array().to_vec(),
        cases: with_choices(2, &[(0.0, 2.0), (0.0, 2.0), (0.0, 2.0), (0.0, 1.0)]),
        tolerance: ARITHMETIC,
        mutants: &[
            ("light * coverage, select", "light, select"),
            ("select(coverage, 0.0, is_additive)", "coverage"),
            ("select(coverage, 0.0, is_additive)", "select(0.0, coverage, is_additive)"),
        ],
    }
}
