//! Light that burning smoke casts on smoke and scene.

use glam::{UVec3, Vec2, Vec3};

use crate::assets::material_assets::MaterialAssets;
use crate::assets::ramp::Ramp;
use crate::formula::color::luminance;
use crate::formula::curve::smoothstep_unit;
use crate::formula::fire::heat_at;
use crate::formula::hash::{pcg3d, unit};
use crate::formula::lighting::{coverage, painted_fraction};
use crate::formula::ramp::{sample_ramp, sample_ramp_2d};
use crate::frame::{Light, LightKind, Particle};
use crate::settings::Settings;

/// Slow changes of brightness per second.
const FLICKER_RATE: f32 = 5.0;
/// Rates of the flicker's two waves, relative to the slow one.
const FLICKER_WAVES: [f64; 2] = [1.0, 2.6];
/// Brightness at which a fire's light ends.
const FAINTEST: f32 = 0.004;

/// Burning smoke whose light is estimated.
#[derive(Clone, Copy, Debug)]
pub struct FireLight<'a> {
    /// All particles of the system, or a sample, as from
    /// [`EmitterSnapshot::sample`](crate::frame::EmitterSnapshot::sample).
    pub particles: &'a [Particle],
    /// Number of particles that one of the sample stands for; 1 for all particles.
    pub particles_per_sample: u32,
    /// Settings of the system.
    pub settings: &'a Settings,
    /// Images of the system: those of heat and fire are read.
    pub assets: &'a MaterialAssets,
    /// Seconds; the same time gives the same flicker.
    pub time: f64,
    /// Each value flickers differently.
    pub seed: u32,
}

impl FireLight<'_> {
    /// Returns the light, in the space of the particles: in the middle of the smoke, in the color of its flames, as bright as
    /// they are large and hot. `None` if nothing burns. Add it to `FrameInput::lights` and to the lights of the scene.
    pub fn estimate(&self) -> Option<Light> {
        let fire = &self.settings.fire;
        if !self.settings.burns() || fire.light <= 0.0 {
            return None;
        }
        let mut sum = Flames::default();
        for particle in self.particles.iter().filter(|particle| particle.is_visible()) {
            let amount = particle.shown_amount() * self.settings.accumulate.opacity;
            let color =
                flame_color(self.settings, &self.assets.heat_ramp, &self.assets.fire_ramp, particle.age, amount);
            sum.add(color, amount, particle.position, particle.radius * self.settings.sprite.size);
        }
        let (middle, reach) = sum.extent()?;
        let area = sum.bright_area() * self.particles_per_sample as f32;
        // Flames hide each other: at most the disc that they fill shines.
        let fraction = 1.0 - (-area / (reach * reach)).exp();
        let color = sum.light / sum.weight;
        let brightest = color.max_element();
        let brightness = brightest * fire.intensity * fire.light * fraction * reach * reach;
        let intensity = brightness * flicker(fire.flicker, FLICKER_RATE, self.time, self.seed);
        // Within the ranges of a light.
        let intensity = intensity.min(1.0e9);
        let reach = reach.min(1.0e4);
        (intensity > FAINTEST).then(|| Light {
            kind: LightKind::Point,
            position: middle,
            color: color / brightest,
            intensity,
            range: (intensity / FAINTEST).sqrt(),
            radius: reach,
            specular_scatter: 0.0,
            // It shines from the outside of the flames, not from their middle.
            smoke_shadow: false,
            ..Light::default()
        })
    }
}

/// Places of a sprite, by the alpha of its image, at which its light is taken.
const THICKNESSES: [f32; 4] = [0.25, 0.5, 0.75, 1.0];

/// Cosine between normal and direction to the viewer in a crease, where most of the light comes from.
const FACING: f32 = 0.35;

/// Light of a particle, per fraction of the scene that it hides.
fn flame_color(settings: &Settings, heat_ramp: &Ramp, fire_ramp: &Ramp, age: f32, amount: f32) -> Vec3 {
    let filter = settings.ramp_filter;
    let heat = painted_fraction(sample_ramp(heat_ramp, filter, age));
    if heat <= 0.0 {
        return Vec3::ZERO;
    }
    let light = |thickness: f32| {
        let heat = heat_at(heat, thickness, FACING, settings.fire.core, settings.fire_crust());
        let at = Vec2::new(heat, coverage(amount * thickness, settings.boost));
        sample_ramp_2d(fire_ramp, filter, at) * thickness
    };
    THICKNESSES.map(light).into_iter().sum::<Vec3>() / THICKNESSES.into_iter().sum::<f32>()
}

/// Sums over the flames of a system.
#[derive(Debug, Default)]
struct Flames {
    /// Position of the first flame, which all positions are relative to: squares of large numbers would lose the rest.
    origin: Option<Vec3>,
    /// Luminance times area: the weight of all sums.
    weight: f32,
    light: Vec3,
    luminance: f32,
    position: Vec3,
    square: f32,
}

impl Flames {
    fn add(&mut self, color: Vec3, amount: f32, position: Vec3, radius: f32) {
        let luminance = luminance(color);
        let weight = luminance * amount * radius * radius;
        if weight <= 0.0 {
            return;
        }
        self.weight += weight;
        self.light += color * weight;
        self.luminance += luminance * weight;
        let position = position - *self.origin.get_or_insert(position);
        self.position += position * weight;
        self.square += (position.length_squared() + 0.5 * radius * radius) * weight;
    }

    /// Area of flames of the mean luminance that give as much light, in squares of their radii.
    fn bright_area(&self) -> f32 {
        self.weight * self.weight / self.luminance
    }

    /// Middle of the flames, and the radius of the disc that they fill; `None` without flames.
    fn extent(&self) -> Option<(Vec3, f32)> {
        let origin = self.origin?;
        let middle = self.position / self.weight;
        let variance = self.square / self.weight - middle.length_squared();
        // A disc of radius r has a variance of r²/2.
        (variance > 0.0).then(|| (origin + middle, (2.0 * variance).sqrt()))
    }
}

/// Brightness at a time: 1 on average. `depth`: 0 is steady. `rate`: slow changes per second.
pub fn flicker(depth: f32, rate: f32, time: f64, seed: u32) -> f32 {
    let wave = |octave: u32, relative: f64| {
        let at = time * (f64::from(rate) * relative);
        let value = |step: i64| unit(pcg3d(UVec3::new(step as u32, octave, seed)).x) * 2.0 - 1.0;
        let first = at.floor() as i64;
        let blend = (at - at.floor()) as f32;
        value(first) + (value(first.wrapping_add(1)) - value(first)) * smoothstep_unit(blend)
    };
    let sum: f32 = (0..).zip(FLICKER_WAVES).map(|(octave, relative)| wave(octave, relative)).sum();
    (1.0 + 0.5 * depth * sum).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flicker_is_seekable_continuous_and_different_for_each_seed() {
        let at = |time, seed| flicker(0.8, FLICKER_RATE, time, seed);
        let times = || (0..4000).map(|step| f64::from(step) * 0.005);
        // A hundred turns of the slow wave do not average out entirely.
        let mean = times().map(|time| at(time, 1)).sum::<f32>() / 4000.0;
        assert!((mean - 1.0).abs() < 0.06, "{mean}");
        assert!(times().all(|time| (at(time, 1) - at(time + 0.001, 1)).abs() < 0.05));
        assert!(times().any(|time| (at(time, 1) - at(time, 2)).abs() > 0.3));
        assert_eq!(at(77.3, 5).to_bits(), at(77.3, 5).to_bits());
        assert!((flicker(0.0, FLICKER_RATE, 3.0, 9) - 1.0).abs() < 1e-6);
    }
}
