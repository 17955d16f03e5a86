//! Particles of an emitter, each a closed-form function of seed, birth and time. WGSL: `shaders/lib/emitter.wgsl`.

use glam::{UVec3, Vec2, Vec3, Vec3Swizzles, Vec4};

use super::curve::{curve_integral, curve_value};
use super::gradient_noise::curl_noise;
use super::hash::{pcg3d, unit};
use super::saturate;
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
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flight {
    /// World space, metres.
    pub position: Vec3,
    /// Metres per second.
    pub velocity: Vec3,
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
    let moved = bouncing_flight(emitter, emitter.position + offset, velocity, flown);
    let base = moved.position;

    // Swirls grow with age: smoke leaves the source smooth and breaks up later.
    let seed = emitter.seed.wrapping_mul(977);
    let large = curl_noise(base / emitter.turbulence_scale, emitter.phase, seed);
    let small = curl_noise(base * (2.3 / emitter.turbulence_scale), emitter.phase, seed.wrapping_add(5));
    let swirl = (large + small * 0.4) * emitter.turbulence;
    // Grows with the square root of age, like diffusion.
    let mean_radius = size * (emitter.radius_start + (emitter.radius_end - emitter.radius_start) * age.sqrt());
    let radius = mean_radius * (1.0 + emitter.radius_spread * (2.0 * look.x - 1.0));
    let position = base + swirl * age + emitter.up * (emitter.anchor * radius);
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
        // Of a swirl that grows, too.
        velocity: moved.velocity * speed + swirl / lifetime,
        tint_heat: unorm8(emitter.tint.lerp(emitter.other_tint, color.x).extend(1.0 - emitter.heat_spread * color.y)),
    }
}

/// WGSL's `pack4x8unorm()`.
fn unorm8(value: Vec4) -> [u8; 4] {
    value.to_array().map(|value| (saturate(value) * 255.0 + 0.5) as u8)
}
