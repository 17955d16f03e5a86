//! Formula tests of `shaders/lib/normal.wgsl`.

use haze_core::formula::normal;
use haze_core::settings::{NormalDecode, NormalEncoding};

use super::Formula;
use super::inputs::{ARITHMETIC, TRANSCENDENTAL, count, random, v2, v3, with_choices};

pub fn formulas() -> Vec<Formula> {
    vec![
        Formula {
            name: "accumulation_from_normal",
            file: "lib/normal.wgsl",
            wgsl: "let v = accumulation_from_normal(u32(x(0)), vec3f(x(1), x(2), x(3)), x(4), x(5)); \
                   y(0, v.x); y(1, v.y); y(2, v.z); y(3, v.w);",
            reference: |x| {
                let encoding = NormalEncoding::ALL[x[0] as usize];
                normal::accumulation_from_normal(encoding, v3(&x[1..]), x[4], x[5]).to_array().to_vec()
            },
            cases: with_choices(
                count(NormalEncoding::ALL),
                &[(-1.0, 1.0), (-1.0, 1.0), (-1.0, 1.0), (0.0, 1.0), (0.0, 1.0)],
            ),
            tolerance: ARITHMETIC,
            // The first two mutants do not premultiply, like OTEE's first, wrong blend.
            mutants: &[
                ("(normal * 0.5 + 0.5) * (amount * weight)", "normal * 0.5 + 0.5"),
                ("vec4f(normal * (amount * weight), amount)", "vec4f(normal, amount)"),
                ("vec4f(normal * (amount * weight), amount)", "vec4f(normal * amount, amount) * weight"),
            ],
        },
        Formula {
            name: "normal_from_accumulation",
            file: "lib/normal.wgsl",
            wgsl: "let v = normal_from_accumulation(u32(x(0)) / 2u, u32(x(0)) % 2u, vec3f(x(1), x(2), x(3)), x(4)); \
                   y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| {
                let encoding = NormalEncoding::ALL[x[0] as usize / 2];
                let decode = NormalDecode::ALL[x[0] as usize % 2];
                normal::normal_from_accumulation(encoding, decode, v3(&x[1..]), x[4]).to_array().to_vec()
            },
            cases: {
                let choices = count(NormalEncoding::ALL) * count(NormalDecode::ALL);
                let mut cases = with_choices(choices, &[(-1.0, 1.0), (-1.0, 1.0), (-1.0, 1.0), (0.0, 1.0)]);
                // Normals of empty texels face the viewer.
                cases.extend((0..4).map(|choice| vec![choice as f32, 0.0, 0.0, 0.0, 0.0]));
                cases
            },
            tolerance: TRANSCENDENTAL,
            mutants: &[("rgb * 2.0 - weights", "rgb * 2.0 - 1.0"), ("vec3f(0.0, 0.0, 1.0)", "vec3f(0.0)")],
        },
        Formula {
            name: "rotate_normal",
            file: "lib/normal.wgsl",
            wgsl: "let v = rotate_normal(vec3f(x(0), x(1), x(2)), vec2f(x(3), x(4))); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| normal::rotate_normal(v3(x), v2(&x[3..])).to_array().to_vec(),
            cases: random(50, &[(-1.0, 1.0); 5]),
            tolerance: ARITHMETIC,
            mutants: &[
                ("normal.x * rotation.x - normal.y", "normal.x * rotation.x + normal.y"),
                ("normal.z,", "-normal.z,"),
            ],
        },
    ]
}
