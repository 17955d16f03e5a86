//! Formula tests of `shaders/lib/emitter.wgsl`.

use haze_core::emitter::EmitterShape;
use haze_core::formula::emitter;

use super::Formula;
use super::flight::{test_emitter, wgsl_emitter};
use super::inputs::{ARITHMETIC, TRANSCENDENTAL, count, random, v3, with_choices};

const WGSL_BIRTH_OFFSET: &str =
    wgsl_emitter!("let v = birth_offset(e, vec3f(x(1), x(2), x(3))); y(0, v.x); y(1, v.y); y(2, v.z);");

const WGSL_DELAY: &str = wgsl_emitter!("y(0, birth_delay(e, u32(x(0))));");

const WGSL_BORN: &str = wgsl_emitter!("y(0, f32(is_born(e, u32(x(0)))));");

const WGSL_EMITTED: &str = wgsl_emitter!(
    "let p = emitted_particle(e, u32(x(1))); for (var i = 0u; i < 4u; i++) { y(i, p.position_radius[i]); \
     y(4u + i, p.rotation_amount_frame_age[i]); } y3(8, p.velocity); y4(11, unpack4x8unorm(p.tint_heat));"
);

pub fn formulas() -> Vec<Formula> {
    vec![
        Formula {
            name: "birth_offset",
            file: "lib/emitter.wgsl",
            wgsl: WGSL_BIRTH_OFFSET,
            reference: |x| emitter::birth_offset(&test_emitter(x), v3(&x[1..])).to_array().to_vec(),
            cases: with_choices(count(EmitterShape::ALL), &[(0.0, 1.0); 3]),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("pow(random.x, 1.0 / 3.0)", "random.x"),
                ("(random * 2.0 - 1.0) * emitter.extent", "random * emitter.extent"),
                ("sqrt(random.z) * emitter.extent.xz", "random.z * emitter.extent.xz"),
                ("emitter.disc_z * level.y", "emitter.disc_x * level.y"),
            ],
        },
        Formula {
            name: "birth_delay",
            file: "lib/emitter.wgsl",
            wgsl: WGSL_DELAY,
            reference: |x| vec![emitter::birth_delay(&test_emitter(&[0.0]), x[0] as u32)],
            cases: random(60, &[(0.0, 330.0)]),
            tolerance: ARITHMETIC,
            mutants: &[
                ("f32(pulse) * emitter.period", "f32(pulse)"),
                ("- i32(emitter.first_in_pulse)", ""),
                (") / emitter.rate", ")"),
            ],
        },
        Formula {
            name: "is_born",
            file: "lib/emitter.wgsl",
            wgsl: WGSL_BORN,
            reference: |x| vec![f32::from(emitter::is_born(&test_emitter(&[0.0]), x[0] as u32))],
            cases: random(200, &[(0.0, 330.0)]),
            tolerance: 0.0,
            mutants: &[
                ("(emitter.first + number) * GOLDEN", "number * GOLDEN"),
                ("GOLDEN: u32 = 2654435769u", "GOLDEN: u32 = 1654435769u"),
                ("(emitter.first_in_pulse + number) % emitter.per_pulse", "number % emitter.per_pulse"),
                ("emitter.rate_curve, (f32(in_pulse)", "emitter.amount_curve, (f32(in_pulse)"),
            ],
        },
        Formula {
            name: "rotation_at_birth",
            file: "lib/emitter.wgsl",
            wgsl: "y(0, rotation_at_birth(x(0), x(1)));",
            reference: |x| vec![emitter::rotation_at_birth(x[0], x[1])],
            cases: random(40, &[(0.0, 1.0), (0.0, 1.0)]),
            tolerance: ARITHMETIC,
            mutants: &[("0.5 * (1.0 - spread)", "0.5"), ("TURN * spread", "TURN")],
        },
        Formula {
            name: "emitted_particle",
            file: "lib/emitter.wgsl",
            wgsl: WGSL_EMITTED,
            reference: |x| {
                let emitted = emitter::emitted_particle(&test_emitter(x), x[1] as u32);
                let first = [emitted.position_radius, emitted.rotation_amount_frame_age].map(|v| v.to_array()).concat();
                let color = emitted.tint_heat.map(|channel| f32::from(channel) / 255.0);
                [&first, &emitted.velocity.to_array()[..], &color].concat()
            },
            // 40 births per second over the last 8 seconds: some particles are dead.
            cases: with_choices(count(EmitterShape::ALL), &[(0.0, 330.0)]),
            // The swirls amplify errors of the driver's exp, sin and sqrt along the path, here to 2.1e-4.
            tolerance: 2.0 * TRANSCENDENTAL,
            mutants: &[
                (" - life.y / emitter.rate", ""),
                ("seconds < lifetime", "true"),
                ("!is_born(emitter, number)", "false"),
                ("2.0 * life.x - 1.0", "life.x"),
                ("outward * emitter.burst", "vec3f(0.0)"),
                ("emitter.velocity_spread * life.z", "emitter.velocity_spread"),
                ("moved.position + carried.position", "moved.position"),
                ("moved.velocity + carried.velocity", "moved.velocity"),
                ("color.z < emitter.small_fraction", "color.y < emitter.small_fraction"),
                ("select(1.0, emitter.small_size", "select(1.0, emitter.small_fraction"),
                ("pace_at(emitter, lifetime, seconds)", "pace_at(emitter, lifetime, age)"),
                ("mix(emitter.tint, emitter.other_tint, color.x)", "emitter.tint"),
                ("emitter.heat_spread * color.y", "emitter.heat_spread"),
                ("birth_random(index, 4u", "birth_random(index, 3u"),
                ("* sqrt(age)", "* age"),
                ("2.0 * look.x - 1.0", "look.x"),
                ("(2.0 * look.z - 1.0) * turned", "(2.0 * look.z - 1.0) * seconds"),
                ("fade_in * fade_out", "fade_in"),
                ("curve_value(emitter.size_curve, age)", "curve_value(emitter.speed_curve, age)"),
                ("fraction * fade_in", "fade_in"),
                ("emitter.up * (emitter.anchor * radius)", "emitter.up * emitter.anchor"),
                ("smoothstep_unit(age / max(emitter.fade_in", "saturate(age / max(emitter.fade_in"),
                ("random_offset.x * 256.0 + seconds", "random_offset.x * 256.0 - seconds"),
                ("birth_random(index, 3u", "birth_random(index, 2u"),
            ],
        },
    ]
}
