//! Formula tests of `shaders/lib/gradient_noise.wgsl`.

use haze_core::formula::gradient_noise;

use super::Formula;
use super::inputs::{ARITHMETIC, random, v2, v3};

pub fn formulas() -> Vec<Formula> {
    vec![
        Formula {
            name: "lattice_gradient",
            file: "lib/gradient_noise.wgsl",
            wgsl: "let v = lattice_gradient(vec3i(i32(x(0)), i32(x(1)), i32(x(2))), vec2f(x(3), x(4)), 7u); \
                   y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| {
                let at = glam::IVec3::new(x[0] as i32, x[1] as i32, x[2] as i32);
                gradient_noise::lattice_gradient(at, v2(&x[3..]), 7).to_array().to_vec()
            },
            cases: random(50, &[(-9.0, 9.0), (-9.0, 9.0), (-9.0, 9.0), (-1.0, 1.0), (-1.0, 1.0)]),
            tolerance: ARITHMETIC,
            mutants: &[
                ("seed ^ 0x9e3779b9u", "seed"),
                ("hash & vec3u(0xffffu)", "hash >> vec3u(16u)"),
                ("second * phase.y", "second"),
            ],
        },
        Formula {
            name: "gradient_noise",
            file: "lib/gradient_noise.wgsl",
            wgsl: "let v = gradient_noise(vec3f(x(0), x(1), x(2)), vec2f(x(3), x(4)), 7u); \
                   y(0, v.value); y(1, v.gradient.x); y(2, v.gradient.y); y(3, v.gradient.z);",
            reference: |x| {
                let noise = gradient_noise::gradient_noise(v3(x), v2(&x[3..]), 7);
                [&[noise.value][..], &noise.gradient.to_array()].concat()
            },
            cases: random(200, &[(-9.0, 9.0), (-9.0, 9.0), (-9.0, 9.0), (-1.0, 1.0), (-1.0, 1.0)]),
            // Sums over eight lattice corners.
            tolerance: 4.0 * ARITHMETIC,
            mutants: &[
                ("f * 6.0 - 15.0", "f * 6.0 - 14.0"),
                ("f * f * 30.0", "f * f * 15.0"),
                ("select(-slope, slope, is_far)", "slope"),
                ("corner < 8u", "corner < 7u"),
                ("lattice * weight + vec3f", "vec3f"),
            ],
        },
        Formula {
            name: "curl_noise",
            file: "lib/gradient_noise.wgsl",
            wgsl: "let v = curl_noise(vec3f(x(0), x(1), x(2)), vec2f(x(3), x(4)), 7u); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| gradient_noise::curl_noise(v3(x), v2(&x[3..]), 7).to_array().to_vec(),
            cases: random(100, &[(-9.0, 9.0), (-9.0, 9.0), (-9.0, 9.0), (-1.0, 1.0), (-1.0, 1.0)]),
            tolerance: 8.0 * ARITHMETIC,
            mutants: &[("seed + 1u", "seed"), ("z.y - y.z", "y.z - z.y")],
        },
    ]
}
