//! Formula tests of `shaders/lib/color.wgsl`.

use haze_core::formula::color;

use super::Formula;
use super::inputs::{ARITHMETIC, TRANSCENDENTAL, random, v3};

pub fn formulas() -> Vec<Formula> {
    vec![
        Formula {
            name: "luminance",
            file: "lib/color.wgsl",
            wgsl: "y(0, luminance(vec3f(x(0), x(1), x(2))));",
            reference: |x| vec![color::luminance(v3(x))],
            cases: random(50, &[(0.0, 4.0); 3]),
            tolerance: ARITHMETIC,
            mutants: &[("0.7152, 0.0722", "0.0722, 0.7152")],
        },
        Formula {
            name: "srgb_from_linear",
            file: "lib/color.wgsl",
            wgsl: "y(0, srgb_from_linear(x(0)));",
            reference: |x| vec![color::srgb_from_linear(x[0])],
            cases: [random(100, &[(0.0, 1.0)]), random(50, &[(0.0, 0.01)])].concat(),
            tolerance: TRANSCENDENTAL,
            mutants: &[("1.0 / 2.4", "1.0 / 2.2"), ("linear * 12.92", "linear")],
        },
        Formula {
            name: "bounded_light",
            file: "lib/color.wgsl",
            wgsl: "let v = bounded_light(vec3f(x(0), x(1), x(2))); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| color::bounded_light(v3(x)).to_array().to_vec(),
            cases: random(50, &[(0.0, 1.0e5); 3]),
            tolerance: 0.0,
            mutants: &[("min(light", "max(light"), ("32752.0", "65504.0")],
        },
        Formula {
            name: "srgb_color",
            file: "lib/color.wgsl",
            wgsl: "let v = srgb_color(vec3f(x(0), x(1), x(2))); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| color::srgb_color(v3(x)).to_array().to_vec(),
            cases: random(100, &[(-0.5, 3.0); 3]),
            tolerance: TRANSCENDENTAL,
            mutants: &[("saturate(light)", "light"), ("srgb_from_linear(shown.g)", "shown.g")],
        },
        Formula {
            name: "overdraw_color",
            file: "lib/color.wgsl",
            wgsl: "let v = overdraw_color(x(0)); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| color::overdraw_color(x[0]).to_array().to_vec(),
            cases: [random(100, &[(0.0, 80.0)]), random(50, &[(0.0, 9.0)])].concat(),
            tolerance: TRANSCENDENTAL,
            mutants: &[("layers * 0.25", "layers * 0.5"), ("- 1.0, layers", "- 2.0, layers"), ("index + 1u", "index")],
        },
    ]
}
