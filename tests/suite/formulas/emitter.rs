//! Formula tests of `shaders/lib/emitter.wgsl`.

use glam::{IVec3, Vec3, vec2, vec3, vec4};
use haze_core::emitter::EmitterShape;
use haze_core::formula::curve::{self, CurvePoints};
use haze_core::formula::emitter::{self, Flight, Flying, SwirlStep};
use haze_core::formula::uniforms::EmitterUniform;
use haze_core::settings::Curve;

use super::Formula;
use super::inputs::{ARITHMETIC, TRANSCENDENTAL, count, random, v3, with_choices};

/// Returns an emitter of shape number `x[0]`, eight seconds after its first birth.
fn test_emitter(x: &[f32]) -> EmitterUniform {
    EmitterUniform {
        first: u32::MAX - 100,
        count: 330,
        seed: 3,
        shape: x[0] as u32,
        since_first: 8.0,
        rate: 40.0,
        lifetime: 6.0,
        lifetime_spread: 0.4,
        position: vec3(1.0, 2.0, 3.0),
        burst: 0.7,
        extent: vec3(0.5, 0.25, 0.75),
        velocity_spread: 0.5,
        velocity: vec3(0.1, 0.6, 0.0),
        drag: 0.6,
        rise: vec3(0.0, 0.5, 0.1),
        swirl_strength: 0.2,
        wind: vec3(0.3, 0.0, -0.2),
        swirl_frequency: 0.4,
        disc_x: vec3(0.6, 0.8, 0.0),
        radius_start: 0.25,
        disc_z: Vec3::Z,
        radius_end: 1.5,
        swirl_turn: 0.6,
        swirl_turn_rate: 0.3,
        radius_spread: 0.25,
        spin: 0.5,
        amount: 0.5,
        fade_in: 0.25,
        fade_out: 0.5,
        frame_rate: 4.0,
        tint: vec3(0.9, 0.2, 0.4),
        heat_spread: 0.6,
        other_tint: vec3(0.3, 0.8, 1.0),
        bounce: 0.0,
        up: Vec3::Y,
        floor: 1.8,
        per_pulse: 13,
        first_in_pulse: 5,
        period: 0.34,
        has_curves: 1,
        speed_curve: curve("0:1.5,0.4:0.6,0.9:1.1"),
        size_curve: curve("0.1:0.2,0.7:1.4"),
        amount_curve: curve("0:0.3,0.2:1,0.5:0.4,1:0.8"),
        rate_curve: curve("0:1,1:0.5"),
        anchor: 0.7,
        rotation_spread: 0.4,
        has_rate_curve: 1,
        swirl_detail: 0.7,
        swirl_travel: vec3(0.2, 0.5, -0.1),
        swirl_offset: vec3(0.3, 0.9, 0.1),
        swirl_first: IVec3::new(-9, 7, 100_000),
        ..EmitterUniform::default()
    }
}

fn curve(text: &str) -> CurvePoints {
    let points = text.parse::<Curve>().unwrap().points().to_vec();
    let last = points[points.len() - 1];
    std::array::from_fn(|pair| {
        let at = |index: usize| points.get(index).copied().unwrap_or(last);
        (at(2 * pair), at(2 * pair + 1)).into()
    })
}

macro_rules! wgsl_emitter {
    ($call:literal) => {
        concat!(
            "var e = Emitter(4294967195u, 330u, 3u, u32(x(0)), 8.0, 40.0, 6.0, 0.4, vec3f(1.0, 2.0, 3.0), 0.7, \
             vec3f(0.5, 0.25, 0.75), 0.5, vec3f(0.1, 0.6, 0.0), 0.6, vec3f(0.0, 0.5, 0.1), 0.2, vec3f(0.3, 0.0, -0.2), \
             0.4, vec3f(0.6, 0.8, 0.0), 0.25, vec3f(0.0, 0.0, 1.0), 1.5, 0.6, 0.3, 0.25, 0.5, 0.5, 0.25, 0.5, 4.0, \
             vec3f(0.9, 0.2, 0.4), 0.6, vec3f(0.3, 0.8, 1.0), 0.0, vec3f(0.0, 1.0, 0.0), 1.8, 13u, 5u, 0.34, 1u, \
             Curve(array(vec4f(0.0, 1.5, 0.4, 0.6), vec4f(0.9, 1.1, 0.9, 1.1), vec4f(0.9, 1.1, 0.9, 1.1), vec4f(0.9, 1.1, 0.9, 1.1))), \
             Curve(array(vec4f(0.1, 0.2, 0.7, 1.4), vec4f(0.7, 1.4, 0.7, 1.4), vec4f(0.7, 1.4, 0.7, 1.4), vec4f(0.7, 1.4, 0.7, 1.4))), \
             Curve(array(vec4f(0.0, 0.3, 0.2, 1.0), vec4f(0.5, 0.4, 1.0, 0.8), vec4f(1.0, 0.8, 1.0, 0.8), vec4f(1.0, 0.8, 1.0, 0.8))), \
             Curve(array(vec4f(0.0, 1.0, 1.0, 0.5), vec4f(1.0, 0.5, 1.0, 0.5), vec4f(1.0, 0.5, 1.0, 0.5), vec4f(1.0, 0.5, 1.0, 0.5))), \
             0.7, 0.4, 1u, 0.7, vec3f(0.2, 0.5, -0.1), 0.0, vec3f(0.3, 0.9, 0.1), 0.0, vec3i(-9, 7, 100000), 0.0); ",
            $call
        )
    };
}

const WGSL_BIRTH_OFFSET: &str =
    wgsl_emitter!("let v = birth_offset(e, vec3f(x(1), x(2), x(3))); y(0, v.x); y(1, v.y); y(2, v.z);");

const WGSL_FLIGHT: &str = wgsl_emitter!(
    "let f = flight(e, vec3f(x(0), x(1), x(2)), vec3f(x(3), x(4), x(5)), x(6)); y3(0, f.position); y3(3, f.velocity);"
);

const WGSL_BOUNCING: &str = wgsl_emitter!(
    "e.bounce = 0.7; e.rise = vec3f(0.0, -9.0, 0.0); \
     let f = bouncing_flight(e, vec3f(x(0), x(1), x(2)), vec3f(x(3), x(4), x(5)), x(6)); \
     y3(0, f.position); y3(3, f.velocity);"
);

const WGSL_CARRIED: &str = wgsl_emitter!(
    "let f = carried_by_swirls(e, Flying(Flight(vec3f(x(0), x(1), x(2)), vec3f(x(3), x(4), x(5))), 6.0, x(6))); \
     y3(0, f.position); y3(3, f.velocity);"
);

const WGSL_DELAY: &str = wgsl_emitter!("y(0, birth_delay(e, u32(x(0))));");

const WGSL_BORN: &str = wgsl_emitter!("y(0, f32(is_born(e, u32(x(0)))));");

const WGSL_EMITTED: &str = wgsl_emitter!(
    "let p = emitted_particle(e, u32(x(1))); for (var i = 0u; i < 4u; i++) { y(i, p.position_radius[i]); \
     y(4u + i, p.rotation_amount_frame_age[i]); } y3(8, p.velocity); y4(11, unpack4x8unorm(p.tint_heat));"
);

pub fn formulas() -> Vec<Formula> {
    [functions(), curves(), flights(), births()].into_iter().flatten().collect()
}

fn functions() -> Vec<Formula> {
    vec![
        Formula {
            name: "unit_sphere",
            file: "lib/emitter.wgsl",
            wgsl: "let v = unit_sphere(vec3f(x(0), x(1), x(2))); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| emitter::unit_sphere(v3(x)).to_array().to_vec(),
            cases: random(100, &[(0.0, 1.0); 3]),
            tolerance: TRANSCENDENTAL,
            mutants: &[("random.z * 2.0 - 1.0", "random.z"), ("sqrt(1.0 - z * z)", "(1.0 - z * z)")],
        },
        Formula {
            name: "drag_integrals",
            file: "lib/emitter.wgsl",
            wgsl: "let v = drag_integrals(x(0), x(1)); y(0, v.x); y(1, v.y);",
            reference: |x| emitter::drag_integrals(x[0], x[1]).to_array().to_vec(),
            // Zero, small and large drag, on both sides of the switch from the series to the closed form.
            cases: [(0.0, 0.0), (0.0, 2.0), (0.01, 8.0)]
                .into_iter()
                .flat_map(|drag| random(100, &[drag, (0.0, 8.0)]))
                .collect(),
            // 1 - exp(-x) cancels, and is divided twice by a drag as small as 0.06.
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("x / 2.0 * (1.0 - x / 3.0", "x / 2.0 * (1.0 - x / 4.0"),
                ("0.5 * t * t * approached", "t * t * approached"),
                ("(1.0 - exp(-x)) / drag", "(1.0 - exp(-x))"),
                ("(t - reached) / drag", "t - reached"),
            ],
        },
        Formula {
            name: "smoothstep_unit",
            file: "lib/emitter.wgsl",
            wgsl: "y(0, smoothstep_unit(x(0)));",
            reference: |x| vec![emitter::smoothstep_unit(x[0])],
            cases: random(50, &[(-1.0, 2.0)]),
            tolerance: ARITHMETIC,
            mutants: &[("3.0 - 2.0 * s", "2.0 - s"), ("let s = saturate(x)", "let s = x")],
        },
    ]
}

fn flights() -> Vec<Formula> {
    const CASES: [(f32, f32); 7] =
        [(-1.0, 1.0), (1.8, 3.0), (-1.0, 1.0), (-2.0, 2.0), (-3.0, 3.0), (-2.0, 2.0), (0.0, 3.0)];
    vec![
        Formula {
            name: "flight",
            file: "lib/emitter.wgsl",
            wgsl: WGSL_FLIGHT,
            reference: |x| {
                let flight = emitter::flight(&test_emitter(&[0.0]), v3(x), v3(&x[3..]), x[6]);
                [flight.position.to_array(), flight.velocity.to_array()].concat()
            },
            cases: random(60, &CASES),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("emitter.wind * (seconds - reached)", "emitter.wind * seconds"),
                ("emitter.rise * integrals.y", "emitter.rise"),
                ("velocity * kept", "velocity"),
                ("emitter.wind * (1.0 - kept)", "emitter.wind"),
                ("emitter.rise * reached", "emitter.rise"),
            ],
        },
        Formula {
            name: "bouncing_flight",
            file: "lib/emitter.wgsl",
            wgsl: WGSL_BOUNCING,
            reference: |x| {
                let emitter = EmitterUniform { bounce: 0.7, rise: vec3(0.0, -9.0, 0.0), ..test_emitter(&[0.0]) };
                let flight = emitter::bouncing_flight(&emitter, v3(x), v3(&x[3..]), x[6]);
                [flight.position.to_array(), flight.velocity.to_array()].concat()
            },
            cases: random(200, &CASES),
            // The last bounces turn a small error of the time of impact into one of velocity.
            tolerance: 2e-3,
            mutants: &[
                ("2.0 * dot(impact.velocity", "dot(impact.velocity"),
                ("reflected * emitter.bounce", "reflected"),
                ("left -= above", "left -= below * 0.5"),
                ("const MAX_BOUNCES: u32 = 3u", "const MAX_BOUNCES: u32 = 2u"),
                ("const IMPACT_STEPS: u32 = 20u", "const IMPACT_STEPS: u32 = 6u"),
            ],
        },
        Formula {
            name: "swirl",
            file: "lib/emitter.wgsl",
            wgsl: wgsl_emitter!("y3(0, swirl(e, vec3f(x(0), x(1), x(2)), x(3)));"),
            reference: |x| emitter::swirl(&test_emitter(&[0.0]), v3(x), x[3]).to_array().to_vec(),
            cases: random(60, &[(-3.0, 3.0), (-3.0, 3.0), (-3.0, 3.0), (-6.0, 0.2)]),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("emitter.swirl_turn_rate * later", "0.0"),
                ("position - emitter.swirl_travel * later", "position"),
                ("emitter.swirl_frequency) + emitter.swirl_offset", "emitter.swirl_frequency)"),
                ("SWIRL_OCTAVES: u32 = 3u", "SWIRL_OCTAVES: u32 = 2u"),
                ("emitter.seed * 977u + octave", "emitter.seed * 977u"),
                ("at *= 2.0", "at *= 2.1"),
                ("first += first", "first += vec3i(1i)"),
                ("strength *= emitter.swirl_detail", "strength *= 0.5"),
            ],
        },
        Formula {
            name: "carried_by_swirls",
            file: "lib/emitter.wgsl",
            wgsl: WGSL_CARRIED,
            reference: |x| {
                let start = Flight { position: v3(x), velocity: v3(&x[3..]) };
                let flying = Flying { start, lifetime: 6.0, seconds: x[6] };
                let carried = emitter::carried_by_swirls(&test_emitter(&[0.0]), &flying, &mut SwirlStep::default());
                [carried.position.to_array(), carried.velocity.to_array()].concat()
            },
            cases: random(60, &[CASES[0], CASES[1], CASES[2], CASES[3], CASES[4], CASES[5], (0.0, 5.99)]),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("SWIRL_STEPS: u32 = 32u", "SWIRL_STEPS: u32 = 31u"),
                ("SWIRL_ONSET: f32 = 0.15", "SWIRL_ONSET: f32 = 0.2"),
                ("path.position + offset", "path.position"),
                ("age * flying.lifetime - flying.seconds)", "0.0)"),
                ("* (speed * hold)", "* hold"),
                ("moved.velocity * 1.5 - last.moved.velocity * 0.5", "moved.velocity"),
                ("(moved.velocity * rest - next", "(moved.velocity * rest + next"),
                ("(6.0 * x * rest)", "(x * rest)"),
                ("rest * (1.0 - 3.0 * x)", "rest"),
                ("x * (3.0 * x - 2.0)", "x"),
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
    ]
}

/// Curve through three points, whose numbers are inputs 1 to 6; the ages increase.
macro_rules! wgsl_curve {
    ($call:literal) => {
        concat!(
            "let b = x(2) + 0.01 + x(4); let last = vec2f(b + 0.01 + x(6), x(7)); var c: Curve; \
             c.points[0] = vec4f(x(2), x(3), b, x(5)); for (var i = 1; i < 4; i++) { c.points[i] = vec4f(last, last); } ",
            $call
        )
    };
}

fn test_curve(x: &[f32]) -> CurvePoints {
    let b = x[2] + 0.01 + x[4];
    let last = vec2(b + 0.01 + x[6], x[7]);
    let pair = (last, last).into();
    [vec4(x[2], x[3], b, x[5]), pair, pair, pair]
}

fn curves() -> Vec<Formula> {
    let cases = || {
        random(100, &[(0.0, 7.99), (-0.1, 1.2), (0.0, 0.3), (0.0, 3.0), (0.0, 0.3), (0.0, 3.0), (0.0, 0.3), (0.0, 3.0)])
    };
    vec![
        Formula {
            name: "curve_point",
            file: "lib/curve.wgsl",
            wgsl: wgsl_curve!("y2(0, curve_point(c, u32(x(0))));"),
            reference: |x| curve::curve_point(&test_curve(x), x[0] as usize).to_array().to_vec(),
            cases: cases(),
            tolerance: 0.0,
            mutants: &[("select(pair.xy, pair.zw,", "select(pair.zw, pair.xy,"), ("index / 2u", "index / 4u")],
        },
        Formula {
            name: "curve_value",
            file: "lib/curve.wgsl",
            wgsl: wgsl_curve!("y(0, curve_value(c, x(1)));"),
            reference: |x| vec![curve::curve_value(&test_curve(x), x[1])],
            cases: cases(),
            // Divided by ages as close as 0.01.
            tolerance: ARITHMETIC * 100.0,
            mutants: &[
                ("(next.y - last.y) * saturate", "next.y * saturate"),
                ("saturate((age - last.x)", "(2.0 * (age - last.x)"),
            ],
        },
        Formula {
            name: "curve_integral",
            file: "lib/curve.wgsl",
            wgsl: wgsl_curve!("y(0, curve_integral(c, x(1)));"),
            reference: |x| vec![curve::curve_integral(&test_curve(x), x[1])],
            cases: cases(),
            tolerance: ARITHMETIC * 10.0,
            mutants: &[
                ("min(age, last.x) * last.y", "0.0"),
                ("0.5 * (next.y - last.y)", "(next.y - last.y)"),
                ("max(age - last.x, 0.0) * last.y", "0.0"),
            ],
        },
    ]
}

fn births() -> Vec<Formula> {
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
            name: "birth_random",
            file: "lib/emitter.wgsl",
            wgsl: "let v = birth_random(u32(x(0)), u32(x(1)), 9u); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| emitter::birth_random(x[0] as u32, x[1] as u32, 9).to_array().to_vec(),
            cases: random(50, &[(0.0, 1.0e6), (0.0, 4.0)]),
            tolerance: 0.0,
            mutants: &[("vec3u(index, salt, seed)", "vec3u(index, seed, salt)"), ("unit(hash.y)", "unit(hash.x)")],
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
                ("speed + carried.velocity", "speed"),
                ("mix(emitter.tint, emitter.other_tint, color.x)", "emitter.tint"),
                ("emitter.heat_spread * color.y", "emitter.heat_spread"),
                ("birth_random(index, 4u", "birth_random(index, 3u"),
                ("* sqrt(age)", "* age"),
                ("2.0 * look.x - 1.0", "look.x"),
                ("(2.0 * look.z - 1.0) * turned", "(2.0 * look.z - 1.0) * seconds"),
                ("fade_in * fade_out", "fade_in"),
                ("flown = lifetime * curve_integral", "flown = curve_integral"),
                ("curve_value(emitter.size_curve, age)", "curve_value(emitter.speed_curve, age)"),
                ("share * fade_in", "fade_in"),
                ("moved.velocity * speed", "moved.velocity"),
                ("emitter.up * (emitter.anchor * radius)", "emitter.up * emitter.anchor"),
                ("smoothstep_unit(age / max(emitter.fade_in", "saturate(age / max(emitter.fade_in"),
                ("place.x * 256.0 + seconds", "place.x * 256.0 - seconds"),
                ("birth_random(index, 3u", "birth_random(index, 2u"),
            ],
        },
    ]
}
