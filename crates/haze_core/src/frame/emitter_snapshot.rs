//! Unevaluated particles of an emitter at one time. A GPU can evaluate them where it draws them.

use glam::Vec3;

use super::bounds::Bounds;
use super::emitter_paths::EmitterPaths;
use super::particle::Particle;
use super::sprite_extent::SpriteExtent;
use crate::formula::curve::{CurvePoints, curve_point};
use crate::formula::emitter::{EmittedParticle, birth_delay, emitted_particle};
use crate::formula::flight::drag_integrals;
use crate::formula::uniforms::EmitterUniform;
use crate::settings::MAX_CURVE_POINTS;

/// Particles of an emitter at one time, not yet evaluated. [`Emitter::snapshot`](crate::emitter::Emitter::snapshot)
/// returns it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct EmitterSnapshot {
    /// The emitter at this time.
    pub uniform: EmitterUniform,
    /// Step of the sample: one birth stands for so many.
    pub step: u32,
    /// Births from `first` to the first one whose index is a multiple of `step`.
    pub first_sample: u32,
}

/// Bound on the speed of a particle in the swirls, in units of their strength: more than at any point that the test below
/// samples.
const SWIRL_SPEED_BOUND: f32 = 25.0;
/// Bound on the speed of a particle around two rings, in units of their mean speed in the middle: more than at any point that
/// the test below samples.
const RING_SPEED_BOUND: f32 = 4.0;
/// Number of intervals of age for which the box is computed.
const AGE_INTERVALS: u32 = 16;

impl EmitterSnapshot {
    /// Number of births that may be alive. No fewer than are alive.
    pub fn count(&self) -> u32 {
        self.uniform.count
    }

    /// Replaces `particles` with those that are alive.
    pub fn evaluate(&self, particles: &mut Vec<Particle>) {
        self.evaluate_along(&mut EmitterPaths::default(), particles);
    }

    /// [`evaluate`](Self::evaluate) in a fraction of the time, for frame after frame: goes on from where the particles were
    /// when `paths` was used last, at any time. What earlier frames have rounded stays in the positions: a tenth of a
    /// millimetre or so.
    pub fn evaluate_along(&self, paths: &mut EmitterPaths, particles: &mut Vec<Particle>) {
        paths.write(&self.uniform, 0, 1, particles);
    }

    /// Replaces `particles` with a sample, each of which stands for `step` particles. The sample has the same particles
    /// in every frame.
    pub fn sample(&self, particles: &mut Vec<Particle>) {
        self.sample_along(&mut EmitterPaths::default(), particles);
    }

    /// [`sample`](Self::sample) in a fraction of the time, as [`evaluate_along`](Self::evaluate_along) is of
    /// [`evaluate`](Self::evaluate).
    pub fn sample_along(&self, paths: &mut EmitterPaths, particles: &mut Vec<Particle>) {
        paths.write(&self.uniform, self.first_sample, self.step, particles);
    }

    /// Way of each particle of [`evaluate`](Self::evaluate) to where the snapshot `later`, by so many seconds, has it.
    pub fn displacements(&self, later: &EmitterUniform, seconds: f32) -> impl Iterator<Item = Vec3> {
        let position = |particle: &EmittedParticle| particle.position_radius.truncate();
        (0..self.uniform.count).filter_map(move |number| {
            let [now, then] = [&self.uniform, later].map(|emitter| emitted_particle(emitter, number));
            let is_alive = |particle: &EmittedParticle| particle.position_radius.w > 0.0;
            let way = if is_alive(&then) { position(&then) - position(&now) } else { now.velocity * seconds };
            (now.rotation_amount_frame_age.y > 0.0).then_some(way)
        })
    }

    /// Box that contains every sprite, from the emitter's settings alone. It is larger than that of the particles.
    /// `extent` is as in [`particle_bounds`](super::particle_bounds).
    pub fn bounds(&self, extent: SpriteExtent) -> Bounds {
        let e = &self.uniform;
        let mut bounds = Bounds::EMPTY;
        let longest = e.lifetime * (1.0 + e.lifetime_spread);
        let shortest = e.lifetime * (1.0 - e.lifetime_spread);
        let oldest = e.since_first.min(longest);
        // A particle that bounces comes back to where younger ones are; one that is slower than others stays there.
        let lags = e.bounce > 0.0 || e.has_curves != 0;
        let highest = |curve: &CurvePoints| (0..MAX_CURVE_POINTS).map(|i| curve_point(curve, i).y).fold(0.0, f32::max);
        let fastest = highest(&e.speed_curve);
        let largest = highest(&e.size_curve);
        let youngest = if lags { 0.0 } else { (e.since_first - birth_delay(e, e.count)).max(0.0) };
        if e.count == 0 || oldest < youngest {
            return bounds;
        }
        let disc = |axis: Vec3, extent: f32| axis.abs() * extent;
        // Large enough for every shape.
        let born = e.extent.max(disc(e.disc_x, e.extent.x) + disc(e.disc_z, e.extent.z));
        let at = |step: u32| youngest + (oldest - youngest) * step as f32 / AGE_INTERVALS as f32;
        for step in 0..AGE_INTERVALS {
            let early = at(step);
            let late = at(step + 1);
            let flown = late * fastest;
            let reached_early = drag_integrals(e.drag, early);
            let reached_late = drag_integrals(e.drag, flown);
            // The factors only grow with age, so the ends of an interval bound them.
            let ways = [
                (e.velocity, reached_early.x, reached_late.x),
                (e.wind, early - reached_early.x, flown - reached_late.x),
                (e.rise, reached_early.y, reached_late.y),
            ];
            let (mut low, mut high) =
                ways.into_iter().fold((e.position, e.position), |(low, high), (way, from, to)| {
                    let from = if lags { Vec3::ZERO } else { way * from };
                    let to = way * to;
                    (low + from.min(to), high + from.max(to))
                });
            let mut turning = 0.0;
            if e.orbit_rate != 0.0 {
                let blown = e.wind.length() * (flown - reached_late.x);
                let far = (low - born - e.position).abs().max((high + born - e.position).abs()).length() + 2.0 * blown;
                low = e.position - far;
                high = e.position + far;
                turning = e.orbit_rate.abs() * far;
            }
            let age = (late / shortest).min(1.0);
            let way = (low - e.position).abs().max((high - e.position).abs()).length();
            let thrown = (e.burst.abs() + e.velocity_spread) * reached_late.x;
            let flow = flow_bound(e, way + born.length() + thrown, flown);
            let scattered = thrown + flow.way;
            let radius = largest * e.radius_start.max(e.radius_start + (e.radius_end - e.radius_start) * age.sqrt());
            let kept = if lags { 1.0 } else { 1.0 - e.drag * reached_early.x };
            let speed = fastest
                * ((e.velocity.length() + e.burst.abs() + e.velocity_spread) * kept
                    + e.wind.length()
                    + e.rise.length() * reached_late.x
                    + turning
                    + flow.speed);
            // Along a floor or an obstacle, smoke is as fast again as it was, and comes out.
            let walls = [e.floor_margin, e.obstacle_margin].into_iter().filter(|margin| *margin > 0.0).count();
            let speed = speed * 3.0_f32.powi(walls as i32);
            let radius = radius * (1.0 + e.radius_spread);
            let margin = scattered + e.anchor * radius + extent.radius(radius, speed);
            bounds.include(low - born, margin);
            bounds.include(high + born, margin);
        }
        bounds
    }
}

/// Bounds on what the flow adds to the flight of a particle.
struct FlowBound {
    way: f32,
    speed: f32,
}

/// Bounds after a flight of so many seconds that has led no farther than `flight` from the source, in metres.
fn flow_bound(emitter: &EmitterUniform, flight: f32, seconds: f32) -> FlowBound {
    let ring_speed = RING_SPEED_BOUND * emitter.ring_speed;
    let mut way = swirl_way_bound(emitter, seconds) + emitter.attraction.abs() * seconds;
    way += ring_way_bound(emitter, flight, seconds);
    if emitter.floor_margin > 0.0 {
        // Up as far as it has fallen, and as far aside.
        way += 2.0 * (flight + way);
    }
    if emitter.obstacle_margin > 0.0 {
        // Aside as far as it has come towards the obstacle; births inside come out.
        let extent = emitter.obstacle_core + emitter.obstacle_rounding;
        let born_inside = (emitter.position - emitter.obstacle).abs().cmple(extent + emitter.extent.length()).all();
        way += 2.0 * (flight + way);
        way += if born_inside { 2.0 * extent.length() } else { 0.0 };
    }
    // Shear blows across `up`: the smoke rises no higher than this.
    let aloft = emitter.wind_shear.length() * (flight + way);
    FlowBound {
        way: way + aloft * seconds,
        speed: SWIRL_SPEED_BOUND * emitter.swirl_strength + ring_speed + emitter.attraction.abs() + aloft,
    }
}

/// Bound on the way by which rings carry a particle: around them, not along with them. More than any that the test below
/// samples.
fn ring_way_bound(emitter: &EmitterUniform, flight: f32, seconds: f32) -> f32 {
    let straight = RING_SPEED_BOUND * emitter.ring_speed * seconds;
    straight.min(5.0 * emitter.ring_size + 0.6 * flight)
}

/// Bound on the way along an axis by which the swirls carry a particle in so many seconds: more than any that the test below
/// samples. Large swirls carry it straight on; among small ones it wanders, and gets as far as the square root.
fn swirl_way_bound(emitter: &EmitterUniform, seconds: f32) -> f32 {
    let way = emitter.swirl_strength * seconds;
    7.5 * way / (1.0 + 3.5 * way * emitter.swirl_frequency).sqrt()
}

#[cfg(test)]
mod tests {
    use glam::UVec3;

    use super::*;
    use crate::emitter::Emitter;
    use crate::formula::flight::{Flight, flight};
    use crate::formula::flow::{FlowStep, Flying, carried_by_flow};
    use crate::formula::hash::{pcg3d, unit};

    #[test]
    fn swirls_stay_within_their_bounds() {
        let mut farthest = 0.0_f32;
        let mut fastest = 0.0_f32;
        for (index, scale) in [0.1, 0.3, 1.0, 3.0, 10.0, 100.0].into_iter().enumerate() {
            for (wind, detail, turbulence_travel) in [(0.0, 0.6, 1.0), (2.0, 1.0, 0.3), (30.0, 0.0, 1.0)] {
                let emitter =
                    Emitter { turbulence: 1.0, turbulence_scale: scale, turbulence_travel, ..Emitter::default() };
                let emitter = Emitter { turbulence_detail: detail, wind: Vec3::X * wind, ..emitter };
                let uniform = emitter.snapshot(100.0).uniform;
                for particle in 0..8000 {
                    let random = pcg3d(UVec3::new(particle, index as u32, 5));
                    let random = Vec3::new(unit(random.x), unit(random.y), unit(random.z));
                    let start = Flight { position: random * 100.0, velocity: (random - 0.5) * 2.0 };
                    for age in [0.1, 0.3, 0.6, 0.99] {
                        let seconds = emitter.lifetime * age;
                        let flying = Flying { start, lifetime: emitter.lifetime, seconds };
                        let carried = carried_by_flow(&uniform, &flying, &mut FlowStep::default());
                        let way = carried.position.abs().max_element();
                        farthest = farthest.max(way / swirl_way_bound(&uniform, seconds));
                        fastest = fastest.max(carried.velocity.length() / uniform.swirl_strength);
                    }
                }
            }
        }
        println!("{farthest} {fastest}");
        assert!((0.5..0.98).contains(&farthest), "{farthest}");
        assert!((0.5..0.98).contains(&(fastest / SWIRL_SPEED_BOUND)), "{fastest}");
    }

    #[test]
    fn rings_stay_within_their_bounds() {
        let mut farthest = 0.0_f32;
        let mut fastest = 0.0_f32;
        for (ring_size, ring_rate, buoyancy) in [(0.1, 2.0, 0.6), (0.4, 1.0, 0.0), (0.4, 0.3, 2.0), (2.0, 0.5, 1.0)] {
            // The second is more than has effect.
            for ring_speed in [0.5, 1000.0] {
                let emitter =
                    Emitter { ring_size, ring_rate, ring_speed, buoyancy, turbulence: 0.0, ..Emitter::default() };
                let uniform = emitter.snapshot(100.0).uniform;
                for particle in 0..4000 {
                    let random = pcg3d(UVec3::new(particle, 3, 5));
                    let random = Vec3::new(unit(random.x), unit(random.y), unit(random.z)) - 0.5;
                    let start = Flight { position: random * 3.0 * ring_size, velocity: emitter.velocity };
                    for age in [0.1, 0.3, 0.6, 0.99] {
                        // Births at any time between two rings.
                        let seconds = (age + 0.1 * random.x) * emitter.lifetime;
                        let seconds = seconds.clamp(0.0, 0.999 * emitter.lifetime);
                        let flying = Flying { start, lifetime: emitter.lifetime, seconds };
                        let carried = carried_by_flow(&uniform, &flying, &mut FlowStep::default());
                        let flown = flight(&uniform, &start, seconds).position.length();
                        farthest = farthest.max(carried.position.length() / ring_way_bound(&uniform, flown, seconds));
                        fastest = fastest.max(carried.velocity.length() / uniform.ring_speed);
                    }
                }
            }
        }
        println!("{farthest} {fastest}");
        assert!((0.3..0.98).contains(&farthest), "{farthest}");
        assert!((0.3..0.98).contains(&(fastest / RING_SPEED_BOUND)), "{fastest}");
    }
}
