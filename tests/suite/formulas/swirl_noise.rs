//! Formula tests of `shaders/lib/swirl_noise.wgsl`.

use glam::IVec3;
use haze_core::formula::swirl_noise;

use super::Formula;
use super::inputs::{ARITHMETIC, random, v2, v3};

pub fn formulas() -> Vec<Formula> {
    vec![
        Formula {
            name: "skewed",
            file: "lib/swirl_noise.wgsl",
            wgsl: "y3(0, skewed(vec3f(x(0), x(1), x(2))));",
            reference: |x| swirl_noise::skewed(v3(x)).to_array().to_vec(),
            cases: random(20, &[(-9.0, 9.0); 3]),
            tolerance: ARITHMETIC,
            mutants: &[("position.z) / 3.0", "position.z) / 4.0")],
        },
        Formula {
            name: "swirl_noise",
            file: "lib/swirl_noise.wgsl",
            wgsl: "y3(0, swirl_noise(vec3f(x(0), x(1), x(2)), vec3i(-7, 2147483640, 3), vec2f(x(3), x(4)), 7u));",
            reference: |x| {
                let first = IVec3::new(-7, 2_147_483_640, 3);
                swirl_noise::swirl_noise(v3(x), first, v2(&x[3..]), 7).to_array().to_vec()
            },
            cases: random(200, &[(-9.0, 9.0), (-9.0, 9.0), (-9.0, 9.0), (-1.0, 1.0), (-1.0, 1.0)]),
            // Coordinates up to 9, whose rounding the slope of the noise, up to 20, amplifies.
            tolerance: 100.0 * ARITHMETIC,
            mutants: &[
                ("SWIRL_RMS: f32 = 0.02286", "SWIRL_RMS: f32 = 0.023"),
                ("vec3u(22u, 12u, 2u)", "vec3u(22u, 12u, 1u)"),
                ("max(0.5 - dot(d, d), 0.0)", "abs(0.5 - dot(d, d))"),
                ("c * phase.x + a * phase.y", "c * phase.x + b * phase.y"),
                ("8.0 * cross(d, potential)", "7.9 * cross(d, potential)"),
                ("vec3i(cell) + first", "vec3i(cell)"),
                ("(f.x + f.y + f.z) / 6.0", "(f.x + f.y + f.z) / 5.0"),
                ("f.y >= f.z", "f.y <= f.z"),
                ("rank == vec3i(2i)", "rank == vec3i(0i)"),
                ("rank >= vec3i(1i)", "rank >= vec3i(2i)"),
            ],
        },
    ]
}
