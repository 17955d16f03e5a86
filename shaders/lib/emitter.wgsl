// Particles of an emitter, each a function of seed, birth index and time.

#import "lib/curve.wgsl"
#import "lib/swirl_noise.wgsl"

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
    // Speed of the largest swirls, meters per second, root mean square along an axis.
    swirl_strength: f32,
    wind: vec3f,
    // Simplices per meter of the largest swirls.
    swirl_frequency: f32,
    // Axes of the disc.
    disc_x: vec3f,
    radius_start: f32,
    disc_z: vec3f,
    radius_end: f32,
    // Angle of the swirls at this time, radians, and how fast it grows, radians per second.
    swirl_turn: f32,
    swirl_turn_rate: f32,
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
    // Strength of each octave of the swirls, as a share of the one before.
    swirl_detail: f32,
    // Velocity of the swirls as a whole.
    swirl_travel: vec3f,
    padding_1: f32,
    // Their way until this time, in simplex coordinates: a part of a simplex, and whole ones.
    swirl_offset: vec3f,
    padding_2: f32,
    swirl_first: vec3i,
    padding_3: f32,
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

// Each octave of the swirls has half the size of the one before.
const SWIRL_OCTAVES: u32 = 3u;

// Velocity of the swirls at a position, at so many seconds after the emitter's time.
fn swirl(emitter: Emitter, position: vec3f, later: f32) -> vec3f {
    let angle = emitter.swirl_turn + emitter.swirl_turn_rate * later;
    let phase = vec2f(cos(angle), sin(angle));
    let in_plume = position - emitter.swirl_travel * later;
    var at = skewed(in_plume * emitter.swirl_frequency) + emitter.swirl_offset;
    var first = emitter.swirl_first;
    var strength = emitter.swirl_strength;
    var sum = vec3f(0.0);
    for (var octave = 0u; octave < SWIRL_OCTAVES; octave++) {
        sum += swirl_noise(at, first, phase, emitter.seed * 977u + octave) * strength;
        at *= 2.0;
        first += first;
        strength *= emitter.swirl_detail;
    }
    return sum;
}

// Steps of the way through the swirls, over a life.
const SWIRL_STEPS: u32 = 32u;
// Share of the life over which the swirls take hold: smoke leaves the source smooth and breaks up later.
const SWIRL_ONSET: f32 = 0.15;

// A particle between its birth and its death.
struct Flying {
    // At birth.
    start: Flight,
    // Seconds from birth to death, and to now.
    lifetime: f32,
    seconds: f32,
}

// Way of a particle through the swirls, from the beginning of a step to its end: where they have moved it to, and their
// velocity there.
struct SwirlStep {
    moved: Flight,
    next: Flight,
}

// Velocity of the swirls at the beginning of a step, for a particle that they have moved by `offset`.
fn swirl_at_step(emitter: Emitter, flying: Flying, number: u32, offset: vec3f) -> vec3f {
    let age = f32(number) / f32(SWIRL_STEPS);
    var speed = 1.0;
    var flown = age * flying.lifetime;
    if emitter.has_curves != 0u {
        speed = curve_value(emitter.speed_curve, age);
        flown = flying.lifetime * curve_integral(emitter.speed_curve, age);
    }
    let path = bouncing_flight(emitter, flying.start.position, flying.start.velocity, flown);
    let hold = smoothstep_unit(age / SWIRL_ONSET);
    return swirl(emitter, path.position + offset, age * flying.lifetime - flying.seconds) * (speed * hold);
}

// Goes on to step `number` of the way through the swirls: the integral of swirl() along the path. (Adams and Bashforth,
// second order)
fn advance_swirl_step(emitter: Emitter, flying: Flying, last: SwirlStep, number: u32) -> SwirlStep {
    let step = flying.lifetime / f32(SWIRL_STEPS);
    let moved = last.next;
    let position = moved.position + (moved.velocity * 1.5 - last.moved.velocity * 0.5) * step;
    let velocity = swirl_at_step(emitter, flying, number + 1u, position);
    return SwirlStep(moved, Flight(position, velocity));
}

// Way and velocity that the swirls add to the flight of a particle, in steps that begin at its birth, with a cubic within
// each.
fn carried_by_swirls(emitter: Emitter, flying: Flying) -> Flight {
    if emitter.swirl_strength <= 0.0 {
        return Flight();
    }
    let step = flying.lifetime / f32(SWIRL_STEPS);
    let steps = flying.seconds / step;
    let number = min(u32(steps), SWIRL_STEPS - 1u);
    // Nothing holds at birth, so that the first step ends where it begins.
    var reached = SwirlStep(Flight(), Flight(vec3f(0.0), swirl_at_step(emitter, flying, 1u, vec3f(0.0))));
    for (var i = 1u; i <= number; i++) {
        reached = advance_swirl_step(emitter, flying, reached, i);
    }
    let moved = reached.moved;
    let next = reached.next;
    let x = steps - f32(number);
    let rest = 1.0 - x;
    let slope = (next.position - moved.position) / step;
    return Flight(
        mix(moved.position, next.position, x * x * (3.0 - 2.0 * x))
            + (moved.velocity * rest - next.velocity * x) * (x * rest * step),
        slope * (6.0 * x * rest) + moved.velocity * (rest * (1.0 - 3.0 * x)) + next.velocity * (x * (3.0 * x - 2.0)),
    );
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
    let start = Flight(emitter.position + offset, velocity);
    let moved = bouncing_flight(emitter, start.position, velocity, flown);
    let carried = carried_by_swirls(emitter, Flying(start, lifetime, seconds));

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
            emitter.amount * share * fade_in * fade_out,
            place.x * 256.0 + seconds * emitter.frame_rate,
            age,
        ),
        moved.velocity * speed + carried.velocity,
        pack4x8unorm(vec4f(mix(emitter.tint, emitter.other_tint, color.x), 1.0 - emitter.heat_spread * color.y)),
    );
}
