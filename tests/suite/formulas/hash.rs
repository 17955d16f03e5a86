//! Formula tests of `shaders/lib/hash.wgsl`.

use glam::UVec3;
use haze_core::formula::hash::{self, pcg3d, unit};

use super::Formula;
use super::inputs::{TRANSCENDENTAL, random, v3};

pub fn formulas() -> Vec<Formula> {
    vec![
        Formula {
            name: "pcg3d",
            file: "lib/hash.wgsl",
            wgsl: "let v = pcg3d(vec3u(u32(x(0)), u32(x(1)), u32(x(2)))) >> vec3u(8u); \
                   y(0, f32(v.x)); y(1, f32(v.y)); y(2, f32(v.z));",
            reference: |x| {
                let word = |i: usize| x[i] as u32;
                let v = pcg3d(UVec3::new(word(0), word(1), word(2)));
                (v >> UVec3::splat(8)).as_vec3().to_array().to_vec()
            },
            cases: random(50, &[(0.0, 1.0e6); 3])
                .into_iter()
                .map(|case| case.into_iter().map(f32::floor).collect())
                .collect(),
            tolerance: 0.0,
            mutants: &[("1664525u", "1664526u"), ("vec3u(16u)", "vec3u(15u)")],
        },
        Formula {
            name: "unit",
            file: "lib/hash.wgsl",
            wgsl: "y(0, unit(u32(x(0)) * 77777u));",
            reference: |x| vec![unit((x[0] as u32).wrapping_mul(77777))],
            cases: random(50, &[(0.0, 1.0e6)]),
            tolerance: 0.0,
            mutants: &[("word >> 8u", "word >> 9u")],
        },
        Formula {
            name: "unit_sphere",
            file: "lib/hash.wgsl",
            wgsl: "let v = unit_sphere(vec3f(x(0), x(1), x(2))); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| hash::unit_sphere(v3(x)).to_array().to_vec(),
            cases: random(100, &[(0.0, 1.0); 3]),
            tolerance: TRANSCENDENTAL,
            mutants: &[("random.z * 2.0 - 1.0", "random.z"), ("sqrt(1.0 - z * z)", "(1.0 - z * z)")],
        },
        Formula {
            name: "birth_random",
            file: "lib/hash.wgsl",
            wgsl: "let v = birth_random(u32(x(0)), u32(x(1)), 9u); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| hash::birth_random(x[0] as u32, x[1] as u32, 9).to_array().to_vec(),
            cases: random(50, &[(0.0, 1.0e6), (0.0, 4.0)]),
            tolerance: 0.0,
            mutants: &[("vec3u(index, salt, seed)", "vec3u(index, seed, salt)"), ("unit(hash.y)", "unit(hash.x)")],
        },
    ]
}
