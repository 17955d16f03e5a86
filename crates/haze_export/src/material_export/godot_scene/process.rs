//! An emitter in terms of Godot's ParticleProcessMaterial and GPUParticles3D.

use std::f32::consts::TAU;

use glam::Vec3;
use haze::MaterialAssets;
use haze_core::emitter::EmitterShape;
use haze_core::formula::curve::{curve_integral, curve_value, smoothstep_unit};
use haze_core::formula::emitter::rotation_at_birth;
use haze_core::formula::flight::{Flight, drag_integrals, pace_at, paced_flight};
use haze_core::formula::flow::{FlowStep, Flying, carried_by_flow};
use haze_core::formula::ramp::sample_ramp;
use haze_core::formula::uniforms::EmitterUniform;
use haze_core::frame::{Bounds, SpriteExtent, particle_bounds};
use haze_core::settings::SpriteAnimation;
use haze_preset::PresetSystem;

use super::text::{Properties, curve_texture, gradient_texture, vector_curve_texture};

/// Most of the motion that Godot's noise turns: more would leave nothing of the mean velocity.
const MAX_INFLUENCE: f32 = 0.5;
/// Times at which the box around the smoke is taken, and how much larger it is: Godot's particles take other ways.
const BOX_TIMES: u32 = 16;
const BOX_MARGIN: f32 = 0.25;

/// An emitter, with a few of its numbers in Godot's terms.
pub struct Process<'a> {
    system: &'a PresetSystem,
    /// At the emitter's size.
    emitter: EmitterUniform,
    /// Of the mean particle: without what scatters particles, and what Godot has settings for.
    middle: EmitterUniform,
    /// Seconds of the longest life.
    longest: f32,
    /// Seconds of emission; 0 without an end.
    duration: f32,
    /// Fraction of a particle's motion that noise turns.
    influence: f32,
}

impl<'a> Process<'a> {
    pub fn new(system: &'a PresetSystem) -> Self {
        let settings = &system.emitter;
        let emitter = settings.snapshot(0.0).uniform;
        let middle = EmitterUniform {
            swirl_strength: 0.0,
            ring_speed: 0.0,
            attraction: 0.0,
            bounce: 0.0,
            floor_margin: 0.0,
            obstacle_margin: 0.0,
            orbit_rate: 0.0,
            ..emitter
        };
        let longest = emitter.lifetime * (1.0 + emitter.lifetime_spread);
        let slower = settings.size.sqrt();
        let mut process =
            Self { system, emitter, middle, longest, duration: settings.duration * slower, influence: 0.0 };
        let steps = 32;
        let speed = |step: i32| process.mean_velocity((step as f32 + 0.5) / steps as f32).length();
        let way = (0..steps).map(speed).sum::<f32>() / steps as f32 * emitter.lifetime;
        // Godot's turbulence makes the initial velocity grow from step to step: either scatters the smoke, whichever leads further.
        let turned = settings.turbulence * settings.size;
        let scattered = 0.5 * emitter.velocity_spread * drag_integrals(emitter.drag, emitter.lifetime).x;
        if emitter.swirl_strength > 0.0 && way > 0.0 && turned > scattered {
            process.influence = (turned / way).min(MAX_INFLUENCE);
        }
        process
    }

    /// True if turbulence scatters the smoke, and no random velocity.
    pub fn is_turbulent(&self) -> bool {
        self.influence > 0.0
    }

    /// True if the emission ends, and Godot's can end at that time.
    pub fn is_one_shot(&self) -> bool {
        self.duration > 0.0 && self.duration <= self.longest && self.system.emitter.period == 0.0
    }

    /// Velocity of the mean particle at an age.
    fn mean_velocity(&self, age: f32) -> Vec3 {
        let middle = &self.middle;
        let start = Flight { position: middle.position, velocity: middle.velocity };
        let lifetime = middle.lifetime;
        let seconds = age * middle.lifetime;
        let flown = paced_flight(middle, &start, &pace_at(middle, lifetime, seconds));
        let carried = carried_by_flow(middle, &Flying { start, lifetime, seconds }, &mut FlowStep::default());
        flown.velocity + carried.velocity
    }

    /// Fraction that drag leaves of a velocity at birth, at an age, times the speed at that age.
    fn kept_speed(&self, age: f32) -> f32 {
        let pace = pace_at(&self.middle, self.middle.lifetime, age * self.middle.lifetime);
        (1.0 - self.middle.drag * drag_integrals(self.middle.drag, pace.flown).x) * pace.speed
    }

    fn radius(&self, age: f32) -> f32 {
        let EmitterUniform { radius_start, radius_end, size_curve, .. } = &self.emitter;
        let radius = radius_start + (radius_end - radius_start) * age.sqrt();
        radius * curve_value(size_curve, age) * self.system.settings.sprite.size
    }

    fn amount(&self, age: f32) -> f32 {
        let EmitterUniform { amount, amount_curve, fade_in, fade_out, .. } = &self.emitter;
        let fade = smoothstep_unit(age / fade_in.max(1.0e-4)) * smoothstep_unit((1.0 - age) / fade_out.max(1.0e-4));
        let amount = (amount * curve_value(amount_curve, age) * fade).clamp(0.0, 1.0);
        amount * self.system.settings.accumulate.opacity
    }

    /// Mean fraction of the angle that a particle has turned by at an age, without drag.
    fn turned_fraction(&self, age: f32) -> f32 {
        let seconds = (age * self.emitter.lifetime).max(1.0e-4);
        drag_integrals(self.emitter.drag, seconds).x / seconds
    }

    fn has_orbit(&self) -> bool {
        self.emitter.orbit_rate != 0.0
    }

    /// Colors of particles at birth, and over their life.
    fn colors(&self, assets: &MaterialAssets) -> String {
        let settings = &self.system.settings;
        let emitter = &self.emitter;
        let mut text = String::new();
        if settings.sprite.tint > 0.0 {
            let tint = |color: Vec3| Vec3::ONE.lerp(color, settings.sprite.tint);
            text += &gradient_texture("tint", &[(0.0, tint(emitter.tint)), (1.0, tint(emitter.other_tint))]);
        }
        if settings.sprite.age_color > 0.0 {
            let color = |step: i32| {
                let age = step as f32 / 16.0;
                let of_age = sample_ramp(&assets.age_ramp, settings.ramp_filter, age);
                (age, Vec3::ONE.lerp(of_age, settings.sprite.age_color))
            };
            text += &gradient_texture("age", &(0..=16).map(color).collect::<Vec<_>>());
        }
        text
    }

    /// Curves and gradients that the process material reads.
    pub fn resources(&self, assets: &MaterialAssets) -> String {
        let forward = 1.0 / (1.0 - self.influence);
        let mut text = vector_curve_texture("velocity", |age| self.mean_velocity(age) * forward);
        if self.emitter.burst != 0.0 {
            text += &curve_texture("burst", |age| self.kept_speed(age));
        }
        if self.has_orbit() {
            let turns = self.emitter.up * (self.emitter.orbit_rate / TAU);
            let pace = |age: f32| pace_at(&self.middle, self.middle.lifetime, age * self.middle.lifetime);
            text += &vector_curve_texture("orbit", |age| turns * pace(age).speed);
        }
        text += &curve_texture("size", |age| self.radius(age));
        text += &curve_texture("amount", |age| self.amount(age));
        if self.emitter.spin > 0.0 {
            text += &curve_texture("spin", |age| self.turned_fraction(age));
        }
        text + &self.colors(assets)
    }

    /// The process material. `frames`: of the sprite.
    pub fn material(&self, frames: u32) -> Properties {
        let emitter = &self.emitter;
        let mut material = Properties::default();
        let texture = |name: &str| format!("SubResource(\"{name}_texture\")");
        let spread = emitter.lifetime_spread;
        material.number("lifetime_randomness", 2.0 * spread / (1.0 + spread));
        self.add_shape(&mut material);
        material.vector("gravity", Vec3::ZERO);
        material.range("directional_velocity", 1.0, 1.0);
        material.add("directional_velocity_curve", texture("velocity"));
        let damping = if self.is_turbulent() {
            // Holds what turbulence would make grow from step to step, beginning with rounding errors.
            1.0
        } else {
            material.number("spread", 180.0);
            material.range("initial_velocity", 0.0, emitter.velocity_spread);
            // Godot's damping is constant. At two thirds of the largest speed, it leads as far as haze's drag.
            emitter.velocity_spread * emitter.drag / 3.0
        };
        material.range("damping", damping, damping);
        if emitter.burst != 0.0 {
            material.range("radial_velocity", emitter.burst, emitter.burst);
            material.add("radial_velocity_curve", texture("burst"));
        }
        if self.has_orbit() {
            material.range("orbit_velocity", 1.0, 1.0);
            material.add("orbit_velocity_curve", texture("orbit"));
        }
        if self.is_turbulent() {
            self.add_turbulence(&mut material);
        }
        material.range("scale", 1.0 - emitter.radius_spread, 1.0 + emitter.radius_spread);
        material.add("scale_curve", texture("size"));
        material.add("alpha_curve", texture("amount"));
        if self.system.settings.sprite.tint > 0.0 {
            material.add("color_initial_ramp", texture("tint"));
        }
        if self.system.settings.sprite.age_color > 0.0 {
            material.add("color_ramp", texture("age"));
        }
        // Godot's angles, and those of the shader, are clockwise.
        let angle = |random| -rotation_at_birth(emitter.rotation_spread, random).to_degrees();
        material.range("angle", angle(1.0), angle(0.0));
        if emitter.spin > 0.0 {
            let spin = emitter.spin.to_degrees();
            material.range("angular_velocity", -spin, spin);
            material.add("angular_velocity_curve", texture("spin"));
        }
        self.add_animation(frames as f32, &mut material);
        material
    }

    fn add_shape(&self, material: &mut Properties) {
        let EmitterUniform { extent, up, .. } = self.emitter;
        match self.system.emitter.shape {
            EmitterShape::Sphere => {
                material.add("emission_shape", 1);
                material.number("emission_sphere_radius", 1.0);
                material.vector("emission_shape_scale", extent);
            }
            EmitterShape::Box => {
                material.add("emission_shape", 3);
                material.vector("emission_box_extents", extent);
            }
            EmitterShape::Disc => {
                // Godot scales along the axes of the node.
                let is_level = up == Vec3::Y;
                let radius = if is_level { 1.0 } else { 0.5 * (extent.x + extent.z) };
                let scale = if is_level { Vec3::new(extent.x, 1.0, extent.z) } else { Vec3::ONE };
                material.add("emission_shape", 6);
                material.vector("emission_ring_axis", up);
                material.number("emission_ring_height", 0.0);
                material.number("emission_ring_radius", radius);
                material.number("emission_ring_inner_radius", 0.0);
                material.vector("emission_shape_scale", scale);
            }
        }
    }

    fn add_turbulence(&self, material: &mut Properties) {
        // Godot's noise has 4 - 4 (scale / 10)^(1/4) cells per metre. (particle_process_material.cpp)
        let cells = self.emitter.swirl_frequency.min(4.0);
        material.add("turbulence_enabled", true);
        material.number("turbulence_noise_scale", 10.0 * (1.0 - cells / 4.0).powi(4));
        // The pattern rides with the smoke.
        material.vector("turbulence_noise_speed", -self.emitter.swirl_travel * cells);
        material.number("turbulence_noise_speed_random", self.emitter.swirl_turn_rate / TAU);
        material.range("turbulence_influence", self.influence, self.influence);
    }

    /// Frames of a life, as fractions of all frames.
    fn add_animation(&self, frames: f32, material: &mut Properties) {
        let sprite = &self.system.settings.sprite;
        let (offset, speed) = match sprite.for_frames(frames).animation {
            SpriteAnimation::Still => (0.0, 0.0),
            SpriteAnimation::Volume => (0.0, (frames - 1.0) / frames),
            _ if self.system.settings.debug.freeze_animation => (1.0, 0.0),
            _ => (1.0, self.emitter.frame_rate * self.emitter.lifetime / frames),
        };
        material.range("anim_speed", speed, speed);
        material.range("anim_offset", 0.0, offset);
    }

    /// The node.
    pub fn node(&self) -> Properties {
        let emitter = &self.emitter;
        let fraction = if self.duration > 0.0 { curve_integral(&emitter.rate_curve, 1.0) } else { 1.0 };
        let births = emitter.rate * self.duration * fraction;
        let period = self.system.emitter.period * self.system.emitter.size.sqrt();
        let amount = match () {
            () if self.is_one_shot() => births,
            () if period > 0.0 => births / period * self.longest,
            () => emitter.rate * fraction * self.longest,
        };
        let Vec3 { x, y, z } = emitter.position;
        let mut node = Properties::default();
        node.add("transform", format_args!("Transform3D(1, 0, 0, 0, 1, 0, 0, 0, 1, {x:?}, {y:?}, {z:?})"));
        node.add("cast_shadow", 0);
        node.add("amount", (amount.round() as u32).max(1));
        node.number("lifetime", self.longest);
        if self.is_one_shot() {
            node.add("one_shot", true);
            node.number("explosiveness", 1.0 - self.duration / self.longest);
        } else {
            // The smoke is there when the scene begins.
            node.number("preprocess", self.longest);
        }
        node.add("use_fixed_seed", true);
        node.add("seed", self.system.emitter.seed);
        let bounds = self.bounds();
        let from = bounds.min - emitter.position;
        let size = bounds.max - bounds.min;
        let numbers = [from, size].map(|v| format!("{:?}, {:?}, {:?}", v.x, v.y, v.z));
        node.add("visibility_aabb", format_args!("AABB({})", numbers.join(", ")));
        // By the distance from the camera.
        node.add("draw_order", 3);
        node.add("process_material", "SubResource(\"process\")");
        node.add("draw_pass_1", "SubResource(\"quad\")");
        node
    }

    /// Box around the smoke at all times.
    fn bounds(&self) -> Bounds {
        let extent = SpriteExtent::from_settings(&self.system.settings);
        let mut all = Bounds { min: self.emitter.position, max: self.emitter.position };
        let mut particles = Vec::new();
        for index in 0..BOX_TIMES {
            let time = (self.duration + self.longest) * (index as f32 + 0.5) / BOX_TIMES as f32;
            self.system.emitter.snapshot(time.into()).sample(&mut particles);
            let bounds = particle_bounds(&particles, extent);
            all.min = all.min.min(bounds.min);
            all.max = all.max.max(bounds.max);
        }
        let margin = (all.max - all.min) * BOX_MARGIN;
        Bounds { min: all.min - margin, max: all.max + margin }
    }
}
