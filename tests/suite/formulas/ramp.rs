//! Formula tests of `shaders/lib/ramp.wgsl`.

use haze_core::formula::ramp;
use haze_core::settings::RampFilter;

use super::Formula;
use super::inputs::{ARITHMETIC, random, test_ramp, v2};

pub fn formulas() -> Vec<Formula> {
    vec![
        Formula {
            name: "sample_ramp_2d",
            file: "lib/ramp.wgsl",
            wgsl: "let v = sample_ramp_2d(test_ramp, test_sampler, vec2f(x(0), x(1))); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| ramp::sample_ramp_2d(&test_ramp(), RampFilter::Bilinear, v2(x)).to_array().to_vec(),
            cases: random(200, &[(-0.1, 1.1); 2]),
            tolerance: 1e-5,
            // Mutants: swapped axes; 0 and 1 at the image's edges instead of the outer texel centers.
            mutants: &[("saturate(coordinate)", "saturate(coordinate.yx)"), ("* (size - 1.0)", "* size - 0.5")],
        },
        Formula {
            name: "ramp_texel",
            file: "lib/ramp.wgsl",
            wgsl: "let v = ramp_texel(vec2f(x(2), x(3)), vec2f(x(0), x(1))); y(0, v.x); y(1, v.y);",
            reference: |x| ramp::ramp_texel(v2(&x[2..]).as_uvec2(), v2(x)).to_array().to_vec(),
            cases: vec![vec![-0.1, 0.3, 16.0, 1.0], vec![0.5, 1.2, 256.0, 64.0], vec![1.0, 0.7, 4.0, 9.0]],
            tolerance: ARITHMETIC,
            mutants: &[("(size - 1.0)", "size"), ("saturate(coordinate)", "coordinate")],
        },
        Formula {
            name: "sample_ramp_nearest",
            file: "lib/ramp.wgsl",
            wgsl: "let v = sample_ramp_nearest(test_ramp, vec2f(x(0), x(1))); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| ramp::sample_ramp_nearest(&test_ramp(), v2(x)).to_array().to_vec(),
            cases: random(200, &[(-0.1, 1.1); 2]),
            tolerance: 1e-6,
            mutants: &[("coordinate) + 0.5)", "coordinate))"), ("saturate(coordinate)", "saturate(coordinate.yx)")],
        },
        Formula {
            name: "sample_ramp",
            file: "lib/ramp.wgsl",
            wgsl: "let v = sample_ramp(test_ramp, test_sampler, x(0)); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| ramp::sample_ramp(&test_ramp(), RampFilter::Bilinear, x[0]).to_array().to_vec(),
            cases: random(100, &[(-0.1, 1.1)]),
            tolerance: 1e-5,
            mutants: &[("vec2f(u, 0.0)", "vec2f(0.0, u)")],
        },
    ]
}
