//! Seekable emitter: every particle is a function of (seed, birth index, time).
//!
//! A flow carries the particles: each path is integrated from its birth, in a fixed number of steps. There is no simulation
//! state, so time can be scrubbed, frames can be rendered in any order, and two images can be compared. The arithmetic is
//! integer hashes and plain f32, in `emitter.rs`, `flight.rs` and `flow.rs` of `src/formula/` and, for GPUs, `shaders/lib/`.

use std::f32::consts::TAU;

use glam::{DVec3, Quat, Vec3};

use crate::error::FieldError;
use crate::formula::curve::curve_integral;
use crate::formula::flight::{Flight, flight};
use crate::formula::flow::FLOW_STEPS;
use crate::formula::uniforms::EmitterUniform;
use crate::frame::{EmitterSnapshot, Particle};
use crate::settings::{Curve, choice, settings, validate};

/// Maximum number of particles of one emitter, and of all emitters of a preset together.
pub const MAX_PARTICLES: u32 = 1 << 20;

/// Approximate number of particles in a sample.
const SAMPLE: f64 = 1024.0;

choice! {
    /// Shape in which particles are born.
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
        /// Size of all of it: distances grow by this, times and speeds by its square root, as large fires burn slower. Lengths
        /// below are those at 1. `position`, `floor`, `attractor` and the obstacle stay.
        size: f32 = 1.0, number(0.01..=100.0, "");
        /// Births per second. Higher: denser and smoother smoke, at the cost of more sprites.
        rate: f32 = 40.0, number(0.0..=100_000.0, "1/s");
        /// Seconds of emission, from time 0. 0: emission has no beginning and no end.
        duration: f32 = 0.0, number(0.0..=3600.0, "s");
        /// Fraction of the births that happen, over the emission: from its beginning, at 0, to its end after `duration`, at 1.
        /// A blast that dies down, a chimney that swells.
        #[cfg_attr(feature = "schema", schemars(with = "Vec<[f32; 2]>"))]
        rate_curve: Curve = Curve::constant(1.0), curve(0.0..=1.0);
        /// Seconds from the beginning of one emission to the next: puffs of a chimney, shots. At least `duration`. 0: one
        /// emission only.
        period: f32 = 0.0, number(0.0..=3600.0, "s");
        /// Seconds that a particle lives. Higher: the smoke gets further before it disappears.
        lifetime: f32 = 6.0, number(0.01..=600.0, "s");
        /// Random variation of the lifetime, up and down, as a fraction of it. At 0 the smoke ends along a line.
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
        /// Fraction of their speed that particles keep when they hit the floor, three times at most: sparks, embers, hail. 0:
        /// they do not bounce.
        bounce: f32 = 0.0, number(0.0..=0.95, "");
        /// Height above the floor below which smoke turns aside: it flows along the floor, away from `position`. 0: it falls
        /// through. About the size of the smoke, so that it turns gradually.
        floor_margin: f32 = 0.0, number(0.0..=100.0, "m");
        /// Height of the floor along `up`, from the origin of the world.
        floor: f32 = 0.0, number(-1.0e5..=1.0e5, "m");
        /// Velocity of the air. Leans the smoke over.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        wind: Vec3 = Vec3::ZERO, vector(-100.0..=100.0, "m/s");
        /// Multiplies the speed by age. Below 1: particles move as in slow motion along the same path. 0: they stand still.
        #[cfg_attr(feature = "schema", schemars(with = "Vec<[f32; 2]>"))]
        speed_curve: Curve = Curve::constant(1.0), curve(0.0..=10.0);
        "turbulence":
        /// Distance that swirls of the air carry a particle in its life, about. Higher: billows, and smoke that tears apart. More
        /// than 1.2 times `turbulence_scale` does no more; with much `turbulence_detail`, somewhat less.
        turbulence: f32 = 0.5, number(0.0..=100.0, "m");
        /// Size of the largest swirls; there are some of half and of a quarter of it. Lower: frays the smoke. Higher: bends all
        /// of it.
        turbulence_scale: f32 = 1.5, number(0.01..=1.0e3, "m");
        /// Strength of swirls of half the size, as a fraction of the strength of the larger ones. Higher: wisps. 0: only large
        /// billows.
        turbulence_detail: f32 = 0.6, number(0.0..=1.0, "");
        /// Fraction of the smoke's mean velocity with which the swirls travel. 1: they ride with the smoke. 0: they stand, and
        /// the smoke passes through them.
        turbulence_travel: f32 = 1.0, number(0.0..=1.0, "");
        /// Turns of the swirls per second. Higher: restless smoke.
        turbulence_speed: f32 = 0.05, number(0.0..=10.0, "1/s");
        "flow":
        /// Rolling rings that leave the source per second: puffs whose caps roll up, as over a fire or from a chimney.
        ring_rate: f32 = 1.0, number(0.01..=100.0, "1/s");
        /// Speed in the middle of a ring at birth, beyond that of the smoke. Higher: smoke rolls up more. 0: there are no rings.
        /// More than 40 times `ring_size` / `lifetime` does no more.
        ring_speed: f32 = 0.0, number(0.0..=1.0e3, "m/s");
        /// Radius of a ring at birth; it widens on its way. About that of the source: all of the smoke rolls. Lower: its middle
        /// breaks through.
        ring_size: f32 = 0.4, number(0.01..=1.0e3, "m");
        /// Growth of the wind per metre of height above the source. Bends the smoke more the higher it is. A part along `up` has
        /// no effect.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        wind_shear: Vec3 = Vec3::ZERO, vector(-10.0..=10.0, "1/s");
        /// Turns per second about the axis through `position` along `up`, which the wind carries along: a whirl. Below 0: the
        /// other way around.
        orbit: f32 = 0.0, number(-10.0..=10.0, "1/s");
        /// Speed at which the smoke is drawn to the attractor. Below 0: it is pushed away, and flows around it.
        attraction: f32 = 0.0, number(-100.0..=100.0, "m/s");
        /// Point that draws the smoke.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        attractor: Vec3 = Vec3::ZERO, vector(-1.0e5..=1.0e5, "m");
        /// Distance from the attractor within which the pull grows weaker. Lower: smoke gathers in a point.
        attractor_size: f32 = 0.5, number(0.01..=1.0e3, "m");
        /// Distance from the obstacle below which smoke turns aside and flows around it: a crate, a beam, a wall. Rounds its edges
        /// for the smoke. About the size of the smoke, so that it turns gradually. 0: there is no obstacle.
        obstacle_margin: f32 = 0.0, number(0.0..=100.0, "m");
        /// Middle of the obstacle, a box along the axes of the world.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        obstacle: Vec3 = Vec3::ZERO, vector(-1.0e5..=1.0e5, "m");
        /// Half the size of the obstacle. Flat: a wall or a table.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        obstacle_extent: Vec3 = Vec3::splat(0.5), vector(0.0..=1.0e4, "m");
        "radius":
        /// Radius at birth: thickness of the smoke at its root.
        radius_start: f32 = 0.25, number(0.0..=1.0e3, "m");
        /// Radius at death. Higher: smoke spreads wider and looks softer; cost grows with its square.
        radius_end: f32 = 1.2, number(0.0..=1.0e3, "m");
        /// Random variation of the radius, up and down, as a fraction of it. Higher: less uniform puffs.
        radius_spread: f32 = 0.25, number(0.0..=0.95, "");
        /// Fraction of the particles that are small: wisps among the puffs.
        small_fraction: f32 = 0.0, number(0.0..=1.0, "");
        /// Radius of a small particle, as a fraction of that of the others.
        small_size: f32 = 0.4, number(0.01..=1.0, "");
        /// Multiplies the radius by age. With `radius_start` and `radius_end` alike, it is the size over the life.
        #[cfg_attr(feature = "schema", schemars(with = "Vec<[f32; 2]>"))]
        size_curve: Curve = Curve::constant(1.0), curve(0.0..=10.0);
        /// Fraction of the radius by which a particle is moved up, along `up`. 1: its lower edge stays where it was born while
        /// it grows, as a flame on its wick.
        anchor: f32 = 0.0, number(0.0..=1.0, "");
        "appearance":
        /// Random rotation at birth, as a fraction of a turn. 0: upright.
        rotation_spread: f32 = 1.0, number(0.0..=1.0, "");
        /// Fastest spin at birth, either way; drag slows it. Normals and light turn with the sprite.
        spin: f32 = 0.6, number(0.0..=100.0, "rad/s");
        /// Amount of a full-grown particle: fraction of the background that one sprite hides. A lower amount with more
        /// sprites is smoother.
        amount: f32 = 0.3, number(0.0..=1.0, "");
        /// Fraction of the life over which a particle fades in. At 0 sprites pop in.
        fade_in: f32 = 0.12, number(0.0..=1.0, "");
        /// Fraction of the life over which a particle fades out. At 0 sprites pop out; at 1 the top of the smoke is thin.
        fade_out: f32 = 0.5, number(0.0..=1.0, "");
        /// Multiplies the amount by age. With `fade_in` and `fade_out` at 0, it is the amount over the life: smoke that thins
        /// and thickens again.
        #[cfg_attr(feature = "schema", schemars(with = "Vec<[f32; 2]>"))]
        amount_curve: Curve = Curve::constant(1.0), curve(0.0..=10.0);
        /// Flipbook frames per second. Higher: puffs boil faster. 0: still.
        frame_rate: f32 = 4.0, number(0.0..=120.0, "frames/s");
        /// Linear RGB color of the particles. Each has one at random between this and `other_tint`. Read if `sprite.tint` is
        /// above 0.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        tint: Vec3 = Vec3::ONE, color(0.0..=1.0);
        /// The other end of the particles' colors: dust of red ground in gray smoke.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        other_tint: Vec3 = Vec3::ONE, color(0.0..=1.0);
        /// Fraction by which the coldest particles of the same age are colder than the hottest. Higher: sooty puffs between the
        /// flames. Read if the system burns.
        heat_spread: f32 = 0.0, number(0.0..=1.0, "");
    }
}

/// Way through swirls per `turbulence`, as a root mean square along an axis: less than this is left of it at the end,
/// because swirls carry smoke to and fro.
const SWIRL_WAY: f32 = 2.0;
/// Simplices of the noise per `turbulence_scale`: the flow turns around within one.
const SWIRL_SIMPLICES: f32 = 0.57;

/// Most strain of the smoke in its life, in `turbulence` per `turbulence_scale` of one octave: beyond it a path depends on the
/// last bits of its beginning, and would jump from frame to frame.
const MAX_SWIRL_STRAIN: f32 = 2.0;

/// Most way of the middle of a ring in a life, in its radii at birth: beyond it, smoke turns too far in a step.
const MAX_RING_ROLL: f32 = 40.0;
/// Most way that the attractor draws smoke in a life, in its size: beyond it, smoke would pass it in a step.
const MAX_ATTRACTION: f32 = 0.8 * FLOW_STEPS as f32;

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

    /// Maximum number of particles that live at once, if all births happen.
    pub fn max_alive(&self) -> f64 {
        let longest = self.longest();
        let duration = f64::from(self.duration);
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

    /// Births of an emission that ends; 0 for one that does not.
    fn births(&self) -> i64 {
        // Less the rounding of f32, which would add a birth.
        (f64::from(self.duration) * f64::from(self.rate) - 1.0e-3).ceil() as i64
    }

    /// Returns the pulses of an emission that repeats.
    fn pulses(&self) -> Option<Pulses> {
        let births = self.births();
        (births > 0 && self.period > 0.0).then_some(Pulses { births, period: f64::from(self.period) })
    }

    /// Replaces `particles` with those alive at `time`, seconds. The same input gives the same output, to the bit.
    pub fn evaluate(&self, time: f64, particles: &mut Vec<Particle>) {
        self.snapshot(time).evaluate(particles);
    }

    /// Replaces `displacements` with the way of each particle of [`evaluate`](Self::evaluate) in the next `seconds`, in metres
    /// and in the same order: for motion vectors, which [`Particle::velocity`](Particle) gives for a moment only. Particles
    /// that die before are taken to fly on.
    pub fn displacements(&self, time: f64, seconds: f32, displacements: &mut Vec<Vec3>) {
        let now = self.snapshot(time);
        // The flow of then, the births of now.
        let later = EmitterUniform {
            first: now.uniform.first,
            count: now.uniform.count,
            first_in_pulse: now.uniform.first_in_pulse,
            since_first: now.uniform.since_first + seconds,
            ..self.snapshot(time + f64::from(seconds)).uniform
        };
        displacements.clear();
        displacements.extend(now.displacements(&later, seconds));
    }

    /// The same emitter at a size of 1: lengths, times and speeds are those of its smoke.
    fn sized(&self) -> Emitter {
        let size = self.size;
        let slower = size.sqrt();
        Emitter {
            size: 1.0,
            rate: self.rate / slower,
            duration: self.duration * slower,
            period: self.period * slower,
            lifetime: self.lifetime * slower,
            extent: self.extent * size,
            velocity: self.velocity * slower,
            burst: self.burst * slower,
            velocity_spread: self.velocity_spread * slower,
            drag: self.drag / slower,
            wind: self.wind * slower,
            turbulence: self.turbulence * size,
            turbulence_scale: self.turbulence_scale * size,
            turbulence_speed: self.turbulence_speed / slower,
            ring_rate: self.ring_rate / slower,
            ring_speed: self.ring_speed * slower,
            ring_size: self.ring_size * size,
            wind_shear: self.wind_shear / slower,
            orbit: self.orbit / slower,
            attraction: self.attraction * slower,
            attractor_size: self.attractor_size * size,
            radius_start: self.radius_start * size,
            radius_end: self.radius_end * size,
            floor_margin: self.floor_margin * size,
            obstacle_margin: self.obstacle_margin * size,
            spin: self.spin / slower,
            frame_rate: self.frame_rate / slower,
            ..*self
        }
    }

    /// Particles alive at `time`, seconds, not evaluated, for `Particles::Emitter`.
    pub fn snapshot(&self, time: f64) -> EmitterSnapshot {
        self.sized().snapshot_of_sized(time)
    }

    /// [`snapshot`](Self::snapshot) of an emitter whose size is 1.
    fn snapshot_of_sized(&self, time: f64) -> EmitterSnapshot {
        let (first, last) = self.birth_range(time);
        let pulses = self.pulses();
        // An emission that ends is one pulse; one without an end has a single pulse that begins with the first birth.
        let (per_pulse, first_in_pulse) = match self.births() {
            births @ 1.. => (births, if pulses.is_some() { first.rem_euclid(births) } else { first }),
            _ => (i64::from(u32::MAX), 0),
        };
        let period = pulses.map_or(0.0, |pulses| pulses.period);
        let born = match pulses {
            Some(_) => first.div_euclid(per_pulse) as f64 * period + first_in_pulse as f64 / f64::from(self.rate),
            None => first as f64 / f64::from(self.rate),
        };
        let up = self.up.normalize_or(Vec3::Y);
        let disc = Quat::from_rotation_arc(Vec3::Y, up);
        let turn = (time * f64::from(self.turbulence_speed)).rem_euclid(1.0);
        // Three octaves, whose strengths and strains add up as variances.
        let octaves = |ratio: f32| (1.0 + ratio.powi(2) + ratio.powi(4)).sqrt();
        let most = MAX_SWIRL_STRAIN * self.turbulence_scale / octaves(2.0 * self.turbulence_detail);
        let strength = SWIRL_WAY * (self.turbulence / octaves(self.turbulence_detail)).min(most);
        let rings = time * f64::from(self.ring_rate);
        let attractor_size = (self.attraction.abs() * self.lifetime / MAX_ATTRACTION).max(self.attractor_size);
        let has_flow = self.turbulence > 0.0
            || self.ring_speed > 0.0
            || self.attraction != 0.0
            || self.wind_shear != Vec3::ZERO
            || self.floor_margin > 0.0
            || self.obstacle_margin > 0.0;
        let rounding = self.obstacle_margin.min(self.obstacle_extent.min_element());
        let mut uniform = EmitterUniform {
            first: first as u32,
            count: (last - first) as u32,
            seed: self.seed,
            shape: self.shape as u32,
            // f64, because at 100 000 births a second f32 could not tell two births apart after three minutes.
            since_first: (time - born) as f32,
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
            swirl_strength: strength / self.lifetime,
            wind: self.wind,
            swirl_frequency: SWIRL_SIMPLICES / self.turbulence_scale,
            disc_x: disc * Vec3::X,
            radius_start: self.radius_start,
            disc_z: disc * Vec3::Z,
            radius_end: self.radius_end,
            swirl_turn: turn as f32 * TAU,
            swirl_turn_rate: self.turbulence_speed * TAU,
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
            per_pulse: per_pulse as u32,
            first_in_pulse: first_in_pulse as u32,
            period: period as f32,
            has_curves: u32::from([self.speed_curve, self.size_curve, self.amount_curve] != [Curve::constant(1.0); 3]),
            speed_curve: self.speed_curve.packed(),
            size_curve: self.size_curve.packed(),
            amount_curve: self.amount_curve.packed(),
            rate_curve: self.rate_curve.packed(),
            anchor: self.anchor,
            rotation_spread: self.rotation_spread,
            has_rate_curve: u32::from(self.rate_curve != Curve::constant(1.0) && self.duration > 0.0),
            swirl_detail: self.turbulence_detail,
            ring_rate: self.ring_rate,
            ring_phase: (rings - rings.floor()) as f32,
            ring_first: rings.floor() as i64 as u32,
            // Wind along `up` would grow without end.
            wind_shear: self.wind_shear.reject_from_normalized(up),
            ring_speed: self.ring_speed.min(MAX_RING_ROLL * self.ring_size / self.lifetime),
            attractor: self.attractor,
            attraction: self.attraction,
            ring_size: self.ring_size,
            attractor_size,
            orbit_rate: self.orbit * TAU,
            has_flow: u32::from(has_flow),
            small_fraction: self.small_fraction,
            small_size: self.small_size,
            floor_margin: self.floor_margin,
            obstacle_margin: self.obstacle_margin,
            obstacle: self.obstacle,
            obstacle_rounding: rounding,
            obstacle_core: self.obstacle_extent - rounding,
            ..EmitterUniform::default()
        };
        uniform.swirl_travel = self.turbulence_travel * self.mean_velocity(&uniform);
        // f64, because smoke that has blown for hours is many swirls away.
        let way = uniform.swirl_travel.as_dvec3() * (time * f64::from(uniform.swirl_frequency));
        let skewed = way + DVec3::splat(way.element_sum() / 3.0);
        let cell = (-skewed).floor();
        uniform.swirl_first = cell.as_ivec3();
        uniform.swirl_offset = (-skewed - cell).as_vec3();
        let step = (self.max_alive() / SAMPLE).ceil().max(1.0) as u32;
        let first_sample = (-first).rem_euclid(i64::from(step)) as u32;
        EmitterSnapshot { uniform, step, first_sample }
    }

    /// Velocity of a particle that is not scattered, on average over its life.
    fn mean_velocity(&self, uniform: &EmitterUniform) -> Vec3 {
        let start = Flight { position: Vec3::ZERO, velocity: self.velocity };
        let flown = self.lifetime * curve_integral(&uniform.speed_curve, 1.0);
        flight(uniform, &start, flown).position / self.lifetime
    }

    /// Range of birth indices that may be alive at `time`. Birth i happens at i / rate, in pulses at so much after the
    /// beginning of its pulse.
    fn birth_range(&self, time: f64) -> (i64, i64) {
        if self.rate <= 0.0 {
            return (0, 0);
        }
        let rate = f64::from(self.rate);
        let longest = self.longest();
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
            last = last.min(self.births());
        }
        (first, last.max(first))
    }
}

#[cfg(test)]
mod tests;
