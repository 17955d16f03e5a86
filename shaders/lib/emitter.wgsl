// Particles of an emitter, each a function of seed, birth index and time.

#import "lib/curve.wgsl"
#import "lib/gradient_noise.wgsl"

// An emitter at a time. Mirrors EmitterUniform in crates/haze_core/src/formula/uniforms.rs; crates/haze_core/src/emitter.rs documents the settings.
struct Emitter {
    // Lower 32 bits of the index of the first birth that may be alive, and the number of births from there on.
    first: u32,
    count: u32,
    seed: u32,
    // One of the EMITTER_SHAPE constants.
    shape: u32,
    // Seconds since the interval of the first birth began, which needs fewer digits than the time itself.
    since_first: f32,
    rate: f32,
    lifetime: f32,
    lifetime_spread: f32,
    position: vec3f,
    burst: f32,
    extent: vec3f,
    velocity_spread: f32,
    velocity: vec3f,
    drag: f32,
    // Acceleration by buoyancy.
    rise: vec3f,
    turbulence: f32,
    wind: vec3f,
    turbulence_scale: f32,
    // Axes of the disc.
    disc_x: vec3f,
    radius_start: f32,
    disc_z: vec3f,
    radius_end: f32,
    // Phase of the turbulence: (cos, sin).
    phase: vec2f,
    radius_spread: f32,
    spin: f32,
    amount: f32,
    fade_in: f32,
    fade_out: f32,
    frame_rate: f32,
    // Colors between which those of the particles lie.
    tint: vec3f,
    heat_spread: f32,
    other_tint: vec3f,
    // Share of the speed that a particle keeps on the floor; 0 for no floor.
    bounce: f32,
    up: vec3f,
    // Height along `up`, world space.
    floor: f32,
    // Births per pulse, index of the first birth within its pulse, and seconds from pulse to pulse.
    per_pulse: u32,
    first_in_pulse: u32,
    period: f32,
    // 0 if all curves are 1 at every age.
    has_curves: u32,
    speed_curve: Curve,
    size_curve: Curve,
    amount_curve: Curve,
    // Share of the births that happen, over a pulse.
    rate_curve: Curve,
    // Share of the radius by which a particle is moved up.
    anchor: f32,
    // Share of a turn.
    rotation_spread: f32,
    // 0 if all births happen.
    has_rate_curve: u32,
}

const EMITTER_SHAPE_SPHERE: u32 = 0u;
const EMITTER_SHAPE_BOX: u32 = 1u;
const EMITTER_SHAPE_DISC: u32 = 2u;

const TURN: f32 = 6.283185307179586;

// A particle, in the layout of the instance buffer.
struct EmittedParticle {
    position_radius: vec4f,
    rotation_amount_frame_age: vec4f,
    velocity: vec3f,
    // pack4x8unorm() of tint and heat.
    tint_heat: u32,
}

// Returns a uniformly distributed direction. Uses y and z, so that x is free for a distance.
fn unit_sphere(random: vec3f) -> vec3f {
    let z = random.z * 2.0 - 1.0;
    let angle = random.y * TURN;
    let level = vec2f(cos(angle), sin(angle)) * sqrt(1.0 - z * z);
    return vec3f(level.x, z, level.y);
}

// ∫ e^(−k·s) ds and ∫∫ e^(−k·s) ds over 0..t: the factors of a velocity and of an acceleration under drag k.
fn drag_integrals(drag: f32, t: f32) -> vec2f {
    let x = drag * t;
    if x < 0.5 {
        // The closed forms cancel near 0; this part of their series is exact to f32 here.
        let reached = 1.0 - x / 2.0 * (1.0 - x / 3.0 * (1.0 - x / 4.0 * (1.0 - x / 5.0 * (1.0 - x / 6.0 * (1.0 - x / 7.0)))));
        let approached = 1.0 - x / 3.0 * (1.0 - x / 4.0 * (1.0 - x / 5.0 * (1.0 - x / 6.0 * (1.0 - x / 7.0 * (1.0 - x / 8.0)))));
        return vec2f(t * reached, 0.5 * t * t * approached);
    }
    let reached = (1.0 - exp(-x)) / drag;
    return vec2f(reached, (t - reached) / drag);
}

// Smoothstep: 0..1 with slope 0 at both ends.
fn smoothstep_unit(x: f32) -> f32 {
    let s = saturate(x);
    return s * s * (3.0 - 2.0 * s);
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

// Position and velocity at a time.
struct Flight {
    position: vec3f,
    velocity: vec3f,
}

// Solution of v' = drag·(wind − v) + buoyancy: position and velocity approach their limits as 1 − e^(−drag·t).
fn flight(emitter: Emitter, start: vec3f, velocity: vec3f, seconds: f32) -> Flight {
    let integrals = drag_integrals(emitter.drag, seconds);
    let reached = integrals.x;
    let kept = 1.0 - emitter.drag * reached;
    return Flight(
        start + velocity * reached + emitter.wind * (seconds - reached) + emitter.rise * integrals.y,
        velocity * kept + emitter.wind * (1.0 - kept) + emitter.rise * reached,
    );
}

// After so many bounces a particle lies still.
const MAX_BOUNCES: u32 = 3u;
const IMPACT_STEPS: u32 = 20u;

// Flight that bounces off the floor.
fn bouncing_flight(emitter: Emitter, start: vec3f, velocity: vec3f, seconds: f32) -> Flight {
    var now = flight(emitter, start, velocity, seconds);
    if emitter.bounce <= 0.0 {
        return now;
    }
    var last = Flight(start, velocity);
    var left = seconds;
    for (var i = 0u; i < MAX_BOUNCES && dot(now.position, emitter.up) < emitter.floor; i++) {
        // The last time above the floor.
        var above = 0.0;
        var below = left;
        for (var step = 0u; step < IMPACT_STEPS; step++) {
            let middle = 0.5 * (above + below);
            let place = flight(emitter, last.position, last.velocity, middle).position;
            if dot(place, emitter.up) < emitter.floor {
                below = middle;
            } else {
                above = middle;
            }
        }
        let impact = flight(emitter, last.position, last.velocity, above);
        let reflected = impact.velocity - emitter.up * (2.0 * dot(impact.velocity, emitter.up));
        last = Flight(impact.position, reflected * emitter.bounce);
        left -= above;
        now = flight(emitter, last.position, last.velocity, left);
    }
    if dot(now.position, emitter.up) < emitter.floor {
        return Flight(last.position, vec3f(0.0));
    }
    return now;
}

// Seconds from the interval of the first birth to that of another.
fn birth_delay(emitter: Emitter, number: u32) -> f32 {
    let place = emitter.first_in_pulse + number;
    let pulse = place / emitter.per_pulse;
    let in_pulse = place - pulse * emitter.per_pulse;
    return f32(pulse) * emitter.period + f32(i32(in_pulse) - i32(emitter.first_in_pulse)) / emitter.rate;
}

// 2^32 over the golden ratio: multiples of it are spread evenly.
const GOLDEN: u32 = 2654435769u;

// True if a birth happens. Those that do are spread evenly among all.
fn is_born(emitter: Emitter, number: u32) -> bool {
    let in_pulse = (emitter.first_in_pulse + number) % emitter.per_pulse;
    let share = curve_value(emitter.rate_curve, (f32(in_pulse) + 0.5) / f32(emitter.per_pulse));
    return unit((emitter.first + number) * GOLDEN) < share;
}

// Returns three random numbers, 0..1, for a birth and a salt.
fn birth_random(index: u32, salt: u32, seed: u32) -> vec3f {
    let hash = pcg3d(vec3u(index, salt, seed));
    return vec3f(unit(hash.x), unit(hash.y), unit(hash.z));
}

// Returns the rotation at birth, radians: any at a spread of 1, about upright at small ones.
fn rotation_at_birth(spread: f32, random: f32) -> f32 {
    return TURN * spread * (random - 0.5 * (1.0 - spread));
}

// Returns the particle of a birth, counted from the first; its amount is 0 if it is not alive.
fn emitted_particle(emitter: Emitter, number: u32) -> EmittedParticle {
    let index = emitter.first + number;
    let life = birth_random(index, 0u, emitter.seed);
    let place = birth_random(index, 1u, emitter.seed);
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

    let offset = birth_offset(emitter, place);
    let distance = length(offset);
    let outward = select(vec3f(0.0), offset / distance, distance > 0.0);
    let velocity = emitter.velocity + outward * emitter.burst + unit_sphere(motion) * (emitter.velocity_spread * life.z);
    // Values of the curves, and the time in which a particle flies as far at speed 1.
    var speed = 1.0;
    var size = 1.0;
    var share = 1.0;
    var flown = seconds;
    if emitter.has_curves != 0u {
        speed = curve_value(emitter.speed_curve, age);
        size = curve_value(emitter.size_curve, age);
        share = curve_value(emitter.amount_curve, age);
        flown = lifetime * curve_integral(emitter.speed_curve, age);
    }
    let moved = bouncing_flight(emitter, emitter.position + offset, velocity, flown);
    let base = moved.position;

    // Turbulence grows with age: smoke leaves the source smoothly and breaks up later.
    let large = curl_noise(base / emitter.turbulence_scale, emitter.phase, emitter.seed * 977u);
    let small = curl_noise(base * (2.3 / emitter.turbulence_scale), emitter.phase, emitter.seed * 977u + 5u);
    let swirl = (large + small * 0.4) * emitter.turbulence;
    // Growth like diffusion: fast at first.
    let mean_radius = size * (emitter.radius_start + (emitter.radius_end - emitter.radius_start) * sqrt(age));
    let radius = mean_radius * (1.0 + emitter.radius_spread * (2.0 * look.x - 1.0));
    let position = base + swirl * age + emitter.up * (emitter.anchor * radius);
    let fade_in = smoothstep_unit(age / max(emitter.fade_in, 1.0e-4));
    // Drag slows the spin.
    let turned = drag_integrals(emitter.drag, seconds).x;
    let fade_out = smoothstep_unit((1.0 - age) / max(emitter.fade_out, 1.0e-4));
    return EmittedParticle(
        vec4f(position, radius),
        vec4f(
            rotation_at_birth(emitter.rotation_spread, look.y) + emitter.spin * (2.0 * look.z - 1.0) * turned,
            emitter.amount * share * fade_in * fade_out,
            place.x * 256.0 + seconds * emitter.frame_rate,
            age,
        ),
        // Of a swirl that grows, too.
        moved.velocity * speed + swirl / lifetime,
        pack4x8unorm(vec4f(mix(emitter.tint, emitter.other_tint, color.x), 1.0 - emitter.heat_spread * color.y)),
    );
}
