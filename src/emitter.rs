//! A seekable emitter: every particle is a closed-form function of (seed, birth index, time).
//!
//! Nothing is stepped, so time can be scrubbed, frames rendered in any order, and two pictures compared. The arithmetic
//! is integer hashes and plain f32, shaped so that a compute shader can evaluate one particle per invocation.

use glam::{Quat, UVec3, Vec2, Vec3};

use crate::assets::noise::{curl_noise, pcg3d, unit};
use crate::error::FieldError;
use crate::frame::Particle;
use crate::settings::{choice, settings, validate};

/// Most particles of one emitter, and of all emitters of a preset together.
pub const MAX_PARTICLES: u32 = 1 << 20;

choice! {
    /// Where particles are born.
    EmitterShape {
        /// In an ellipsoid.
        #[default]
        Sphere = "sphere",
        /// In a box.
        Box = "box",
        /// On a flat disc across `up`, its extent's x and z.
        Disc = "disc",
    }
}

settings! {
    /// All settings of an emitter. Positions and velocities in world space.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Emitter {
        "birth":
        /// Different seeds give different smoke of the same kind.
        seed: u32 = 1, seed;
        /// Births per second. More makes it denser and smoother, for the cost of as many sprites.
        rate: f32 = 40.0, number(0.0..=100_000.0, "1/s");
        /// Seconds of emission, from time 0. 0: it has always been smoking and never stops.
        duration: f32 = 0.0, number(0.0..=3600.0, "s");
        /// Seconds a particle lives: how far the smoke gets before it is gone.
        lifetime: f32 = 6.0, number(0.01..=600.0, "s");
        /// Share of the lifetime by which lives differ, up and down. Without any the smoke ends along a line.
        lifetime_spread: f32 = 0.2, number(0.0..=0.95, "");
        /// Where particles are born.
        shape: EmitterShape = EmitterShape::Sphere, choice;
        /// Middle of the shape: where the smoke begins.
        #[cfg_attr(feature = "app", schemars(with = "[f32; 3]"))]
        position: Vec3 = Vec3::ZERO, vector(-1.0e5..=1.0e5, "m");
        /// Half the size of the shape: from a jet to a carpet of smoke.
        #[cfg_attr(feature = "app", schemars(with = "[f32; 3]"))]
        extent: Vec3 = Vec3::splat(0.2), vector(0.0..=1.0e4, "m");
        "motion":
        /// Velocity at birth: the thrust of a vent. Drag soon turns it into the air's.
        #[cfg_attr(feature = "app", schemars(with = "[f32; 3]"))]
        velocity: Vec3 = Vec3::new(0.0, 0.6, 0.0), vector(-1.0e3..=1.0e3, "m/s");
        /// Speed at birth away from the middle of the shape: a blast.
        burst: f32 = 0.0, number(-1.0e3..=1.0e3, "m/s");
        /// Random speed at birth, any direction: frays the root of the smoke.
        velocity_spread: f32 = 0.2, number(0.0..=1.0e3, "m/s");
        /// How fast a particle takes on the velocity of the air: more stops a jet sooner and lets wind bend it.
        drag: f32 = 0.6, number(0.0..=100.0, "1/s");
        /// Upward acceleration of hot smoke; against the drag it ends in a steady rise of buoyancy / drag.
        buoyancy: f32 = 0.6, number(-100.0..=100.0, "m/s²");
        /// The way up, along which hot smoke rises and across which a disc lies; need not be unit length.
        #[cfg_attr(feature = "app", schemars(with = "[f32; 3]"))]
        up: Vec3 = Vec3::Y, vector(-1.0e3..=1.0e3, "");
        /// Velocity of the air: leans the smoke over.
        #[cfg_attr(feature = "app", schemars(with = "[f32; 3]"))]
        wind: Vec3 = Vec3::ZERO, vector(-100.0..=100.0, "m/s");
        "turbulence":
        /// How far curl noise carries a particle off its path by the end of its life. More tears the smoke apart.
        turbulence: f32 = 0.5, number(0.0..=100.0, "m");
        /// Size of the swirls: small ones fray the smoke, large ones bend the whole of it.
        turbulence_scale: f32 = 1.5, number(0.01..=1.0e3, "m");
        /// Turns of the swirls per second: how restless the smoke is.
        turbulence_speed: f32 = 0.05, number(0.0..=10.0, "1/s");
        "size":
        /// Radius at birth: how thick the root of the smoke is.
        radius_start: f32 = 0.25, number(0.0..=1.0e3, "m");
        /// Radius at death: how wide the smoke spreads, and how soft it looks. Cost grows with its square.
        radius_end: f32 = 1.2, number(0.0..=1.0e3, "m");
        /// Share by which radii differ, up and down. A mix looks less blobby.
        radius_spread: f32 = 0.25, number(0.0..=0.95, "");
        "appearance":
        /// Fastest spin, either way, at birth; drag slows it. Normals and light turn with it.
        spin: f32 = 0.6, number(0.0..=100.0, "rad/s");
        /// Amount of a full-grown particle: how much of what is behind one sprite hides. Less of more sprites is smoother.
        amount: f32 = 0.3, number(0.0..=1.0, "");
        /// Share of the life over which a particle appears. At 0 sprites pop in.
        fade_in: f32 = 0.12, number(0.0..=1.0, "");
        /// Share of the life over which it disappears. At 0 they pop out; at 1 the top is thin.
        fade_out: f32 = 0.5, number(0.0..=1.0, "");
        /// Flipbook frames per second. 0: still.
        frame_rate: f32 = 4.0, number(0.0..=120.0, "frames/s");
    }
}

impl Emitter {
    /// Checks ranges, and that no more than [`MAX_PARTICLES`] live at once. `path` is put before the field's name.
    ///
    /// # Errors
    /// The first field that is not valid.
    pub fn validate(&self, path: impl Fn() -> String) -> Result<(), FieldError> {
        validate(self, &path)?;
        if self.up.normalize_or_zero() == Vec3::ZERO {
            return Err(FieldError::new(format!("{}.up", path()), self.up, "a direction that is not zero"));
        }
        let most = self.most_alive();
        if most > f64::from(MAX_PARTICLES) {
            let expected = format!("at most {MAX_PARTICLES} particles alive at once, not {most:.0}");
            return Err(FieldError::new(format!("{}.rate", path()), self.rate, expected));
        }
        Ok(())
    }

    /// How many particles may live at once.
    pub fn most_alive(&self) -> f64 {
        let longest = f64::from(self.lifetime * (1.0 + self.lifetime_spread));
        f64::from(self.rate) * if self.duration > 0.0 { longest.min(f64::from(self.duration)) } else { longest }
    }

    /// Writes the particles alive at `time`, seconds. Same input, same output, to the bit.
    pub fn evaluate(&self, time: f32, particles: &mut Vec<Particle>) {
        particles.clear();
        let (first, last) = self.births(time);
        particles.extend((first..last).filter_map(|index| self.particle(index, time)));
    }

    /// Range of birth indices that may be alive at `time`; index i is born at i / rate.
    fn births(&self, time: f32) -> (i64, i64) {
        // f64: at 100 000 births a second f32 could not tell two apart after three minutes.
        let (time, rate) = (f64::from(time), f64::from(self.rate));
        let longest = f64::from(self.lifetime * (1.0 + self.lifetime_spread));
        let mut first = ((time - longest) * rate).floor() as i64;
        let mut last = (time * rate).floor() as i64 + 1;
        if self.duration > 0.0 {
            first = first.max(0);
            last = last.min((f64::from(self.duration) * rate).ceil() as i64);
        }
        (first, last.max(first))
    }

    /// The particle of a birth index, if it is alive at `time`.
    fn particle(&self, index: i64, time: f32) -> Option<Particle> {
        let random = |salt: u32| {
            let hash = pcg3d(UVec3::new(index as u32, salt, self.seed));
            Vec3::new(unit(hash.x), unit(hash.y), unit(hash.z))
        };
        // Births are jittered within their interval, or a fast emitter would pulse.
        let (life, place, motion, look) = (random(0), random(1), random(2), random(3));
        let birth = (index as f64 + f64::from(life.y)) / f64::from(self.rate);
        let seconds = (f64::from(time) - birth) as f32;
        let lifetime = self.lifetime * (1.0 + self.lifetime_spread * (2.0 * life.x - 1.0));
        if !(0.0..lifetime).contains(&seconds) {
            return None;
        }
        let age = seconds / lifetime;

        let offset = self.birth_offset(place);
        let velocity = self.velocity
            + offset.normalize_or_zero() * self.burst
            + unit_sphere(motion) * (self.velocity_spread * life.z);
        // v' = drag·(wind − v) + buoyancy, solved: position and spin approach their limits as 1 − e^(−drag·t).
        let (reached, approached) = drag_integrals(self.drag, seconds);
        let rise = self.up.normalize_or(Vec3::Y) * self.buoyancy;
        let path = velocity * reached + self.wind * (seconds - reached) + rise * approached;
        let base = self.position + offset + path;

        // Swirls grow with age: smoke leaves the source smooth and breaks up on the way.
        let phase = Vec2::from_angle(time * self.turbulence_speed * std::f32::consts::TAU);
        let swirl = curl_noise(base / self.turbulence_scale, phase, self.seed.wrapping_mul(977))
            + curl_noise(base * (2.3 / self.turbulence_scale), phase, self.seed.wrapping_mul(977).wrapping_add(5))
                * 0.4;
        let position = base + swirl * (self.turbulence * age);

        // Growth like diffusion: fast at first.
        let radius = self.radius_start + (self.radius_end - self.radius_start) * age.sqrt();
        let fade_in = smooth(age / self.fade_in.max(1.0e-4));
        let fade_out = smooth((1.0 - age) / self.fade_out.max(1.0e-4));
        Some(Particle {
            position,
            radius: radius * (1.0 + self.radius_spread * (2.0 * look.x - 1.0)),
            rotation: look.y * std::f32::consts::TAU + self.spin * (2.0 * look.z - 1.0) * reached,
            amount: self.amount * fade_in * fade_out,
            frame: place.x * 256.0 + seconds * self.frame_rate,
            age,
        })
    }

    fn birth_offset(&self, random: Vec3) -> Vec3 {
        match self.shape {
            EmitterShape::Box => (random * 2.0 - 1.0) * self.extent,
            EmitterShape::Sphere => unit_sphere(random) * self.extent * random.x.cbrt(),
            EmitterShape::Disc => {
                let direction = Vec2::from_angle(random.y * std::f32::consts::TAU) * random.z.sqrt();
                let level = Vec3::new(direction.x, 0.0, direction.y) * self.extent;
                Quat::from_rotation_arc(Vec3::Y, self.up.normalize_or(Vec3::Y)) * level
            }
        }
    }
}

/// A direction, evenly distributed. Uses y and z, so that x is free for a distance.
fn unit_sphere(random: Vec3) -> Vec3 {
    let z = random.z * 2.0 - 1.0;
    let xy = Vec2::from_angle(random.y * std::f32::consts::TAU) * (1.0 - z * z).sqrt();
    Vec3::new(xy.x, z, xy.y)
}

/// ∫ e^(−k·s) ds and ∫∫ e^(−k·s) ds over 0..t: what is left of a velocity, and of an acceleration, under drag k.
fn drag_integrals(drag: f32, t: f32) -> (f32, f32) {
    let kt = drag * t;
    if kt < 1.0e-2 {
        // The closed forms cancel near 0; two terms of their series are exact to f32 here.
        return (t * (1.0 - 0.5 * kt), 0.5 * t * t * (1.0 - kt / 3.0));
    }
    let reached = (1.0 - (-kt).exp()) / drag;
    (reached, (t - reached) / drag)
}

fn smooth(x: f32) -> f32 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(emitter: &Emitter, time: f32) -> Vec<Particle> {
        let mut particles = Vec::new();
        emitter.evaluate(time, &mut particles);
        particles
    }

    #[test]
    fn any_time_can_be_had_in_any_order() {
        let emitter = Emitter::default();
        let later = at(&emitter, 30.0);
        assert_eq!(later, at(&emitter, 30.0));
        let _ = at(&emitter, 1.0);
        assert_eq!(later, at(&emitter, 30.0));
        assert!(later.iter().all(Particle::is_valid));
        // Rate times lifetime, give or take the jitter.
        assert!((200..=280).contains(&later.len()), "{}", later.len());
    }

    #[test]
    fn every_seed_is_as_good_as_the_next() {
        // The second times 977 is the last word there is.
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
        // x becomes y, y becomes z, z becomes x.
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
            assert!(particle.amount <= 0.3 * smooth(particle.age / 0.12) + 1e-6);
            assert!(particle.age < 0.98 || particle.amount < 0.01);
        }
    }

    #[test]
    fn emission_ends_and_the_smoke_with_it() {
        let emitter = Emitter { duration: 0.5, rate: 100.0, ..Emitter::default() };
        assert!(at(&emitter, -1.0).is_empty());
        assert!((48..=50).contains(&at(&emitter, 0.6).len()));
        assert!(at(&emitter, 60.0).is_empty());
    }

    #[test]
    fn drag_integrals_are_continuous_where_the_series_takes_over() {
        for t in [0.1, 1.0, 10.0] {
            let (series, closed) = (drag_integrals(0.0099 / t, t), drag_integrals(0.0101 / t, t));
            assert!((series.0 - closed.0).abs() < 2e-4 * t && (series.1 - closed.1).abs() < 2e-4 * t * t);
        }
    }

    #[test]
    fn too_many_particles_are_refused() {
        let emitter = Emitter { rate: 100_000.0, lifetime: 600.0, ..Emitter::default() };
        let error = emitter.validate(|| "systems[0].emitter".into()).unwrap_err();
        assert!(error.to_string().starts_with("systems[0].emitter.rate: 100000"), "{error}");
        Emitter { duration: 0.1, ..emitter }.validate(String::new).unwrap();
    }
}
