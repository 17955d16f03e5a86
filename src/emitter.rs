//! Seekable emitter: every particle is a closed-form function of (seed, birth index, time).
//!
//! There is no simulation state, so time can be scrubbed, frames can be rendered in any order, and two images can be
//! compared. The arithmetic is integer hashes and plain f32, in `src/formula/emitter.rs` and, for GPUs,
//! `shaders/lib/emitter.wgsl`.

use glam::{Quat, Vec2, Vec3};

use crate::error::FieldError;
use crate::formula::uniforms::EmitterUniform;
use crate::frame::{EmitterSnapshot, Particle};
use crate::settings::{choice, settings, validate};

/// Maximum number of particles of one emitter, and of all emitters of a preset together.
pub const MAX_PARTICLES: u32 = 1 << 20;

/// Approximate number of particles in a sample.
const SAMPLE: f64 = 1024.0;

choice! {
    /// Shape in which particles are born.
    #[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
    EmitterShape {
        /// An ellipsoid.
        #[default]
        Sphere = "sphere",
        /// A box.
        Box = "box",
        /// A flat disc perpendicular to `up`, with the extent's x and z.
        Disc = "disc",
    }
}

settings! {
    /// Settings of an emitter. Positions and velocities are in world space.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Emitter {
        "birth":
        /// Seed of the random numbers. Each value gives different smoke of the same kind.
        seed: u32 = 1, seed;
        /// Births per second. Higher: denser and smoother smoke, at the cost of more sprites.
        rate: f32 = 40.0, number(0.0..=100_000.0, "1/s");
        /// Seconds of emission, from time 0. 0: emission has no beginning and no end.
        duration: f32 = 0.0, number(0.0..=3600.0, "s");
        /// Seconds from the beginning of one emission to the next: puffs of a chimney, shots. At least `duration`. 0: one
        /// emission only.
        period: f32 = 0.0, number(0.0..=3600.0, "s");
        /// Seconds that a particle lives. Higher: the smoke gets further before it disappears.
        lifetime: f32 = 6.0, number(0.01..=600.0, "s");
        /// Random variation of the lifetime, up and down, as a share of it. At 0 the smoke ends along a line.
        lifetime_spread: f32 = 0.2, number(0.0..=0.95, "");
        /// Shape in which particles are born.
        shape: EmitterShape = EmitterShape::Sphere, choice;
        /// Middle of the shape, where the smoke begins.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        position: Vec3 = Vec3::ZERO, vector(-1.0e5..=1.0e5, "m");
        /// Half the size of the shape. Lower: a jet. Higher: a carpet of smoke.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        extent: Vec3 = Vec3::splat(0.2), vector(0.0..=1.0e4, "m");
        "motion":
        /// Velocity at birth: the thrust of a vent. Drag changes it to the velocity of the air.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        velocity: Vec3 = Vec3::new(0.0, 0.6, 0.0), vector(-1.0e3..=1.0e3, "m/s");
        /// Speed at birth, away from the middle of the shape: a blast.
        burst: f32 = 0.0, number(-1.0e3..=1.0e3, "m/s");
        /// Random speed at birth, in any direction. Higher: the root of the smoke frays.
        velocity_spread: f32 = 0.2, number(0.0..=1.0e3, "m/s");
        /// Rate at which particles take on the velocity of the air. Higher: jets stop sooner, and wind bends them.
        drag: f32 = 0.6, number(0.0..=100.0, "1/s");
        /// Upward acceleration of hot smoke. Higher: faster rise, which drag limits to buoyancy / drag.
        buoyancy: f32 = 0.6, number(-100.0..=100.0, "m/s²");
        /// Up direction, along which hot smoke rises and across which a disc lies; need not be unit length.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        up: Vec3 = Vec3::Y, vector(-1.0e3..=1.0e3, "");
        /// Share of their speed that particles keep when they hit the floor, three times at most: sparks, embers, hail. 0:
        /// there is no floor.
        bounce: f32 = 0.0, number(0.0..=0.95, "");
        /// Height of the floor along `up`, from the origin of the world.
        floor: f32 = 0.0, number(-1.0e5..=1.0e5, "m");
        /// Velocity of the air. Leans the smoke over.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        wind: Vec3 = Vec3::ZERO, vector(-100.0..=100.0, "m/s");
        "turbulence":
        /// Distance by which curl noise moves a particle off its path by the end of its life. Higher: tears the smoke
        /// apart.
        turbulence: f32 = 0.5, number(0.0..=100.0, "m");
        /// Size of the swirls. Lower: frays the smoke. Higher: bends all of it.
        turbulence_scale: f32 = 1.5, number(0.01..=1.0e3, "m");
        /// Turns of the swirls per second. Higher: restless smoke.
        turbulence_speed: f32 = 0.05, number(0.0..=10.0, "1/s");
        "size":
        /// Radius at birth: thickness of the smoke at its root.
        radius_start: f32 = 0.25, number(0.0..=1.0e3, "m");
        /// Radius at death. Higher: smoke spreads wider and looks softer; cost grows with its square.
        radius_end: f32 = 1.2, number(0.0..=1.0e3, "m");
        /// Random variation of the radius, up and down, as a share of it. Higher: less uniform puffs.
        radius_spread: f32 = 0.25, number(0.0..=0.95, "");
        "appearance":
        /// Fastest spin at birth, either way; drag slows it. Normals and light turn with the sprite.
        spin: f32 = 0.6, number(0.0..=100.0, "rad/s");
        /// Amount of a full-grown particle: share of the background that one sprite hides. A lower amount with more
        /// sprites is smoother.
        amount: f32 = 0.3, number(0.0..=1.0, "");
        /// Share of the life over which a particle fades in. At 0 sprites pop in.
        fade_in: f32 = 0.12, number(0.0..=1.0, "");
        /// Share of the life over which a particle fades out. At 0 sprites pop out; at 1 the top of the smoke is thin.
        fade_out: f32 = 0.5, number(0.0..=1.0, "");
        /// Flipbook frames per second. Higher: puffs boil faster. 0: still.
        frame_rate: f32 = 4.0, number(0.0..=120.0, "frames/s");
        /// Linear RGB color of the particles. Each has one at random between this and `other_tint`. Read if `sprite.tint` is
        /// above 0.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        tint: Vec3 = Vec3::ONE, color(0.0..=1.0);
        /// The other end of the particles' colors: dust of red ground in grey smoke.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        other_tint: Vec3 = Vec3::ONE, color(0.0..=1.0);
        /// Share by which the coldest particles of the same age are colder than the hottest. Higher: sooty puffs between the
        /// flames. Read if the system burns.
        heat_spread: f32 = 0.0, number(0.0..=1.0, "");
    }
}

/// An emission that repeats.
#[derive(Clone, Copy)]
struct Pulses {
    /// Of each pulse.
    births: i64,
    /// Seconds from pulse to pulse.
    period: f64,
}

impl Emitter {
    /// Checks ranges, and that no more than [`MAX_PARTICLES`] live at once. `path` precedes the field's name.
    ///
    /// # Errors
    /// The first field that is not valid.
    pub fn validate(&self, path: impl Fn() -> String) -> Result<(), FieldError> {
        validate(self, &path)?;
        if self.up.normalize_or_zero() == Vec3::ZERO {
            return Err(FieldError::new(format!("{}.up", path()), self.up, "a direction that is not zero"));
        }
        if self.period > 0.0 && self.period < self.duration {
            let expected = format!("0, or at least the duration of {} s", self.duration);
            return Err(FieldError::new(format!("{}.period", path()), self.period, expected));
        }
        let most = self.max_alive();
        if most > f64::from(MAX_PARTICLES) {
            let problem = format!("at this rate, {most:.0} particles are alive at once");
            return Err(FieldError::from_problem(
                format!("{}.rate", path()),
                problem,
                format!("at most {MAX_PARTICLES}"),
            ));
        }
        Ok(())
    }

    /// Maximum number of particles that live at once.
    pub fn max_alive(&self) -> f64 {
        let (longest, duration) = (self.longest(), f64::from(self.duration));
        let emitting = match self.pulses() {
            Some(Pulses { period, .. }) => (longest / period).floor() * duration + (longest % period).min(duration),
            None if duration > 0.0 => longest.min(duration),
            None => longest,
        };
        f64::from(self.rate) * emitting
    }

    /// Longest life of a particle, seconds.
    fn longest(&self) -> f64 {
        f64::from(self.lifetime * (1.0 + self.lifetime_spread))
    }

    /// Returns the pulses of an emission that repeats.
    fn pulses(&self) -> Option<Pulses> {
        // Less the rounding of f32, which would add a birth.
        let births = (f64::from(self.duration) * f64::from(self.rate) - 1.0e-3).ceil() as i64;
        (births > 0 && self.period > 0.0).then_some(Pulses { births, period: f64::from(self.period) })
    }

    /// Replaces `particles` with those alive at `time`, seconds. The same input gives the same output, to the bit.
    pub fn evaluate(&self, time: f32, particles: &mut Vec<Particle>) {
        self.snapshot(time).evaluate(particles);
    }

    /// Particles alive at `time`, seconds, not evaluated, for [`Particles::Emitter`](crate::Particles::Emitter).
    pub fn snapshot(&self, time: f32) -> EmitterSnapshot {
        let (first, last) = self.birth_range(time);
        let pulses = self.pulses();
        let Pulses { births, period } = pulses.unwrap_or(Pulses { births: i64::from(u32::MAX), period: 0.0 });
        let first_in_pulse = if pulses.is_some() { first.rem_euclid(births) } else { 0 };
        let born = match pulses {
            Some(_) => first.div_euclid(births) as f64 * period + first_in_pulse as f64 / f64::from(self.rate),
            None => first as f64 / f64::from(self.rate),
        };
        let up = self.up.normalize_or(Vec3::Y);
        let disc = Quat::from_rotation_arc(Vec3::Y, up);
        let uniform = EmitterUniform {
            first: first as u32,
            count: (last - first) as u32,
            seed: self.seed,
            shape: self.shape as u32,
            // f64, because at 100 000 births a second f32 could not tell two births apart after three minutes.
            since_first: (f64::from(time) - born) as f32,
            rate: self.rate,
            lifetime: self.lifetime,
            lifetime_spread: self.lifetime_spread,
            position: self.position,
            burst: self.burst,
            extent: self.extent,
            velocity_spread: self.velocity_spread,
            velocity: self.velocity,
            drag: self.drag,
            rise: up * self.buoyancy,
            turbulence: self.turbulence,
            wind: self.wind,
            turbulence_scale: self.turbulence_scale,
            disc_x: disc * Vec3::X,
            radius_start: self.radius_start,
            disc_z: disc * Vec3::Z,
            radius_end: self.radius_end,
            phase: Vec2::from_angle(time * self.turbulence_speed * std::f32::consts::TAU),
            radius_spread: self.radius_spread,
            spin: self.spin,
            amount: self.amount,
            fade_in: self.fade_in,
            fade_out: self.fade_out,
            frame_rate: self.frame_rate,
            tint: self.tint,
            heat_spread: self.heat_spread,
            other_tint: self.other_tint,
            bounce: self.bounce,
            up,
            floor: self.floor,
            per_pulse: births as u32,
            first_in_pulse: first_in_pulse as u32,
            period: period as f32,
            padding: 0.0,
        };
        let step = (self.max_alive() / SAMPLE).ceil().max(1.0) as u32;
        let first_sample = (-first).rem_euclid(i64::from(step)) as u32;
        EmitterSnapshot { uniform, step, first_sample }
    }

    /// Range of birth indices that may be alive at `time`. Birth i happens at i / rate, in pulses at so much after the
    /// beginning of its pulse.
    fn birth_range(&self, time: f32) -> (i64, i64) {
        if self.rate <= 0.0 {
            return (0, 0);
        }
        let (time, rate, longest) = (f64::from(time), f64::from(self.rate), self.longest());
        if let Some(Pulses { births, period }) = self.pulses() {
            let index = |time: f64, more: i64| {
                let pulse = (time / period).floor();
                let in_pulse = ((time - pulse * period) * rate).floor() as i64 + more;
                pulse as i64 * births + in_pulse.min(births)
            };
            let first = index(time - longest, 0).max(0);
            return (first, index(time, 1).max(first));
        }
        let mut first = ((time - longest) * rate).floor() as i64;
        let mut last = (time * rate).floor() as i64 + 1;
        if self.duration > 0.0 {
            first = first.max(0);
            last = last.min((f64::from(self.duration) * rate).ceil() as i64);
        }
        (first, last.max(first))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::emitter::{drag_integrals, smoothstep_unit};
    use crate::frame::{SpriteExtent, particle_bounds};
    use crate::settings::Settings;

    fn at(emitter: &Emitter, time: f32) -> Vec<Particle> {
        let mut particles = Vec::new();
        emitter.evaluate(time, &mut particles);
        particles
    }

    #[test]
    fn particles_do_not_depend_on_earlier_evaluations() {
        let emitter = Emitter::default();
        let later = at(&emitter, 30.0);
        assert_eq!(later, at(&emitter, 30.0));
        let _ = at(&emitter, 1.0);
        assert_eq!(later, at(&emitter, 30.0));
        assert!(later.iter().all(Particle::is_valid));
        // Rate times lifetime, within the jitter.
        assert!((200..=280).contains(&later.len()), "{}", later.len());
    }

    #[test]
    fn extreme_seeds_give_smoke_too() {
        // The second seed times 977 wraps to the largest word.
        for seed in [0, 769_313_487, u32::MAX] {
            assert!(at(&Emitter { seed, ..Emitter::default() }, 2.0).len() > 50);
        }
    }

    #[test]
    fn motion_is_continuous() {
        let emitter = Emitter { lifetime_spread: 0.0, ..Emitter::default() };
        let (before, after) = (at(&emitter, 12.0), at(&emitter, 12.001));
        let mut matched = 0;
        for a in &before {
            // A millisecond moves a particle by millimetres; its neighbours are further away.
            let nearest = after.iter().map(|b| a.position.distance(b.position)).fold(f32::INFINITY, f32::min);
            assert!(nearest < 0.02 || a.age > 0.999, "{nearest}");
            matched += 1;
        }
        assert!(matched > 100);
    }

    #[test]
    fn smoke_rises_along_up() {
        let upwards = Emitter { shape: EmitterShape::Disc, turbulence: 0.0, ..Emitter::default() };
        // Cycles the axes: x becomes y, y becomes z, z becomes x.
        let turned = |v: Vec3| Vec3::new(v.z, v.x, v.y);
        let along_z =
            Emitter { up: Vec3::Z * 3.0, velocity: turned(upwards.velocity), velocity_spread: 0.0, ..upwards };
        let upwards = Emitter { velocity_spread: 0.0, ..upwards };
        let height = |particles: &[Particle], up: Vec3| particles.iter().map(|p| p.position.dot(up)).sum::<f32>();
        let (y, z) = (height(&at(&upwards, 9.0), Vec3::Y), height(&at(&along_z, 9.0), Vec3::Z));
        assert!((y - z).abs() < 1e-3 * y, "{y} {z}");
        assert!(Emitter { up: Vec3::ZERO, ..upwards }.validate(String::new).is_err());
    }

    #[test]
    fn births_and_deaths_are_invisible() {
        for particle in at(&Emitter::default(), 20.0) {
            assert!(particle.amount <= 0.3 * smoothstep_unit(particle.age / 0.12) + 1e-6);
            assert!(particle.age < 0.98 || particle.amount < 0.01);
        }
    }

    #[test]
    fn smoke_ends_after_emission_has_ended() {
        let emitter = Emitter { duration: 0.5, rate: 100.0, ..Emitter::default() };
        assert!(at(&emitter, -1.0).is_empty());
        assert!((48..=50).contains(&at(&emitter, 0.6).len()));
        assert!(at(&emitter, 60.0).is_empty());
    }

    #[test]
    fn drag_integrals_are_continuous_where_the_series_takes_over() {
        for t in [0.1, 1.0, 10.0] {
            let (series, closed) = (drag_integrals(0.499_999 / t, t), drag_integrals(0.500_001 / t, t));
            assert!((series.x - closed.x).abs() < 2e-6 * t && (series.y - closed.y).abs() < 2e-6 * t * t);
        }
    }

    /// Emitters of all kinds.
    fn emitters() -> impl Iterator<Item = Emitter> {
        let base = Emitter { rate: 400.0, ..Emitter::default() };
        [
            base,
            Emitter {
                shape: EmitterShape::Disc,
                up: Vec3::new(1.0, 2.0, 0.3),
                extent: Vec3::new(2.0, 0.0, 1.0),
                ..base
            },
            Emitter { shape: EmitterShape::Box, wind: Vec3::new(3.0, 0.0, -1.0), drag: 4.0, ..base },
            Emitter { burst: 8.0, duration: 0.1, drag: 2.0, velocity: Vec3::ZERO, ..base },
            Emitter { burst: -3.0, turbulence: 4.0, turbulence_scale: 0.3, drag: 0.0, buoyancy: -2.0, ..base },
            Emitter { radius_start: 2.0, radius_end: 0.1, lifetime_spread: 0.9, velocity_spread: 5.0, ..base },
            Emitter { duration: 0.3, period: 0.7, ..base },
            Emitter {
                bounce: 0.6,
                floor: -0.4,
                velocity: Vec3::new(-1.0, 3.0, 0.5),
                wind: Vec3::new(2.0, 0.0, 0.0),
                buoyancy: -9.8,
                drag: 0.3,
                ..base
            },
        ]
        .into_iter()
    }

    #[test]
    fn velocity_is_the_change_of_position() {
        // Without turbulence, whose change from place to place does not count, and between bounces.
        for emitter in emitters().filter(|emitter| emitter.bounce <= 0.0) {
            let emitter = Emitter { turbulence: 0.0, frame_rate: 0.0, ..emitter };
            let step = 1.0e-3;
            let (before, now) = (at(&emitter, 0.08), at(&emitter, 0.08 + step));
            // A still flipbook frame is another in each particle.
            let pairs =
                before.iter().filter_map(|a| Some((a, now.iter().find(|b| b.frame.to_bits() == a.frame.to_bits())?)));
            let mut count = 0;
            for (a, b) in pairs {
                let error = ((b.position - a.position) / step - a.velocity).length();
                assert!(error < 0.02 * (1.0 + a.velocity.length()), "{emitter:?}: {error} of {}", a.velocity);
                count += 1;
            }
            assert!(count > 20, "{emitter:?}: {count}");
        }
    }

    #[test]
    fn pulses_repeat_and_each_is_born_in_its_turn() {
        let emitter = Emitter { rate: 100.0, duration: 0.2, period: 1.0, lifetime: 0.5, ..Emitter::default() };
        let emitter = Emitter { lifetime_spread: 0.0, ..emitter };
        let count = |time| at(&emitter, time).len();
        assert_eq!((count(-0.1), count(0.9), count(7.8)), (0, 0, 0));
        assert!((18..=20).contains(&count(0.3)) && (18..=20).contains(&count(7.3)), "{} {}", count(0.3), count(7.3));
        assert!((8..=12).contains(&count(3.1)), "{}", count(3.1));
        // Other random numbers in each pulse.
        assert_ne!(at(&emitter, 0.3)[3].position, at(&emitter, 1.3)[3].position);
        // Long lives: particles of several pulses.
        let long = Emitter { lifetime: 2.7, ..emitter };
        let alive = at(&long, 9.5).len() as f64;
        assert!((54.0..=60.0).contains(&alive) && alive <= long.max_alive(), "{alive} of {}", long.max_alive());
        let error = Emitter { period: 0.1, ..emitter }.validate(|| "e".into()).unwrap_err().to_string();
        assert_eq!(error, "e.period: 0.1 is not valid; expected 0, or at least the duration of 0.2 s");
    }

    #[test]
    fn particles_bounce_off_the_floor_and_come_to_rest() {
        let emitter = Emitter {
            bounce: 0.5,
            buoyancy: -9.81,
            drag: 0.0,
            extent: Vec3::ZERO,
            velocity: Vec3::new(1.0, 0.0, 0.0),
            velocity_spread: 0.0,
            turbulence: 0.0,
            position: Vec3::new(0.0, 1.0, 0.0),
            lifetime: 5.0,
            lifetime_spread: 0.0,
            fade_in: 0.0,
            fade_out: 0.0,
            rate: 1000.0,
            ..Emitter::default()
        };
        let mut tops = [0.0_f32; 4];
        for particle in at(&emitter, 20.0) {
            assert!(particle.position.y > -1.0e-3, "{particle:?}");
            let seconds = particle.age * 5.0;
            // A fall of 1 m takes 0.45 s; each further arc has half the speed of the one before.
            let bounces = [0.452, 0.904, 1.13, 1.243].iter().filter(|time| seconds > **time).count();
            if let Some(top) = tops.get_mut(bounces) {
                *top = top.max(particle.position.y);
            } else {
                assert_eq!(particle.velocity, Vec3::ZERO, "{seconds}");
            }
        }
        for (top, expected) in tops.iter().zip([1.0, 0.25, 0.0625, 0.0156]) {
            assert!((top - expected).abs() < 0.01 * expected + 1.0e-3, "{tops:?}");
        }
    }

    #[test]
    fn box_of_an_emission_contains_its_particles() {
        let mut stretched = Settings::default();
        (stretched.sprite.stretch, stretched.sprite.stretch_limit) = (0.2, 20.0);
        for extent in [Settings::default(), stretched].map(|settings| SpriteExtent::of(&settings)) {
            for emitter in emitters() {
                for time in [0.0, 0.05, 1.0, 3.0, 50.0] {
                    let (measured, promised) =
                        (particle_bounds(&at(&emitter, time), extent), emitter.snapshot(time).bounds(extent));
                    if at(&emitter, time).is_empty() {
                        continue;
                    }
                    let holds = promised.min.cmple(measured.min).all() && promised.max.cmpge(measured.max).all();
                    assert!(holds, "{emitter:?} at {time}: {measured:?} in {promised:?}");
                }
            }
        }
    }

    #[test]
    fn sample_represents_all_particles_and_stays_the_same() {
        let emitter = Emitter { rate: 20_000.0, lifetime: 5.0, lifetime_spread: 0.0, ..Emitter::default() };
        let few = |time| {
            let mut particles = Vec::new();
            emitter.snapshot(time).sample(&mut particles);
            particles
        };
        let (all, now, soon) = (at(&emitter, 9.0), few(9.0), few(9.0004));
        assert!((900..=1100).contains(&now.len()), "{}", now.len());
        let mean = |particles: &[Particle]| particles.iter().map(|p| p.position).sum::<Vec3>() / particles.len() as f32;
        assert!((mean(&all) - mean(&now)).length() < 0.1);
        // Except for a birth or a death.
        let same = |a: &&Particle| soon.iter().any(|b| a.position.distance(b.position) < 0.002);
        assert!(now.iter().filter(same).count() >= now.len() - 2);
    }

    #[test]
    fn too_many_particles_are_refused() {
        let emitter = Emitter { rate: 100_000.0, lifetime: 600.0, ..Emitter::default() };
        let error = emitter.validate(|| "systems[0].emitter".into()).unwrap_err();
        let expected = "at this rate, 72000000 particles are alive at once; expected at most 1048576";
        assert_eq!(error.to_string(), format!("systems[0].emitter.rate: {expected}"));
        Emitter { duration: 0.1, ..emitter }.validate(String::new).unwrap();
    }
}
