//! Formula tests of `shaders/lib/depth.wgsl`.

use glam::{IVec2, vec4};
use haze_core::formula::depth;
use haze_core::settings::DepthDownsample;

use super::Formula;
use super::inputs::{ARITHMETIC, count, random, v4, with_choices};

pub fn formulas() -> Vec<Formula> {
    vec![
        Formula {
            name: "stored_depth",
            file: "depth_downsample.wgsl",
            wgsl: "COARSE_COPY = x(2) > 0.5; system.depth_limit = x(1); y(0, 1000.0 * stored_depth(x(0)));",
            reference: |x| vec![1000.0 * depth::stored_depth(x[0], x[1], x[2] > 0.5)],
            cases: random(100, &[(0.0, 9.0), (2.0, 8.0), (0.0, 1.0)]),
            tolerance: ARITHMETIC,
            mutants: &[
                ("saturate(view_depth / system.depth_limit", "(view_depth / system.depth_limit"),
                ("1.0 / 65535.0, COARSE_COPY", "0.0, COARSE_COPY"),
            ],
        },
        Formula {
            name: "view_depth_from_ndc_depth",
            file: "lib/depth.wgsl",
            wgsl: "y(0, view_depth_from_ndc_depth(x(0), vec4f(x(1), x(2), x(3), x(4))));",
            reference: |x| vec![depth::view_depth_from_ndc_depth(x[0], v4(&x[1..]))],
            cases: {
                // Standard, reversed, infinite reversed and orthographic projections, over the whole depth range.
                let conventions = [
                    vec4(0.1, 0.0, 1.0, -0.999),
                    vec4(0.1, 0.0, 0.001, 0.999),
                    vec4(0.1, 0.0, 0.0, 1.0),
                    vec4(0.5, 59.5, 1.0, 0.0),
                ];
                let depths = (0..=100).map(|i| i as f32 / 100.0);
                let case = |d: f32| conventions.map(|c| vec![d, c.x, c.y, c.z, c.w]);
                depths.flat_map(case).collect()
            },
            tolerance: 1e-5,
            mutants: &[
                ("coefficients.z + coefficients.w", "coefficients.z - coefficients.w"),
                ("coefficients.y * ndc_depth", "0.0"),
            ],
        },
        Formula {
            name: "farther_ndc_depth",
            file: "lib/depth.wgsl",
            wgsl: "y(0, farther_ndc_depth(x(0) > 0.5, x(1), x(2)));",
            reference: |x| vec![depth::farther_ndc_depth(x[0] > 0.5, x[1], x[2])],
            cases: random(50, &[(0.0, 1.0); 3]),
            tolerance: 0.0,
            mutants: &[("max(a, b), min(a, b)", "min(a, b), max(a, b)")],
        },
        Formula {
            name: "view_depth_from_linear",
            file: "lib/depth.wgsl",
            wgsl: "y(0, view_depth_from_linear(x(0)));",
            reference: |x| vec![depth::view_depth_from_linear(x[0])],
            cases: random(50, &[(0.0, 2.0e6)]),
            tolerance: 0.0,
            mutants: &[("texel < SKY_VIEW_DEPTH", "true")],
        },
        Formula {
            name: "depth_downsample_keeps_farthest",
            file: "lib/depth.wgsl",
            wgsl: "y(0, select(0.0, 1.0, depth_downsample_keeps_farthest(u32(x(0)), vec2i(i32(x(1)), i32(x(2))))));",
            reference: |x| {
                let texel = IVec2::new(x[1] as i32, x[2] as i32);
                let farthest = depth::depth_downsample_keeps_farthest(DepthDownsample::ALL[x[0] as usize], texel);
                vec![if farthest { 1.0 } else { 0.0 }]
            },
            cases: with_choices(count(DepthDownsample::ALL), &[(0.0, 9.0), (0.0, 9.0)]),
            tolerance: 0.0,
            mutants: &[
                ("(texel.x + texel.y) & 1", "(texel.x) & 1"),
                ("mode == DEPTH_DOWNSAMPLE_MAX", "mode == DEPTH_DOWNSAMPLE_MIN"),
            ],
        },
    ]
}
