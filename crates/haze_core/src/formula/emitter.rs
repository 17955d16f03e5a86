//! Particles of an emitter, each a function of seed, birth and time alone. WGSL: `shaders/lib/emitter.wgsl`.

use glam::{Vec2, Vec3, Vec3Swizzles, Vec4};

use super::curve::{curve_value, smoothstep_unit};
use super::flight::{Flight, drag_integrals, pace_at, paced_flight};
use super::flow::{FlowStep, Flying, carried_by_flow};
use super::hash::{birth_random, unit, unit_sphere};
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

/// Seconds from the interval of the first birth to that of another.
pub fn birth_delay(emitter: &EmitterUniform, number: u32) -> f32 {
    let position = emitter.first_in_pulse + number;
    let pulse = position / emitter.per_pulse;
    let in_pulse = position % emitter.per_pulse;
    let births = i64::from(in_pulse) - i64::from(emitter.first_in_pulse);
    pulse as f32 * emitter.period + births as f32 / emitter.rate
}

/// 2^32 over the golden ratio: multiples of it are spread evenly.
const GOLDEN: u32 = 2_654_435_769;

/// True if a birth happens. Those that do are spread evenly among all.
pub fn is_born(emitter: &EmitterUniform, number: u32) -> bool {
    let in_pulse = (emitter.first_in_pulse + number) % emitter.per_pulse;
    let fraction = curve_value(&emitter.rate_curve, (in_pulse as f32 + 0.5) / emitter.per_pulse as f32);
    unit(emitter.first.wrapping_add(number).wrapping_mul(GOLDEN)) < fraction
}

/// Rotation at birth, radians: any at a spread of 1, about upright at small ones.
pub fn rotation_at_birth(spread: f32, random: f32) -> f32 {
    std::f32::consts::TAU * spread * (random - 0.5 * (1.0 - spread))
}

/// Particle of birth `number`, counted from the emitter's first. Its amount is 0 if it is not alive.
pub fn emitted_particle(emitter: &EmitterUniform, number: u32) -> EmittedParticle {
    emitted_particle_on(emitter, number, &mut FlowStep::default())
}

/// [`emitted_particle`] that goes on from the step of its way through the flow that it has reached at an earlier time.
pub fn emitted_particle_on(emitter: &EmitterUniform, number: u32, reached: &mut FlowStep) -> EmittedParticle {
    let index = emitter.first.wrapping_add(number);
    let random = |salt| birth_random(index, salt, emitter.seed);
    let life = random(0);
    let random_offset = random(1);
    let motion = random(2);
    let look = random(3);
    let color = random(4);
    // Births are jittered within their interval. Without that a fast emitter would pulse.
    let seconds = emitter.since_first - birth_delay(emitter, number) - life.y / emitter.rate;
    let lifetime = emitter.lifetime * (1.0 + emitter.lifetime_spread * (2.0 * life.x - 1.0));
    if !(0.0..lifetime).contains(&seconds) || emitter.has_rate_curve != 0 && !is_born(emitter, number) {
        return EmittedParticle::default();
    }
    let age = seconds / lifetime;

    let offset = birth_offset(emitter, random_offset);
    let velocity = emitter.velocity
        + offset.normalize_or_zero() * emitter.burst
        + unit_sphere(motion) * (emitter.velocity_spread * life.z);
    let mut size = if color.z < emitter.small_fraction { emitter.small_size } else { 1.0 };
    let mut fraction = 1.0;
    if emitter.has_curves != 0 {
        size *= curve_value(&emitter.size_curve, age);
        fraction = curve_value(&emitter.amount_curve, age);
    }
    let start = Flight { position: emitter.position + offset, velocity };
    let moved = paced_flight(emitter, &start, &pace_at(emitter, lifetime, seconds));
    let carried = carried_by_flow(emitter, &Flying { start, lifetime, seconds }, reached);

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
            emitter.amount * fraction * fade_in * fade_out,
            random_offset.x * 256.0 + seconds * emitter.frame_rate,
            age,
        ),
        velocity: moved.velocity + carried.velocity,
        tint_heat: unorm8(emitter.tint.lerp(emitter.other_tint, color.x).extend(1.0 - emitter.heat_spread * color.y)),
    }
}

/// WGSL's `pack4x8unorm()`.
fn unorm8(value: Vec4) -> [u8; 4] {
    value.to_array().map(|value| (saturate(value) * 255.0 + 0.5) as u8)
}
