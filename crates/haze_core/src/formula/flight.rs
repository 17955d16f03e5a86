//! Flight of an emitter's particles without the swirls of the air, solved in time. WGSL: `shaders/lib/flight.wgsl`.

use glam::{Vec2, Vec3};

use super::curve::{curve_integral, curve_value};
use super::uniforms::EmitterUniform;

/// ∫ e^(−k·s) ds and ∫∫ e^(−k·s) ds over 0..t: the displacement under drag k, per unit of initial velocity and per unit
/// of constant acceleration.
pub fn drag_integrals(drag: f32, t: f32) -> Vec2 {
    let x = drag * t;
    if x < 0.5 {
        // The closed forms cancel near 0. This many terms of their series are exact to f32 here.
        let series = |terms: [f32; 6]| terms.into_iter().rev().fold(1.0, |sum, term| 1.0 - x / term * sum);
        let reached = series([2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
        let approached = series([3.0, 4.0, 5.0, 6.0, 7.0, 8.0]);
        return Vec2::new(t * reached, 0.5 * t * t * approached);
    }
    let reached = (1.0 - (-x).exp()) / drag;
    Vec2::new(reached, (t - reached) / drag)
}

/// Position and velocity at a time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Flight {
    /// World space, metres.
    pub position: Vec3,
    /// Metres per second.
    pub velocity: Vec3,
}

/// Solution of v' = drag·(wind − v) + buoyancy: position and velocity approach their limits as 1 − e^(−drag·t).
pub fn flight(emitter: &EmitterUniform, start: &Flight, seconds: f32) -> Flight {
    let Vec2 { x: reached, y: approached } = drag_integrals(emitter.drag, seconds);
    let kept = 1.0 - emitter.drag * reached;
    Flight {
        position: start.position
            + start.velocity * reached
            + emitter.wind * (seconds - reached)
            + emitter.rise * approached,
        velocity: start.velocity * kept + emitter.wind * (1.0 - kept) + emitter.rise * reached,
    }
}

/// After so many bounces a particle lies still.
const MAX_BOUNCES: u32 = 3;
const IMPACT_STEPS: u32 = 20;

/// Flight that bounces off the floor.
pub fn bouncing_flight(emitter: &EmitterUniform, start: &Flight, seconds: f32) -> Flight {
    let mut now = flight(emitter, start, seconds);
    if emitter.bounce <= 0.0 {
        return now;
    }
    let is_below = |position: Vec3| position.dot(emitter.up) < emitter.floor;
    let mut last = *start;
    let mut left = seconds;
    for _ in 0..MAX_BOUNCES {
        if !is_below(now.position) {
            return now;
        }
        // The last time above the floor.
        let mut above = 0.0;
        let mut below = left;
        for _ in 0..IMPACT_STEPS {
            let middle = 0.5 * (above + below);
            match is_below(flight(emitter, &last, middle).position) {
                true => below = middle,
                false => above = middle,
            }
        }
        let impact = flight(emitter, &last, above);
        let reflected = impact.velocity - emitter.up * (2.0 * impact.velocity.dot(emitter.up));
        last = Flight { position: impact.position, velocity: reflected * emitter.bounce };
        left -= above;
        now = flight(emitter, &last, left);
    }
    if is_below(now.position) { Flight { velocity: Vec3::ZERO, ..last } } else { now }
}

/// Progress of a particle under the curve of speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    /// Value of the curve.
    pub speed: f32,
    /// Seconds in which a particle flies as far at a speed of 1.
    pub flown: f32,
}

/// Pace of a particle of this age in seconds.
pub fn pace_at(emitter: &EmitterUniform, lifetime: f32, seconds: f32) -> Pace {
    if emitter.has_curves == 0 {
        return Pace { speed: 1.0, flown: seconds };
    }
    let age = seconds / lifetime;
    Pace { speed: curve_value(&emitter.speed_curve, age), flown: lifetime * curve_integral(&emitter.speed_curve, age) }
}

/// Turns a vector about `up` by an angle (cos, sin).
pub fn turned(v: Vec3, up: Vec3, turn: Vec2) -> Vec3 {
    let along = up * v.dot(up);
    along + (v - along) * turn.x + up.cross(v) * turn.y
}

/// Flight turned about the axis of the orbit, which the wind carries along.
pub fn orbiting_flight(emitter: &EmitterUniform, straight: &Flight, flown: f32) -> Flight {
    if emitter.orbit_rate == 0.0 {
        return *straight;
    }
    let up = emitter.up;
    let reached = drag_integrals(emitter.drag, flown).x;
    let axis = Flight {
        position: emitter.position + emitter.wind * (flown - reached),
        velocity: emitter.wind * (emitter.drag * reached),
    };
    let turn = Vec2::from_angle(emitter.orbit_rate * flown);
    let side = turned(straight.position - axis.position, up, turn);
    Flight {
        position: axis.position + side,
        velocity: axis.velocity
            + turned(straight.velocity - axis.velocity, up, turn)
            + up.cross(side) * emitter.orbit_rate,
    }
}

/// Flight of a particle from its birth: drag, buoyancy, wind, the floor, the orbit, at the pace of its age.
pub fn paced_flight(emitter: &EmitterUniform, start: &Flight, pace: &Pace) -> Flight {
    let straight = bouncing_flight(emitter, start, pace.flown);
    let now = orbiting_flight(emitter, &straight, pace.flown);
    Flight { velocity: now.velocity * pace.speed, ..now }
}
