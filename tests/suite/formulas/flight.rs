//! Formula tests of `shaders/lib/flight.wgsl`, and the emitter of those of `flow.wgsl` and `emitter.wgsl`.

use glam::{IVec3, Vec3, vec3};
use haze_core::formula::curve::CurvePoints;
use haze_core::formula::flight::{self, Flight, Pace};
use haze_core::formula::uniforms::EmitterUniform;
use haze_core::settings::Curve;

use super::Formula;
use super::inputs::{ARITHMETIC, TRANSCENDENTAL, random, v3};

/// Returns an emitter of shape number `x[0]`, eight seconds after its first birth.
pub(super) fn test_emitter(x: &[f32]) -> EmitterUniform {
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
        ring_rate: 0.6,
        ring_phase: 0.35,
        ring_first: 4_000_000_000,
        wind_shear: vec3(0.2, 0.0, -0.1),
        ring_speed: 0.9,
        attractor: vec3(2.0, 5.0, 3.5),
        attraction: 0.3,
        ring_size: 0.7,
        attractor_size: 0.6,
        orbit_rate: 0.2,
        has_flow: 1,
        small_fraction: 0.3,
        small_size: 0.6,
        floor_margin: 0.5,
        obstacle_margin: 0.6,
        obstacle: vec3(1.3, 4.0, 2.6),
        obstacle_rounding: 0.2,
        obstacle_core: vec3(0.4, 0.3, 0.45),
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
             0.7, 0.4, 1u, 0.7, vec3f(0.2, 0.5, -0.1), 0.6, vec3f(0.3, 0.9, 0.1), 0.35, vec3i(-9, 7, 100000), 4000000000u, \
             vec3f(0.2, 0.0, -0.1), 0.9, vec3f(2.0, 5.0, 3.5), 0.3, 0.7, 0.6, 0.2, 1u, 0.3, 0.6, 0.5, \
             0.6, vec3f(1.3, 4.0, 2.6), 0.2, vec3f(0.4, 0.3, 0.45), 0.0); ",
            $call
        )
    };
}
pub(super) use wgsl_emitter;

const WGSL_FLIGHT: &str = wgsl_emitter!(
    "let f = flight(e, Flight(vec3f(x(0), x(1), x(2)), vec3f(x(3), x(4), x(5))), x(6)); y3(0, f.position); y3(3, f.velocity);"
);

const WGSL_BOUNCING: &str = wgsl_emitter!(
    "e.bounce = 0.7; e.rise = vec3f(0.0, -9.0, 0.0); \
     let f = bouncing_flight(e, Flight(vec3f(x(0), x(1), x(2)), vec3f(x(3), x(4), x(5))), x(6)); \
     y3(0, f.position); y3(3, f.velocity);"
);

const WGSL_ORBITING: &str = wgsl_emitter!(
    "let f = orbiting_flight(e, Flight(vec3f(x(0), x(1), x(2)), vec3f(x(3), x(4), x(5))), x(6)); \
     y3(0, f.position); y3(3, f.velocity);"
);

const WGSL_PACED: &str = wgsl_emitter!(
    "let f = paced_flight(e, Flight(vec3f(x(0), x(1), x(2)), vec3f(x(3), x(4), x(5))), Pace(0.7, x(6))); \
     y3(0, f.position); y3(3, f.velocity);"
);

/// Position, velocity, seconds.
pub(super) const CASES: [(f32, f32); 7] =
    [(-1.0, 1.0), (1.8, 3.0), (-1.0, 1.0), (-2.0, 2.0), (-3.0, 3.0), (-2.0, 2.0), (0.0, 3.0)];

pub(super) fn start(x: &[f32]) -> Flight {
    Flight { position: v3(x), velocity: v3(&x[3..]) }
}

pub(super) fn numbers(flight: Flight) -> Vec<f32> {
    [flight.position.to_array(), flight.velocity.to_array()].concat()
}

pub fn formulas() -> Vec<Formula> {
    vec![
        Formula {
            name: "drag_integrals",
            file: "lib/flight.wgsl",
            wgsl: "let v = drag_integrals(x(0), x(1)); y(0, v.x); y(1, v.y);",
            reference: |x| flight::drag_integrals(x[0], x[1]).to_array().to_vec(),
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
            name: "flight",
            file: "lib/flight.wgsl",
            wgsl: WGSL_FLIGHT,
            reference: |x| numbers(flight::flight(&test_emitter(&[0.0]), &start(x), x[6])),
            cases: random(60, &CASES),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("emitter.wind * (seconds - reached)", "emitter.wind * seconds"),
                ("emitter.rise * integrals.y", "emitter.rise"),
                ("start.velocity * kept", "start.velocity"),
                ("emitter.wind * (1.0 - kept)", "emitter.wind"),
                ("emitter.rise * reached", "emitter.rise"),
            ],
        },
        Formula {
            name: "bouncing_flight",
            file: "lib/flight.wgsl",
            wgsl: WGSL_BOUNCING,
            reference: |x| {
                let emitter = EmitterUniform { bounce: 0.7, rise: vec3(0.0, -9.0, 0.0), ..test_emitter(&[0.0]) };
                numbers(flight::bouncing_flight(&emitter, &start(x), x[6]))
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
            name: "pace_at",
            file: "lib/flight.wgsl",
            wgsl: wgsl_emitter!("let p = pace_at(e, x(0), x(1)); y(0, p.speed); y(1, p.flown);"),
            reference: |x| {
                let pace = flight::pace_at(&test_emitter(&[0.0]), x[0], x[1]);
                vec![pace.speed, pace.flown]
            },
            cases: random(60, &[(1.0, 6.0), (0.0, 6.0)]),
            tolerance: 10.0 * ARITHMETIC,
            mutants: &[
                ("lifetime * curve_integral", "curve_integral"),
                ("curve_value(emitter.speed_curve, age)", "curve_value(emitter.size_curve, age)"),
            ],
        },
        Formula {
            name: "orbiting_flight",
            file: "lib/flight.wgsl",
            wgsl: WGSL_ORBITING,
            reference: |x| numbers(flight::orbiting_flight(&test_emitter(&[0.0]), &start(x), x[6])),
            cases: random(60, &CASES),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("emitter.wind * (flown - reached),", "vec3f(0.0),"),
                ("emitter.wind * (emitter.drag * reached)", "vec3f(0.0)"),
                ("(v - along) * turn.x", "v * turn.x"),
                ("cross(up, v) * turn.y", "cross(v, up) * turn.y"),
                ("cross(up, side) * emitter.orbit_rate", "cross(up, side)"),
                ("straight.velocity - axis.velocity, up", "straight.velocity, up"),
            ],
        },
        Formula {
            name: "paced_flight",
            file: "lib/flight.wgsl",
            wgsl: WGSL_PACED,
            reference: |x| {
                let pace = Pace { speed: 0.7, flown: x[6] };
                numbers(flight::paced_flight(&test_emitter(&[0.0]), &start(x), &pace))
            },
            cases: random(60, &CASES),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("now.velocity * pace.speed", "now.velocity"),
                ("orbiting_flight(emitter, straight", "orbiting_flight(emitter, start"),
            ],
        },
    ]
}
