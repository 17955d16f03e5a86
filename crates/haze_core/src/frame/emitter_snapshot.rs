//! Unevaluated particles of an emitter at one time. A GPU can evaluate them where it draws them.

use glam::Vec3;

use super::bounds::Bounds;
use super::particle::Particle;
use super::sprite_extent::SpriteExtent;
use crate::formula::curve::{CurvePoints, curve_point};
use crate::formula::emitter::{EmittedParticle, birth_delay, drag_integrals, emitted_particle};
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

/// Bound on the displacement by turbulence along an axis, in units of `turbulence`: more than at any point that the
/// test below samples.
const TURBULENCE_BOUND: f32 = 5.0;
/// Number of intervals of age for which the box is computed.
const AGE_INTERVALS: u32 = 16;

impl EmitterSnapshot {
    /// Number of births that may be alive. No fewer than are alive.
    pub fn count(&self) -> u32 {
        self.uniform.count
    }

    /// Replaces `particles` with those that are alive.
    pub fn evaluate(&self, particles: &mut Vec<Particle>) {
        self.write(0, 1, particles);
    }

    /// Replaces `particles` with a sample, each of which stands for `step` particles. The sample has the same particles
    /// in every frame.
    pub fn sample(&self, particles: &mut Vec<Particle>) {
        self.write(self.first_sample, self.step, particles);
    }

    fn write(&self, first: u32, step: u32, particles: &mut Vec<Particle>) {
        let alive = |number| {
            let emitted = emitted_particle(&self.uniform, number);
            let [rotation, amount, frame, age] = emitted.rotation_amount_frame_age.to_array();
            let radius = emitted.position_radius.w;
            let position = emitted.position_radius.truncate();
            // Particles that are not alive have an amount of 0 and no position. They are dropped, as are those that
            // have faded out.
            let [r, g, b, heat] = emitted.tint_heat;
            let (velocity, tint) = (emitted.velocity, [r, g, b]);
            (amount > 0.0).then_some(Particle { position, radius, rotation, amount, frame, age, velocity, tint, heat })
        };
        particles.clear();
        particles.extend((first..self.uniform.count).step_by(step as usize).filter_map(alive));
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
        let (longest, shortest) = (e.lifetime * (1.0 + e.lifetime_spread), e.lifetime * (1.0 - e.lifetime_spread));
        let oldest = e.since_first.min(longest);
        // A particle that bounces comes back to where younger ones are; one that is slower than others stays there.
        let lags = e.bounce > 0.0 || e.has_curves != 0;
        let highest = |curve: &CurvePoints| (0..MAX_CURVE_POINTS).map(|i| curve_point(curve, i).y).fold(0.0, f32::max);
        let (fastest, largest) = (highest(&e.speed_curve), highest(&e.size_curve));
        let youngest = if lags { 0.0 } else { (e.since_first - birth_delay(e, e.count)).max(0.0) };
        if e.count == 0 || oldest < youngest {
            return bounds;
        }
        let disc = |axis: Vec3, extent: f32| axis.abs() * extent;
        // Large enough for every shape.
        let born = e.extent.max(disc(e.disc_x, e.extent.x) + disc(e.disc_z, e.extent.z));
        let at = |step: u32| youngest + (oldest - youngest) * step as f32 / AGE_INTERVALS as f32;
        for step in 0..AGE_INTERVALS {
            let (early, late) = (at(step), at(step + 1));
            let flown = late * fastest;
            let (reached_early, reached_late) = (drag_integrals(e.drag, early), drag_integrals(e.drag, flown));
            // The factors only grow with age, so the ends of an interval bound them.
            let ways = [
                (e.velocity, reached_early.x, reached_late.x),
                (e.wind, early - reached_early.x, flown - reached_late.x),
                (e.rise, reached_early.y, reached_late.y),
            ];
            let (low, high) = ways.into_iter().fold((e.position, e.position), |(low, high), (way, from, to)| {
                let (from, to) = (if lags { Vec3::ZERO } else { way * from }, way * to);
                (low + from.min(to), high + from.max(to))
            });
            let age = (late / shortest).min(1.0);
            let scattered =
                (e.burst.abs() + e.velocity_spread) * reached_late.x + TURBULENCE_BOUND * e.turbulence * age;
            let radius = largest * e.radius_start.max(e.radius_start + (e.radius_end - e.radius_start) * age.sqrt());
            let kept = if lags { 1.0 } else { 1.0 - e.drag * reached_early.x };
            let speed = fastest
                * ((e.velocity.length() + e.burst.abs() + e.velocity_spread) * kept
                    + e.wind.length()
                    + e.rise.length() * reached_late.x)
                + TURBULENCE_BOUND * 3.0_f32.sqrt() * e.turbulence / shortest;
            let radius = radius * (1.0 + e.radius_spread);
            let margin = scattered + e.anchor * radius + extent.radius(radius, speed);
            bounds.include(low - born, margin);
            bounds.include(high + born, margin);
        }
        bounds
    }
}

#[cfg(test)]
mod tests {
    use glam::{UVec3, Vec2};

    use super::*;
    use crate::formula::gradient_noise::curl_noise;
    use crate::formula::hash::{pcg3d, unit};

    #[test]
    fn turbulence_stays_within_its_bound() {
        let mut farthest = 0.0_f32;
        for index in 0..400_000 {
            let [place, turn] = [0, 1].map(|salt| pcg3d(UVec3::new(index, salt, 5)));
            let place = Vec3::new(unit(place.x), unit(place.y), unit(place.z)) * 1000.0;
            let phase = Vec2::from_angle(unit(turn.x) * std::f32::consts::TAU);
            let swirl = curl_noise(place, phase, 977) + curl_noise(place * 2.3, phase, 982) * 0.4;
            farthest = farthest.max(swirl.abs().max_element());
        }
        println!("{farthest}");
        assert!((0.5 * TURBULENCE_BOUND..0.98 * TURBULENCE_BOUND).contains(&farthest), "{farthest}");
    }
}
