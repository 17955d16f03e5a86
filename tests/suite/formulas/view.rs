//! Formula tests of `shaders/lib/view.wgsl`.

use haze_core::formula::view;

use super::Formula;
use super::inputs::{ARITHMETIC, random, v2, with_choices};

pub fn formulas() -> Vec<Formula> {
    vec![
        Formula {
            name: "ndc_from_pixel",
            file: "lib/view.wgsl",
            wgsl: "let v = ndc_from_pixel(vec2f(x(0), x(1)), vec2f(x(2), x(3))); y(0, v.x); y(1, v.y);",
            reference: |x| view::ndc_from_pixel(v2(x), v2(&x[2..])).to_array().to_vec(),
            cases: random(50, &[(0.0, 640.0), (0.0, 360.0), (100.0, 640.0), (100.0, 360.0)]),
            tolerance: ARITHMETIC,
            mutants: &[("1.0 - pixel.y / size.y * 2.0", "pixel.y / size.y * 2.0 - 1.0")],
        },
        Formula {
            name: "pixel_from_ndc",
            file: "lib/view.wgsl",
            wgsl: "let v = pixel_from_ndc(vec2f(x(0), x(1)), vec2f(x(2), x(3))); y(0, v.x); y(1, v.y);",
            reference: |x| view::pixel_from_ndc(v2(x), v2(&x[2..])).to_array().to_vec(),
            cases: random(50, &[(-1.0, 1.0), (-1.0, 1.0), (100.0, 640.0), (100.0, 360.0)]),
            tolerance: ARITHMETIC,
            mutants: &[("0.5 - ndc.y * 0.5", "0.5 + ndc.y * 0.5")],
        },
        Formula {
            name: "view_position",
            file: "lib/view.wgsl",
            wgsl: "let v = view_position(vec2f(x(1), x(2)), x(3), x(0)); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| view::view_position(v2(&x[1..]), x[3], x[0]).to_array().to_vec(),
            cases: with_choices(2, &[(-1.0, 1.0), (-1.0, 1.0), (0.1, 50.0)]),
            tolerance: ARITHMETIC,
            mutants: &[("mix(view_depth, 1.0, orthographic)", "view_depth"), ("-view_depth)", "view_depth)")],
        },
        Formula {
            name: "pixels_per_metre",
            file: "lib/view.wgsl",
            wgsl: "y(0, pixels_per_metre(x(1), x(2), x(3), x(0)));",
            reference: |x| vec![view::pixels_per_metre(x[1], x[2], x[3], x[0])],
            cases: with_choices(2, &[(100.0, 640.0), (0.2, 2.0), (0.1, 50.0)]),
            tolerance: ARITHMETIC,
            mutants: &[("mix(1.0 / view_depth, 1.0, orthographic)", "1.0 / view_depth"), ("0.5 * height", "height")],
        },
    ]
}
