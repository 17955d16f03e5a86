//! Formula tests of `shaders/lib/stretch.wgsl` and `shaders/lib/particle.wgsl`.

use glam::{Vec2, Vec3};
use haze::Particle;
use haze_core::formula::stretch;

use super::Formula;
use super::inputs::{ARITHMETIC, TRANSCENDENTAL, random, v2, v3};

pub fn formulas() -> Vec<Formula> {
    [motion(), widths(), positions(), particles()].into_iter().flatten().collect()
}

fn motion() -> Vec<Formula> {
    vec![
        Formula {
            name: "stretch_ratio",
            file: "lib/stretch.wgsl",
            wgsl: "y(0, stretch_ratio(x(0), x(1), x(2)));",
            reference: |x| vec![stretch::stretch_ratio(x[0], x[1], x[2])],
            cases: random(60, &[(0.0, 4.0), (0.0, 1.0), (1.0, 6.0)]),
            tolerance: ARITHMETIC,
            mutants: &[("1.0 + 0.5 * length", "1.0 + length"), ("1.0e-6), limit)", "1.0e-6), 4.0)")],
        },
        Formula {
            name: "velocity_on_screen",
            file: "lib/stretch.wgsl",
            wgsl: "y2(0, velocity_on_screen(vec3f(x(0), x(1), x(2)), vec3f(x(3), x(4), x(5)), f32(x(6) > 0.5)));",
            reference: |x| {
                let orthographic = f32::from(x[6] > 0.5);
                stretch::velocity_on_screen(v3(x), v3(&x[3..]), orthographic).to_array().to_vec()
            },
            cases: moving(),
            tolerance: ARITHMETIC,
            mutants: &[
                ("velocity.z * (1.0 - orthographic)", "velocity.z"),
                ("velocity.xy + center.xy * approach", "velocity.xy"),
                ("velocity.xy + center.xy * approach", "velocity.xy - center.xy * approach"),
            ],
        },
        Formula {
            name: "sprite_stretch",
            file: "lib/stretch.wgsl",
            wgsl: "y2(0, sprite_stretch(vec3f(x(0), x(1), x(2)), vec3f(x(3), x(4), x(5)), 0.2, 0.4, 3.0, f32(x(6) > 0.5)));",
            reference: |x| {
                let orthographic = f32::from(x[6] > 0.5);
                stretch::sprite_stretch(v3(x), v3(&x[3..]), 0.2, 0.4, 3.0, orthographic).to_array().to_vec()
            },
            cases: moving(),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("min(speed, length(velocity)) * seconds", "speed * seconds"),
                ("1.0 - 1.0 / ratio", "ratio"),
                ("across * (sqrt", "across.yx * (sqrt"),
            ],
        },
    ]
}

/// Places in front of the viewer, velocities, and the kind of projection.
fn moving() -> Vec<Vec<f32>> {
    random(100, &[(-3.0, 3.0), (-3.0, 3.0), (-6.0, -1.0), (-4.0, 4.0), (-4.0, 4.0), (-4.0, 4.0), (0.0, 1.0)])
}

fn widths() -> Vec<Formula> {
    vec![Formula {
        name: "widened_fraction",
        file: "lib/stretch.wgsl",
        wgsl: "y(0, widened_fraction(x(0), x(1), vec2f(x(2), x(3)), vec2f(x(4), x(5))));",
        reference: |x| vec![stretch::widened_fraction(x[0], x[1], v2(&x[2..]), v2(&x[4..]))],
        cases: random(80, &[(0.0, 1.0), (0.2, 2.0), (-0.6, 0.6), (-0.6, 0.6), (-0.4, 0.4), (-0.4, 0.4)]),
        tolerance: ARITHMETIC * 4.0,
        mutants: &[
            ("ratio * ratio", "ratio"),
            ("(1.0 - dot(stretch, stretch))", "1.0"),
            ("1.0e-4), 1.0)", "1.0e-4), 100.0)"),
        ],
    }]
}

fn positions() -> Vec<Formula> {
    let cases = || random(60, &[(-2.0, 2.0), (-2.0, 2.0), (-0.6, 0.6), (-0.6, 0.6), (0.1, 1.0)]);
    vec![
        Formula {
            name: "stretched",
            file: "lib/stretch.wgsl",
            wgsl: "y2(0, stretched(vec2f(x(0), x(1)), vec2f(x(2), x(3))));",
            reference: |x| stretch::stretched(v2(x), v2(&x[2..])).to_array().to_vec(),
            cases: cases(),
            tolerance: ARITHMETIC,
            mutants: &[
                ("max(1.0 - dot(stretch, stretch), 1.0e-4)", "1.0"),
                ("position + stretch *", "position - stretch *"),
            ],
        },
        Formula {
            name: "unstretched",
            file: "lib/stretch.wgsl",
            wgsl: "let q = vec2f(x(2), x(3)); y2(0, unstretched(vec2f(x(0), x(1)), q)); \
                   y2(2, unstretched(stretched(vec2f(x(0), x(1)), q), q));",
            reference: |x| {
                let back = v2(x).to_array();
                [stretch::unstretched(v2(x), v2(&x[2..])).to_array(), back].concat()
            },
            cases: cases(),
            tolerance: ARITHMETIC * 4.0,
            mutants: &[("position - stretch * dot(stretch, position)", "position + stretch * dot(stretch, position)")],
        },
        Formula {
            name: "stretched_normal",
            file: "lib/stretch.wgsl",
            wgsl: "y3(0, stretched_normal(vec3f(x(0), x(1), x(4)), vec2f(x(2), x(3))));",
            reference: |x| {
                let normal = Vec3::new(x[0], x[1], x[4]);
                stretch::stretched_normal(normal, Vec2::new(x[2], x[3])).to_array().to_vec()
            },
            cases: cases(),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("unstretched(normal.xy, stretch)", "stretched(normal.xy, stretch)"),
                ("turned * sqrt", "turned + 0.0 * sqrt"),
            ],
        },
    ]
}

fn particles() -> Vec<Formula> {
    vec![Formula {
        name: "particle_from_words",
        file: "lib/particle.wgsl",
        wgsl: "let a = bitcast<vec4u>(vec4f(x(0), x(1), x(2), x(3))); let b = bitcast<vec4u>(vec4f(x(4), x(5), x(6), x(7))); \
               let c = vec4u(bitcast<vec3u>(vec3f(x(8), x(9), x(10))), u32(x(11)) | (u32(x(12)) << 8u) \
               | (u32(x(13)) << 16u) | (u32(x(14)) << 24u)); let p = particle_from_words(a, b, c); \
               y4(0, p.position_radius); y4(4, p.rotation_amount_frame_age); y3(8, p.velocity); y4(11, p.tint_heat);",
        reference: |x| {
            let mut bytes: Vec<u8> = x[..11].iter().flat_map(|number| number.to_le_bytes()).collect();
            bytes.extend(x[11..15].iter().map(|channel| *channel as u8));
            let p: Particle = bytemuck::pod_read_unaligned(&bytes);
            let color = [p.tint[0], p.tint[1], p.tint[2], p.heat].map(|channel| f32::from(channel) / 255.0);
            let look = [p.rotation, p.amount, p.frame, p.age];
            [&p.position.to_array()[..], &[p.radius], &look, &p.velocity.to_array(), &color].concat()
        },
        cases: random(40, &[[(-9.0, 9.0); 11].as_slice(), &[(0.0, 255.99); 4]].concat()),
        tolerance: ARITHMETIC,
        mutants: &[
            ("bitcast<vec3f>(third.xyz)", "bitcast<vec3f>(third.zyx)"),
            ("unpack4x8unorm(third.w)", "vec4f(1.0)"),
        ],
    }]
}
