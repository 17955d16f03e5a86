// Flight of an emitter's particles without the swirls of the air, solved in time.

#import "lib/curve.wgsl"

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
    // Fraction of the speed that a particle keeps on the floor; 0 for no floor.
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
    // Fraction of the births that happen, over a pulse.
    rate_curve: Curve,
    // Fraction of the radius by which a particle is moved up.
    anchor: f32,
    // Fraction of a turn.
    rotation_spread: f32,
    // 0 if all births happen.
    has_rate_curve: u32,
    // Strength of each octave of the swirls, as a fraction of the one before.
    swirl_detail: f32,
    // Velocity of the swirls as a whole.
    swirl_travel: vec3f,
    // Rolling rings per second.
    ring_rate: f32,
    // Way of the swirls until this time, in simplex coordinates: a part of a simplex, and whole ones.
    swirl_offset: vec3f,
    // Rings that have left the source until this time: a part of one, and the index of the last.
    ring_phase: f32,
    swirl_first: vec3i,
    ring_first: u32,
    // Growth of the wind per meter of height above `position`, 1/s; across `up`.
    wind_shear: vec3f,
    // Speed in the middle of a ring at birth, and its radius.
    ring_speed: f32,
    attractor: vec3f,
    // Speed toward the attractor, far from it.
    attraction: f32,
    ring_size: f32,
    attractor_size: f32,
    // Radians per second around the axis.
    orbit_rate: f32,
    // 0 if nothing carries the particles beside their flight.
    has_flow: u32,
    // Fraction of the particles that are small, and their radius as a fraction of the others'.
    small_fraction: f32,
    small_size: f32,
    // Height above the floor below which smoke turns aside; 0 if it does not.
    floor_margin: f32,
    // Distance from the obstacle below which smoke turns aside; 0 if there is none.
    obstacle_margin: f32,
    // Middle of the box.
    obstacle: vec3f,
    // Radius of its edges, for the smoke.
    obstacle_rounding: f32,
    // Half its size, less that radius.
    obstacle_core: vec3f,
    padding: f32,
}

const EMITTER_SHAPE_SPHERE: u32 = 0u;
const EMITTER_SHAPE_BOX: u32 = 1u;
const EMITTER_SHAPE_DISC: u32 = 2u;

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

// Position and velocity at a time.
struct Flight {
    position: vec3f,
    velocity: vec3f,
}

// Solution of v' = drag·(wind − v) + buoyancy: position and velocity approach their limits as 1 − e^(−drag·t).
fn flight(emitter: Emitter, start: Flight, seconds: f32) -> Flight {
    let integrals = drag_integrals(emitter.drag, seconds);
    let reached = integrals.x;
    let kept = 1.0 - emitter.drag * reached;
    return Flight(
        start.position + start.velocity * reached + emitter.wind * (seconds - reached) + emitter.rise * integrals.y,
        start.velocity * kept + emitter.wind * (1.0 - kept) + emitter.rise * reached,
    );
}

// After so many bounces a particle lies still.
const MAX_BOUNCES: u32 = 3u;
const IMPACT_STEPS: u32 = 20u;

// Flight that bounces off the floor.
fn bouncing_flight(emitter: Emitter, start: Flight, seconds: f32) -> Flight {
    var now = flight(emitter, start, seconds);
    if emitter.bounce <= 0.0 {
        return now;
    }
    var last = start;
    var left = seconds;
    for (var i = 0u; i < MAX_BOUNCES && dot(now.position, emitter.up) < emitter.floor; i++) {
        // The last time above the floor.
        var above = 0.0;
        var below = left;
        for (var step = 0u; step < IMPACT_STEPS; step++) {
            let middle = 0.5 * (above + below);
            let position = flight(emitter, last, middle).position;
            if dot(position, emitter.up) < emitter.floor {
                below = middle;
            } else {
                above = middle;
            }
        }
        let impact = flight(emitter, last, above);
        let reflected = impact.velocity - emitter.up * (2.0 * dot(impact.velocity, emitter.up));
        last = Flight(impact.position, reflected * emitter.bounce);
        left -= above;
        now = flight(emitter, last, left);
    }
    if dot(now.position, emitter.up) < emitter.floor {
        return Flight(last.position, vec3f(0.0));
    }
    return now;
}

// Progress of a particle under the curve of speed.
struct Pace {
    // Value of the curve.
    speed: f32,
    // Seconds in which a particle flies as far at a speed of 1.
    flown: f32,
}

// Pace of a particle of this age in seconds.
fn pace_at(emitter: Emitter, lifetime: f32, seconds: f32) -> Pace {
    if emitter.has_curves == 0u {
        return Pace(1.0, seconds);
    }
    let age = seconds / lifetime;
    return Pace(curve_value(emitter.speed_curve, age), lifetime * curve_integral(emitter.speed_curve, age));
}

// Turns a vector about `up` by an angle (cos, sin).
fn turned(v: vec3f, up: vec3f, turn: vec2f) -> vec3f {
    let along = up * dot(v, up);
    return along + (v - along) * turn.x + cross(up, v) * turn.y;
}

// Flight turned about the axis of the orbit, which the wind carries along.
fn orbiting_flight(emitter: Emitter, straight: Flight, flown: f32) -> Flight {
    if emitter.orbit_rate == 0.0 {
        return straight;
    }
    let up = emitter.up;
    let reached = drag_integrals(emitter.drag, flown).x;
    let axis = Flight(
        emitter.position + emitter.wind * (flown - reached),
        emitter.wind * (emitter.drag * reached),
    );
    let angle = emitter.orbit_rate * flown;
    let turn = vec2f(cos(angle), sin(angle));
    let side = turned(straight.position - axis.position, up, turn);
    return Flight(
        axis.position + side,
        axis.velocity + turned(straight.velocity - axis.velocity, up, turn) + cross(up, side) * emitter.orbit_rate,
    );
}

// Flight of a particle from its birth: drag, buoyancy, wind, the floor, the orbit, at the pace of its age.
fn paced_flight(emitter: Emitter, start: Flight, pace: Pace) -> Flight {
    let straight = bouncing_flight(emitter, start, pace.flown);
    let now = orbiting_flight(emitter, straight, pace.flown);
    return Flight(now.position, now.velocity * pace.speed);
}
