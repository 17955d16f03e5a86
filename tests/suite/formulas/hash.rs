//! Formula tests of `shaders/lib/hash.wgsl`.

use glam::UVec3;
use haze_core::assets::noise::{pcg3d, unit};

use super::Formula;
use super::inputs::random;

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
    ]
}
