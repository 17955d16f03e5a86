//! Flow of the air that carries an emitter's particles beside their flight: swirls, rolling rings, wind that grows with the
//! height, a pull, a floor, a box. WGSL: `shaders/lib/flow.wgsl`.

use glam::{Vec2, Vec3};

use super::curve::smoothstep_unit;
use super::flight::{Flight, pace_at, paced_flight};
use super::hash::{birth_random, unit_sphere};
use super::swirl_noise::{skewed, swirl_noise};
use super::uniforms::EmitterUniform;

/// Each octave of the swirls has half the size of the one before.
const SWIRL_OCTAVES: u32 = 3;

/// Velocity of the swirls at a position, at so many seconds after the emitter's time.
pub fn swirl(emitter: &EmitterUniform, position: Vec3, later: f32) -> Vec3 {
    let phase = Vec2::from_angle(emitter.swirl_turn + emitter.swirl_turn_rate * later);
    let in_plume = position - emitter.swirl_travel * later;
    let mut at = skewed(in_plume * emitter.swirl_frequency) + emitter.swirl_offset;
    let mut first = emitter.swirl_first;
    let mut strength = emitter.swirl_strength;
    let mut sum = Vec3::ZERO;
    for octave in 0..SWIRL_OCTAVES {
        let seed = emitter.seed.wrapping_mul(977).wrapping_add(octave);
        sum += swirl_noise(at, first, phase, seed) * strength;
        at *= 2.0;
        first = first.wrapping_add(first);
        strength *= emitter.swirl_detail;
    }
    sum
}

/// Salt of the random numbers of rings.
const RING_SALT: u32 = 5;
/// A ring takes in air and widens by so much of its way: chosen by eye.
const RING_GROWTH: f32 = 0.12;
/// Random variation of radius and speed, up and down, as a fraction, and of the axis, as a fraction of its length.
const RING_SPREAD: f32 = 0.3;
/// Fraction of the life after which a ring rolls at full speed.
const RING_ONSET: f32 = 0.1;

/// Velocity around a rolling ring that leaves the source at the time of its number and flies as a particle does: forward
/// within it, back around it. Divergence-free, of the stream function ½·ρ²·e^(−(ρ² + z²)), in radii.
pub fn ring(emitter: &EmitterUniform, position: Vec3, number: f32, later: f32) -> Vec3 {
    let seconds = later + (emitter.ring_phase - number) / emitter.ring_rate;
    if seconds <= 0.0 {
        return Vec3::ZERO;
    }
    let random = birth_random(emitter.ring_first.wrapping_add_signed(number as i32), RING_SALT, emitter.seed);
    let start = Flight { position: emitter.position, velocity: emitter.velocity };
    let pace = pace_at(emitter, emitter.lifetime, seconds);
    let now = paced_flight(emitter, &start, &pace);
    let axis = (now.velocity.normalize_or(emitter.up) + unit_sphere(random) * RING_SPREAD).normalize();
    let born_radius = emitter.ring_size * (1.0 + RING_SPREAD * (2.0 * random.x - 1.0));
    let radius = born_radius + RING_GROWTH * (now.position - emitter.position).length();
    // The circulation stays as it is.
    let hold = smoothstep_unit(seconds / (RING_ONSET * emitter.lifetime));
    let strength = emitter.ring_speed * (1.0 + RING_SPREAD * (2.0 * random.z - 1.0)) * hold * born_radius / radius;
    let from_middle = (position - now.position) / radius;
    let along = from_middle.dot(axis);
    let side = from_middle - axis * along;
    let aside = side.dot(side);
    (axis * (1.0 - aside) + side * along) * ((-aside - along * along).exp() * strength)
}

/// Velocity of the two rings between which a particle was born; `born` is the number of its birth among them.
pub fn rings(emitter: &EmitterUniform, position: Vec3, born: f32, later: f32) -> Vec3 {
    let last = born.floor();
    let fraction = born - last;
    // Full for half of the way to either, and continuous where another pair begins.
    ring(emitter, position, last, later) * smoothstep_unit(2.0 - 2.0 * fraction)
        + ring(emitter, position, last + 1.0, later) * smoothstep_unit(2.0 * fraction)
}

/// The part of a surface that is nearest to smoke which flows around it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wall {
    /// Towards the smoke, of unit length.
    pub normal: Vec3,
    /// Of the smoke from the surface, metres; below 0 behind it.
    pub distance: f32,
    /// From the point that smoke flows away from, to the smoke.
    pub from_middle: Vec3,
}

/// The floor, along which smoke flows away from the source.
pub fn floor_wall(emitter: &EmitterUniform, position: Vec3) -> Wall {
    Wall {
        normal: emitter.up,
        distance: position.dot(emitter.up) - emitter.floor,
        from_middle: position - emitter.position,
    }
}

/// The surface of the obstacle: a box whose edges are rounded, so that smoke turns gradually.
pub fn obstacle_wall(emitter: &EmitterUniform, position: Vec3) -> Wall {
    let from_middle = position - emitter.obstacle;
    let beyond = from_middle.abs() - emitter.obstacle_core;
    let outside = beyond.max(Vec3::ZERO);
    let away = outside.length();
    // Deep inside, smoke rises.
    let mut normal = emitter.up;
    let mut distance = beyond.max_element();
    if away > 0.0 {
        normal = from_middle.signum() * outside / away;
        distance = away;
    }
    Wall { normal, distance: distance - emitter.obstacle_rounding, from_middle }
}

/// Velocity that turns smoke aside from a wall within a margin: what flows towards the wall flows along it, and what is behind
/// it comes out. `velocity`: that of the smoke. `seconds`: from one step to the next.
pub fn turned_aside(wall: &Wall, margin: f32, velocity: Vec3, seconds: f32) -> Vec3 {
    let near = smoothstep_unit(1.0 - wall.distance / margin);
    let towards = (-velocity.dot(wall.normal)).max(0.0) * near;
    let side = wall.from_middle - wall.normal * wall.from_middle.dot(wall.normal);
    // Nowhere in particular at the middle, and slower where it has spread.
    let away = side * (2.0 * margin / (side.dot(side) + margin * margin));
    (wall.normal + away) * towards + wall.normal * ((-wall.distance).max(0.0) * 0.5 / seconds)
}

/// A particle between its birth and its death.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flying {
    /// At birth.
    pub start: Flight,
    /// Seconds from birth to death.
    pub lifetime: f32,
    /// Seconds from birth to now.
    pub seconds: f32,
}

/// Steps of the way through the flow, over a life.
pub const FLOW_STEPS: u32 = 32;
/// Fraction of the life over which the swirls take hold: smoke leaves the source smooth and breaks up later.
const SWIRL_ONSET: f32 = 0.15;

/// Way of a particle through the flow, from the beginning of a step to its end: where it has been carried to, and the
/// velocity there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FlowStep {
    /// Number of the step from 1; 0 before the first.
    pub number: u32,
    /// At the beginning.
    pub moved: Flight,
    /// At the end.
    pub next: Flight,
}

/// Velocity of the flow at the beginning of a step, from 0, for a particle that it has carried by `offset`.
pub fn flow_at_step(emitter: &EmitterUniform, flying: &Flying, number: u32, offset: Vec3) -> Vec3 {
    let age = number as f32 / FLOW_STEPS as f32;
    let seconds = age * flying.lifetime;
    let later = seconds - flying.seconds;
    let pace = pace_at(emitter, flying.lifetime, seconds);
    let path = paced_flight(emitter, &flying.start, &pace);
    let position = path.position + offset;
    let mut velocity = Vec3::ZERO;
    // Swirls do not hold at birth.
    if emitter.swirl_strength > 0.0 && number > 0 {
        velocity += swirl(emitter, position, later) * smoothstep_unit(age / SWIRL_ONSET);
    }
    if emitter.ring_speed != 0.0 {
        let born = emitter.ring_phase - flying.seconds * emitter.ring_rate;
        velocity += rings(emitter, position, born, later);
    }
    velocity += emitter.wind_shear * (position - emitter.position).dot(emitter.up).max(0.0);
    let to_attractor = emitter.attractor - position;
    let distance = (to_attractor.dot(to_attractor) + emitter.attractor_size * emitter.attractor_size).sqrt();
    velocity += to_attractor * (emitter.attraction / distance);
    velocity *= pace.speed;
    let step = flying.lifetime / FLOW_STEPS as f32;
    if emitter.floor_margin > 0.0 {
        let wall = floor_wall(emitter, position);
        velocity += turned_aside(&wall, emitter.floor_margin, path.velocity + velocity, step);
    }
    if emitter.obstacle_margin > 0.0 {
        let wall = obstacle_wall(emitter, position);
        velocity += turned_aside(&wall, emitter.obstacle_margin, path.velocity + velocity, step);
    }
    velocity
}

/// Goes on to step `number` of the way through the flow: the integral of its velocity along the path. (Adams and Bashforth,
/// second order)
pub fn advance_flow_step(emitter: &EmitterUniform, flying: &Flying, last: FlowStep, number: u32) -> FlowStep {
    let step = flying.lifetime / FLOW_STEPS as f32;
    let moved = last.next;
    let position = moved.position + (moved.velocity * 1.5 - last.moved.velocity * 0.5) * step;
    let velocity = flow_at_step(emitter, flying, number, position);
    FlowStep { number, moved, next: Flight { position, velocity } }
}

/// Way and velocity that the flow adds to the flight of a particle, in steps that begin at its birth, with a cubic within
/// each. `reached` is the step of an earlier time, or a default one; it is left at that of now.
pub fn carried_by_flow(emitter: &EmitterUniform, flying: &Flying, reached: &mut FlowStep) -> Flight {
    if emitter.has_flow == 0 {
        return Flight::default();
    }
    let step = flying.lifetime / FLOW_STEPS as f32;
    let steps = flying.seconds / step;
    let number = (steps as u32).min(FLOW_STEPS - 1) + 1;
    if reached.number > number || reached.number == 0 {
        let velocity = flow_at_step(emitter, flying, 0, Vec3::ZERO);
        // As if it had flowed alike before.
        let birth = Flight { position: Vec3::ZERO, velocity };
        *reached = FlowStep { number: 0, moved: birth, next: birth };
    }
    for i in reached.number + 1..=number {
        *reached = advance_flow_step(emitter, flying, *reached, i);
    }
    let FlowStep { moved, next, .. } = *reached;
    let x = steps - (number - 1) as f32;
    let rest = 1.0 - x;
    let slope = (next.position - moved.position) / step;
    Flight {
        position: moved.position.lerp(next.position, x * x * (3.0 - 2.0 * x))
            + (moved.velocity * rest - next.velocity * x) * (x * rest * step),
        velocity: slope * (6.0 * x * rest)
            + moved.velocity * (rest * (1.0 - 3.0 * x))
            + next.velocity * (x * (3.0 * x - 2.0)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emitter::Emitter;

    /// Rings about a source at the origin, which rise along y.
    fn emitter() -> EmitterUniform {
        let emitter =
            Emitter { ring_speed: 2.0, ring_size: 0.5, velocity: Vec3::Y, turbulence: 0.0, ..Emitter::default() };
        emitter.snapshot(20.3).uniform
    }

    fn points(count: u32) -> impl Iterator<Item = Vec3> {
        (0..count).map(|i| (birth_random(i, 0, 1) - 0.5) * Vec3::new(4.0, 12.0, 4.0) + Vec3::Y * 5.0)
    }

    #[test]
    fn rings_are_divergence_free() {
        let emitter = emitter();
        let h = 1.0 / 256.0;
        for p in points(2000) {
            let at = |p: Vec3| ring(&emitter, p, -2.0, 0.0);
            let slope = |axis: Vec3| (at(p + axis * h) - at(p - axis * h)).dot(axis) / (2.0 * h);
            let divergence: f32 = Vec3::AXES.into_iter().map(slope).sum();
            assert!(divergence.abs() < 2.0e-3, "{p}: {divergence}");
        }
    }

    #[test]
    fn rings_are_continuous_where_another_pair_begins() {
        let emitter = emitter();
        for p in points(200) {
            for born in [-3.0, -2.5, -1.0] {
                let before = rings(&emitter, p, born - 1.0e-4, 0.0);
                let after = rings(&emitter, p, born + 1.0e-4, 0.0);
                assert!(before.distance(after) < 1.0e-3, "{p}: {before} {after}");
            }
        }
    }

    #[test]
    fn smoke_rises_within_a_ring_and_sinks_around_it() {
        let emitter = emitter();
        let number = -2.0;
        let seconds = (emitter.ring_phase - number) / emitter.ring_rate;
        let start = Flight { position: emitter.position, velocity: emitter.velocity };
        let middle = paced_flight(&emitter, &start, &pace_at(&emitter, emitter.lifetime, seconds)).position;
        assert!(ring(&emitter, middle, number, 0.0).y > 0.4);
        let radius = 0.5 + RING_GROWTH * middle.length();
        let around = ring(&emitter, middle + Vec3::X * 1.5 * radius, number, 0.0);
        assert!(around.y < -0.05, "{around}");
        // Not before it has left the source.
        assert_eq!(ring(&emitter, middle, number, -seconds - 0.01), Vec3::ZERO);
    }
}
