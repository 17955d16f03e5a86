// Particles of an emitter, each a function of seed, birth index and time.

#import "lib/flow.wgsl"

// A particle, in the layout of the instance buffer.
struct EmittedParticle {
    position_radius: vec4f,
    rotation_amount_frame_age: vec4f,
    velocity: vec3f,
    // pack4x8unorm() of tint and heat.
    tint_heat: u32,
}

// Returns the birth position of a particle, relative to the center of the shape.
fn birth_offset(emitter: Emitter, random: vec3f) -> vec3f {
    switch emitter.shape {
        case EMITTER_SHAPE_BOX: {
            return (random * 2.0 - 1.0) * emitter.extent;
        }
        case EMITTER_SHAPE_DISC: {
            let angle = random.y * TURN;
            let level = vec2f(cos(angle), sin(angle)) * sqrt(random.z) * emitter.extent.xz;
            return emitter.disc_x * level.x + emitter.disc_z * level.y;
        }
        default: {
            return unit_sphere(random) * emitter.extent * pow(random.x, 1.0 / 3.0);
        }
    }
}

// Seconds from the interval of the first birth to that of another.
fn birth_delay(emitter: Emitter, number: u32) -> f32 {
    let position = emitter.first_in_pulse + number;
    let pulse = position / emitter.per_pulse;
    let in_pulse = position - pulse * emitter.per_pulse;
    return f32(pulse) * emitter.period + f32(i32(in_pulse) - i32(emitter.first_in_pulse)) / emitter.rate;
}

// 2^32 over the golden ratio: multiples of it are spread evenly.
const GOLDEN: u32 = 2654435769u;

// True if a birth happens. Those that do are spread evenly among all.
fn is_born(emitter: Emitter, number: u32) -> bool {
    let in_pulse = (emitter.first_in_pulse + number) % emitter.per_pulse;
    let fraction = curve_value(emitter.rate_curve, (f32(in_pulse) + 0.5) / f32(emitter.per_pulse));
    return unit((emitter.first + number) * GOLDEN) < fraction;
}

// Returns the rotation at birth, radians: any at a spread of 1, about upright at small ones.
fn rotation_at_birth(spread: f32, random: f32) -> f32 {
    return TURN * spread * (random - 0.5 * (1.0 - spread));
}

// Returns the particle of a birth, counted from the first; its amount is 0 if it is not alive.
fn emitted_particle(emitter: Emitter, number: u32) -> EmittedParticle {
    let index = emitter.first + number;
    let life = birth_random(index, 0u, emitter.seed);
    let random_offset = birth_random(index, 1u, emitter.seed);
    let motion = birth_random(index, 2u, emitter.seed);
    let look = birth_random(index, 3u, emitter.seed);
    let color = birth_random(index, 4u, emitter.seed);
    // Births are jittered within their interval, or a fast emitter would pulse.
    let seconds = emitter.since_first - birth_delay(emitter, number) - life.y / emitter.rate;
    let lifetime = emitter.lifetime * (1.0 + emitter.lifetime_spread * (2.0 * life.x - 1.0));
    if !(seconds >= 0.0 && seconds < lifetime) || (emitter.has_rate_curve != 0u && !is_born(emitter, number)) {
        return EmittedParticle();
    }
    let age = seconds / lifetime;

    let offset = birth_offset(emitter, random_offset);
    let distance = length(offset);
    let outward = select(vec3f(0.0), offset / distance, distance > 0.0);
    let velocity = emitter.velocity + outward * emitter.burst + unit_sphere(motion) * (emitter.velocity_spread * life.z);
    var size = select(1.0, emitter.small_size, color.z < emitter.small_fraction);
    var fraction = 1.0;
    if emitter.has_curves != 0u {
        size *= curve_value(emitter.size_curve, age);
        fraction = curve_value(emitter.amount_curve, age);
    }
    let start = Flight(emitter.position + offset, velocity);
    let moved = paced_flight(emitter, start, pace_at(emitter, lifetime, seconds));
    let carried = carried_by_flow(emitter, Flying(start, lifetime, seconds));

    // Growth like diffusion: fast at first.
    let mean_radius = size * (emitter.radius_start + (emitter.radius_end - emitter.radius_start) * sqrt(age));
    let radius = mean_radius * (1.0 + emitter.radius_spread * (2.0 * look.x - 1.0));
    let position = moved.position + carried.position + emitter.up * (emitter.anchor * radius);
    let fade_in = smoothstep_unit(age / max(emitter.fade_in, 1.0e-4));
    // Drag slows the spin.
    let turned = drag_integrals(emitter.drag, seconds).x;
    let fade_out = smoothstep_unit((1.0 - age) / max(emitter.fade_out, 1.0e-4));
    return EmittedParticle(
        vec4f(position, radius),
        vec4f(
            rotation_at_birth(emitter.rotation_spread, look.y) + emitter.spin * (2.0 * look.z - 1.0) * turned,
            emitter.amount * fraction * fade_in * fade_out,
            random_offset.x * 256.0 + seconds * emitter.frame_rate,
            age,
        ),
        moved.velocity + carried.velocity,
        pack4x8unorm(vec4f(mix(emitter.tint, emitter.other_tint, color.x), 1.0 - emitter.heat_spread * color.y)),
    );
}
