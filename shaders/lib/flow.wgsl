// Flow of the air that carries an emitter's particles beside their flight: swirls, rolling rings, wind that grows with the
// height, a pull, a floor, a box.

#import "lib/flight.wgsl"
#import "lib/swirl_noise.wgsl"

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

// Salt of the random numbers of rings.
const RING_SALT: u32 = 5u;
// A ring takes in air and widens by so much of its way.
const RING_GROWTH: f32 = 0.12;
// Random variation of radius and speed, up and down, as a fraction, and of the axis, as a fraction of its length.
const RING_SPREAD: f32 = 0.3;
// Fraction of the life after which a ring rolls at full speed.
const RING_ONSET: f32 = 0.1;

// Velocity around a rolling ring that leaves the source at the time of its number and flies as a particle does: forward
// within it, back around it. Divergence-free, of the stream function ½·ρ²·e^(−(ρ² + z²)), in radii.
fn ring(emitter: Emitter, position: vec3f, number: f32, later: f32) -> vec3f {
    let seconds = later + (emitter.ring_phase - number) / emitter.ring_rate;
    if seconds <= 0.0 {
        return vec3f(0.0);
    }
    let random = birth_random(emitter.ring_first + u32(i32(number)), RING_SALT, emitter.seed);
    let pace = pace_at(emitter, emitter.lifetime, seconds);
    let now = paced_flight(emitter, Flight(emitter.position, emitter.velocity), pace);
    let speed = length(now.velocity);
    let forward = select(emitter.up, now.velocity / speed, speed > 0.0);
    let axis = normalize(forward + unit_sphere(random) * RING_SPREAD);
    let born_radius = emitter.ring_size * (1.0 + RING_SPREAD * (2.0 * random.x - 1.0));
    let radius = born_radius + RING_GROWTH * length(now.position - emitter.position);
    // The circulation stays as it is.
    let hold = smoothstep_unit(seconds / (RING_ONSET * emitter.lifetime));
    let strength = emitter.ring_speed * (1.0 + RING_SPREAD * (2.0 * random.z - 1.0)) * hold * born_radius / radius;
    let from_middle = (position - now.position) / radius;
    let along = dot(from_middle, axis);
    let side = from_middle - axis * along;
    let aside = dot(side, side);
    return (axis * (1.0 - aside) + side * along) * (exp(-aside - along * along) * strength);
}

// Velocity of the two rings between which a particle was born; `born` is the number of its birth among them.
fn rings(emitter: Emitter, position: vec3f, born: f32, later: f32) -> vec3f {
    let last = floor(born);
    let fraction = born - last;
    // Full for half of the way to either, and continuous where another pair begins.
    return ring(emitter, position, last, later) * smoothstep_unit(2.0 - 2.0 * fraction)
        + ring(emitter, position, last + 1.0, later) * smoothstep_unit(2.0 * fraction);
}

// The part of a surface that is nearest to smoke which flows around it.
struct Wall {
    // Towards the smoke, of unit length.
    normal: vec3f,
    // Of the smoke from the surface, metres; below 0 behind it.
    distance: f32,
    // From the point that smoke flows away from, to the smoke.
    from_middle: vec3f,
}

// The floor, along which smoke flows away from the source.
fn floor_wall(emitter: Emitter, position: vec3f) -> Wall {
    return Wall(emitter.up, dot(position, emitter.up) - emitter.floor, position - emitter.position);
}

// The surface of the obstacle: a box whose edges are rounded, so that smoke turns gradually.
fn obstacle_wall(emitter: Emitter, position: vec3f) -> Wall {
    let from_middle = position - emitter.obstacle;
    let beyond = abs(from_middle) - emitter.obstacle_core;
    let outside = max(beyond, vec3f(0.0));
    let away = length(outside);
    // Deep inside, smoke rises.
    var normal = emitter.up;
    var distance = max(max(beyond.x, beyond.y), beyond.z);
    if away > 0.0 {
        normal = sign(from_middle) * outside / away;
        distance = away;
    }
    return Wall(normal, distance - emitter.obstacle_rounding, from_middle);
}

// Velocity that turns smoke aside from a wall within a margin: what flows towards the wall flows along it, and what is behind it
// comes out. `velocity`: that of the smoke. `seconds`: from one step to the next.
fn turned_aside(wall: Wall, margin: f32, velocity: vec3f, seconds: f32) -> vec3f {
    let near = smoothstep_unit(1.0 - wall.distance / margin);
    let towards = max(-dot(velocity, wall.normal), 0.0) * near;
    let side = wall.from_middle - wall.normal * dot(wall.from_middle, wall.normal);
    // Nowhere in particular at the middle, and slower where it has spread.
    let away = side * (2.0 * margin / (dot(side, side) + margin * margin));
    return (wall.normal + away) * towards + wall.normal * (max(-wall.distance, 0.0) * 0.5 / seconds);
}

// A particle between its birth and its death.
struct Flying {
    // At birth.
    start: Flight,
    // Seconds from birth to death, and to now.
    lifetime: f32,
    seconds: f32,
}

// Steps of the way through the flow, over a life.
const FLOW_STEPS: u32 = 32u;
// Fraction of the life over which the swirls take hold: smoke leaves the source smooth and breaks up later.
const SWIRL_ONSET: f32 = 0.15;

// Way of a particle through the flow, from the beginning of a step to its end: where it has been carried to, and the
// velocity there.
struct FlowStep {
    moved: Flight,
    next: Flight,
}

// Velocity of the flow at the beginning of a step, from 0, for a particle that it has carried by `offset`.
fn flow_at_step(emitter: Emitter, flying: Flying, number: u32, offset: vec3f) -> vec3f {
    let age = f32(number) / f32(FLOW_STEPS);
    let seconds = age * flying.lifetime;
    let later = seconds - flying.seconds;
    let pace = pace_at(emitter, flying.lifetime, seconds);
    let path = paced_flight(emitter, flying.start, pace);
    let position = path.position + offset;
    var velocity = vec3f(0.0);
    // Swirls do not hold at birth.
    if emitter.swirl_strength > 0.0 && number > 0u {
        velocity += swirl(emitter, position, later) * smoothstep_unit(age / SWIRL_ONSET);
    }
    if emitter.ring_speed != 0.0 {
        let born = emitter.ring_phase - flying.seconds * emitter.ring_rate;
        velocity += rings(emitter, position, born, later);
    }
    velocity += emitter.wind_shear * max(dot(position - emitter.position, emitter.up), 0.0);
    let to_attractor = emitter.attractor - position;
    let distance = sqrt(dot(to_attractor, to_attractor) + emitter.attractor_size * emitter.attractor_size);
    velocity += to_attractor * (emitter.attraction / distance);
    velocity *= pace.speed;
    let step = flying.lifetime / f32(FLOW_STEPS);
    if emitter.floor_margin > 0.0 {
        let wall = floor_wall(emitter, position);
        velocity += turned_aside(wall, emitter.floor_margin, path.velocity + velocity, step);
    }
    if emitter.obstacle_margin > 0.0 {
        let wall = obstacle_wall(emitter, position);
        velocity += turned_aside(wall, emitter.obstacle_margin, path.velocity + velocity, step);
    }
    return velocity;
}

// Goes on to step `number` of the way through the flow: the integral of its velocity along the path. (Adams and Bashforth,
// second order)
fn advance_flow_step(emitter: Emitter, flying: Flying, last: FlowStep, number: u32) -> FlowStep {
    let step = flying.lifetime / f32(FLOW_STEPS);
    let moved = last.next;
    let position = moved.position + (moved.velocity * 1.5 - last.moved.velocity * 0.5) * step;
    let velocity = flow_at_step(emitter, flying, number, position);
    return FlowStep(moved, Flight(position, velocity));
}

// Way and velocity that the flow adds to the flight of a particle, in steps that begin at its birth, with a cubic within
// each.
fn carried_by_flow(emitter: Emitter, flying: Flying) -> Flight {
    if emitter.has_flow == 0u {
        return Flight();
    }
    let step = flying.lifetime / f32(FLOW_STEPS);
    let steps = flying.seconds / step;
    let number = min(u32(steps), FLOW_STEPS - 1u) + 1u;
    // As if it had flowed alike before.
    let birth = Flight(vec3f(0.0), flow_at_step(emitter, flying, 0u, vec3f(0.0)));
    var reached = FlowStep(birth, birth);
    for (var i = 1u; i <= number; i++) {
        reached = advance_flow_step(emitter, flying, reached, i);
    }
    let moved = reached.moved;
    let next = reached.next;
    let x = steps - f32(number - 1u);
    let rest = 1.0 - x;
    let slope = (next.position - moved.position) / step;
    return Flight(
        mix(moved.position, next.position, x * x * (3.0 - 2.0 * x))
            + (moved.velocity * rest - next.velocity * x) * (x * rest * step),
        slope * (6.0 * x * rest) + moved.velocity * (rest * (1.0 - 3.0 * x)) + next.velocity * (x * (3.0 * x - 2.0)),
    );
}
