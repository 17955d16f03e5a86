//! Particles of an emitter, each a function of seed, birth and time alone. WGSL: `shaders/lib/emitter.wgsl`.

use glam::{UVec3, Vec2, Vec3, Vec3Swizzles, Vec4};

use super::curve::{curve_integral, curve_value};
use super::hash::{pcg3d, unit};
use super::saturate;
use super::swirl_noise::{skewed, swirl_noise};
use super::uniforms::EmitterUniform;

/// Numbers of the birth shapes. Any other number is a sphere.
const EMITTER_SHAPE_BOX: u32 = 1;
const EMITTER_SHAPE_DISC: u32 = 2;

/// Particle in the layout of the instance buffer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[allow(missing_docs, reason = "documented in WGSL")]
pub struct EmittedParticle {
    pub position_radius: Vec4,
    pub rotation_amount_frame_age: Vec4,
    pub velocity: Vec3,
    pub tint_heat: [u8; 4],
}

/// Uniformly distributed direction. Uses y and z only, so that x is free for a distance.
pub fn unit_sphere(random: Vec3) -> Vec3 {
    let z = random.z * 2.0 - 1.0;
    let xy = Vec2::from_angle(random.y * std::f32::consts::TAU) * (1.0 - z * z).sqrt();
    Vec3::new(xy.x, z, xy.y)
}

/// ∫ e^(−k·s) ds and ∫∫ e^(−k·s) ds over 0..t: the displacement under drag k, per unit of initial velocity and per unit
/// of constant acceleration.
pub fn drag_integrals(drag: f32, t: f32) -> Vec2 {
    let x = drag * t;
    if x < 0.5 {
        // The closed forms cancel near 0. This many terms of their series are exact to f32 here.
        let series = |terms: [f32; 6]| terms.into_iter().rev().fold(1.0, |sum, term| 1.0 - x / term * sum);
        let (reached, approached) = (series([2.0, 3.0, 4.0, 5.0, 6.0, 7.0]), series([3.0, 4.0, 5.0, 6.0, 7.0, 8.0]));
        return Vec2::new(t * reached, 0.5 * t * t * approached);
    }
    let reached = (1.0 - (-x).exp()) / drag;
    Vec2::new(reached, (t - reached) / drag)
}

/// Smoothstep: 0..1 with zero slope at both ends.
pub fn smoothstep_unit(x: f32) -> f32 {
    let s = x.clamp(0.0, 1.0);
    s * s * (3.0 - 2.0 * s)
}

/// Birth position relative to the center of the shape, metres.
pub fn birth_offset(emitter: &EmitterUniform, random: Vec3) -> Vec3 {
    match emitter.shape {
        EMITTER_SHAPE_BOX => (random * 2.0 - 1.0) * emitter.extent,
        EMITTER_SHAPE_DISC => {
            let direction = Vec2::from_angle(random.y * std::f32::consts::TAU) * random.z.sqrt();
            let level = direction * emitter.extent.xz();
            emitter.disc_x * level.x + emitter.disc_z * level.y
        }
        _ => unit_sphere(random) * emitter.extent * random.x.cbrt(),
    }
}

/// Position and velocity at a time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Flight {
    /// World space, metres.
    pub position: Vec3,
    /// Metres per second.
    pub velocity: Vec3,
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

/// Solution of v' = drag·(wind − v) + buoyancy: position and velocity approach their limits as 1 − e^(−drag·t).
pub fn flight(emitter: &EmitterUniform, start: Vec3, velocity: Vec3, seconds: f32) -> Flight {
    let Vec2 { x: reached, y: approached } = drag_integrals(emitter.drag, seconds);
    let kept = 1.0 - emitter.drag * reached;
    Flight {
        position: start + velocity * reached + emitter.wind * (seconds - reached) + emitter.rise * approached,
        velocity: velocity * kept + emitter.wind * (1.0 - kept) + emitter.rise * reached,
    }
}

/// After so many bounces a particle lies still.
const MAX_BOUNCES: u32 = 3;
const IMPACT_STEPS: u32 = 20;

/// Flight that bounces off the floor.
pub fn bouncing_flight(emitter: &EmitterUniform, start: Vec3, velocity: Vec3, seconds: f32) -> Flight {
    let mut now = flight(emitter, start, velocity, seconds);
    if emitter.bounce <= 0.0 {
        return now;
    }
    let is_below = |position: Vec3| position.dot(emitter.up) < emitter.floor;
    let (mut last, mut left) = (Flight { position: start, velocity }, seconds);
    for _ in 0..MAX_BOUNCES {
        if !is_below(now.position) {
            return now;
        }
        // The last time above the floor.
        let (mut above, mut below) = (0.0, left);
        for _ in 0..IMPACT_STEPS {
            let middle = 0.5 * (above + below);
            match is_below(flight(emitter, last.position, last.velocity, middle).position) {
                true => below = middle,
                false => above = middle,
            }
        }
        let impact = flight(emitter, last.position, last.velocity, above);
        let reflected = impact.velocity - emitter.up * (2.0 * impact.velocity.dot(emitter.up));
        last = Flight { position: impact.position, velocity: reflected * emitter.bounce };
        left -= above;
        now = flight(emitter, last.position, last.velocity, left);
    }
    if is_below(now.position) { Flight { velocity: Vec3::ZERO, ..last } } else { now }
}

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

/// Steps of the way through the swirls, over a life.
const SWIRL_STEPS: u32 = 32;
/// Share of the life over which the swirls take hold: smoke leaves the source smooth and breaks up later.
const SWIRL_ONSET: f32 = 0.15;

/// Way of a particle through the swirls, from the beginning of a step to its end: where they have moved it to, and their
/// velocity there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SwirlStep {
    /// Number of the step, 0 at birth.
    pub number: u32,
    /// At the beginning.
    pub moved: Flight,
    /// At the end.
    pub next: Flight,
}

/// Velocity of the swirls at the beginning of a step, for a particle of a given age in seconds that they have moved by
/// `offset`.
pub fn swirl_at_step(emitter: &EmitterUniform, flying: &Flying, number: u32, offset: Vec3) -> Vec3 {
    let age = number as f32 / SWIRL_STEPS as f32;
    let mut speed = 1.0;
    let mut flown = age * flying.lifetime;
    if emitter.has_curves != 0 {
        speed = curve_value(&emitter.speed_curve, age);
        flown = flying.lifetime * curve_integral(&emitter.speed_curve, age);
    }
    let path = bouncing_flight(emitter, flying.start.position, flying.start.velocity, flown);
    let hold = smoothstep_unit(age / SWIRL_ONSET);
    swirl(emitter, path.position + offset, age * flying.lifetime - flying.seconds) * (speed * hold)
}

/// Goes on to step `number` of the way through the swirls: the integral of [`swirl`] along the path. (Adams and Bashforth,
/// second order)
pub fn advance_swirl_step(emitter: &EmitterUniform, flying: &Flying, last: SwirlStep, number: u32) -> SwirlStep {
    let step = flying.lifetime / SWIRL_STEPS as f32;
    let moved = last.next;
    let position = moved.position + (moved.velocity * 1.5 - last.moved.velocity * 0.5) * step;
    let velocity = swirl_at_step(emitter, flying, number + 1, position);
    SwirlStep { number, moved, next: Flight { position, velocity } }
}

/// Way and velocity that the swirls add to the flight of a particle, in steps that begin at its birth, with a cubic within
/// each. `reached` is the step of an earlier time, or a default one; it is left at that of now.
pub fn carried_by_swirls(emitter: &EmitterUniform, flying: &Flying, reached: &mut SwirlStep) -> Flight {
    if emitter.swirl_strength <= 0.0 {
        return Flight::default();
    }
    let step = flying.lifetime / SWIRL_STEPS as f32;
    let steps = flying.seconds / step;
    let number = (steps as u32).min(SWIRL_STEPS - 1);
    // Nothing holds at birth, so that the first step ends where it begins.
    if reached.number > number || reached.number == 0 {
        let velocity = swirl_at_step(emitter, flying, 1, Vec3::ZERO);
        *reached = SwirlStep { next: Flight { position: Vec3::ZERO, velocity }, ..SwirlStep::default() };
    }
    for i in reached.number + 1..=number {
        *reached = advance_swirl_step(emitter, flying, *reached, i);
    }
    let SwirlStep { moved, next, .. } = *reached;
    let x = steps - number as f32;
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

/// Seconds from the interval of the first birth to that of another.
pub fn birth_delay(emitter: &EmitterUniform, number: u32) -> f32 {
    let place = emitter.first_in_pulse + number;
    let (pulse, in_pulse) = (place / emitter.per_pulse, place % emitter.per_pulse);
    let births = i64::from(in_pulse) - i64::from(emitter.first_in_pulse);
    pulse as f32 * emitter.period + births as f32 / emitter.rate
}

/// 2^32 over the golden ratio: multiples of it are spread evenly.
const GOLDEN: u32 = 2_654_435_769;

/// True if a birth happens. Those that do are spread evenly among all.
pub fn is_born(emitter: &EmitterUniform, number: u32) -> bool {
    let in_pulse = (emitter.first_in_pulse + number) % emitter.per_pulse;
    let share = curve_value(&emitter.rate_curve, (in_pulse as f32 + 0.5) / emitter.per_pulse as f32);
    unit(emitter.first.wrapping_add(number).wrapping_mul(GOLDEN)) < share
}

/// Three random numbers 0..1 for a birth and a salt.
pub fn birth_random(index: u32, salt: u32, seed: u32) -> Vec3 {
    let hash = pcg3d(UVec3::new(index, salt, seed));
    Vec3::new(unit(hash.x), unit(hash.y), unit(hash.z))
}

/// Rotation at birth, radians: any at a spread of 1, about upright at small ones.
pub fn rotation_at_birth(spread: f32, random: f32) -> f32 {
    std::f32::consts::TAU * spread * (random - 0.5 * (1.0 - spread))
}

/// Particle of birth `number`, counted from the emitter's first. Its amount is 0 if it is not alive.
pub fn emitted_particle(emitter: &EmitterUniform, number: u32) -> EmittedParticle {
    emitted_particle_on(emitter, number, &mut SwirlStep::default())
}

/// [`emitted_particle`] that goes on from the step of its way through the swirls that it has reached at an earlier time.
pub fn emitted_particle_on(emitter: &EmitterUniform, number: u32, reached: &mut SwirlStep) -> EmittedParticle {
    let index = emitter.first.wrapping_add(number);
    let random = |salt| birth_random(index, salt, emitter.seed);
    let (life, place, motion, look, color) = (random(0), random(1), random(2), random(3), random(4));
    // Births are jittered within their interval. Without that a fast emitter would pulse.
    let seconds = emitter.since_first - birth_delay(emitter, number) - life.y / emitter.rate;
    let lifetime = emitter.lifetime * (1.0 + emitter.lifetime_spread * (2.0 * life.x - 1.0));
    if !(0.0..lifetime).contains(&seconds) || emitter.has_rate_curve != 0 && !is_born(emitter, number) {
        return EmittedParticle::default();
    }
    let age = seconds / lifetime;

    let offset = birth_offset(emitter, place);
    let velocity = emitter.velocity
        + offset.normalize_or_zero() * emitter.burst
        + unit_sphere(motion) * (emitter.velocity_spread * life.z);
    // Values of the curves, and the time in which a particle flies as far at speed 1.
    let (mut speed, mut size, mut share, mut flown) = (1.0, 1.0, 1.0, seconds);
    if emitter.has_curves != 0 {
        [speed, size, share] =
            [emitter.speed_curve, emitter.size_curve, emitter.amount_curve].map(|c| curve_value(&c, age));
        flown = lifetime * curve_integral(&emitter.speed_curve, age);
    }
    let start = Flight { position: emitter.position + offset, velocity };
    let moved = bouncing_flight(emitter, start.position, velocity, flown);
    let carried = carried_by_swirls(emitter, &Flying { start, lifetime, seconds }, reached);

    // Grows with the square root of age, like diffusion.
    let mean_radius = size * (emitter.radius_start + (emitter.radius_end - emitter.radius_start) * age.sqrt());
    let radius = mean_radius * (1.0 + emitter.radius_spread * (2.0 * look.x - 1.0));
    let position = moved.position + carried.position + emitter.up * (emitter.anchor * radius);
    let fade_in = smoothstep_unit(age / emitter.fade_in.max(1.0e-4));
    // Drag slows the spin.
    let turned = drag_integrals(emitter.drag, seconds).x;
    let fade_out = smoothstep_unit((1.0 - age) / emitter.fade_out.max(1.0e-4));
    EmittedParticle {
        position_radius: position.extend(radius),
        rotation_amount_frame_age: Vec4::new(
            rotation_at_birth(emitter.rotation_spread, look.y) + emitter.spin * (2.0 * look.z - 1.0) * turned,
            emitter.amount * share * fade_in * fade_out,
            place.x * 256.0 + seconds * emitter.frame_rate,
            age,
        ),
        velocity: moved.velocity * speed + carried.velocity,
        tint_heat: unorm8(emitter.tint.lerp(emitter.other_tint, color.x).extend(1.0 - emitter.heat_spread * color.y)),
    }
}

/// WGSL's `pack4x8unorm()`.
fn unorm8(value: Vec4) -> [u8; 4] {
    value.to_array().map(|value| (saturate(value) * 255.0 + 0.5) as u8)
}
