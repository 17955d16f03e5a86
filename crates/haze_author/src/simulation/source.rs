//! A source of smoke, heat and fuel in a recipe.

use glam::Vec3;
use haze_core::settings::choice;
use haze_core::settings::{FieldVisitor, Fields};

choice! {
    /// Shape of a source, around its position.
    SourceShape {
        /// Ellipsoid.
        #[default]
        Sphere = "sphere",
        /// Upright cylinder.
        Disc = "disc",
        /// Box.
        Box = "box",
    }
}

/// Source of smoke. Lengths are in box widths: x from -0.5 to 0.5, y from 0 at the bottom, z from the middle to the
/// viewer.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Source {
    /// Shape around the position.
    #[serde(default)]
    pub shape: SourceShape,
    /// Middle of the source.
    #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
    pub position: Vec3,
    /// Half extent along each axis.
    #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
    pub radius: Vec3,
    /// Time of the first emission, seconds from the start of the simulation, before the warm-up.
    #[serde(default)]
    pub start: f32,
    /// Time of the last emission.
    pub end: f32,
    /// Density of the smoke in the source; 1 is thick.
    #[serde(default)]
    pub smoke: f32,
    /// Heat in the source: makes gas rise and glow. 1 is hot.
    #[serde(default)]
    pub heat: f32,
    /// Fuel in the source, which burns to heat and smoke.
    #[serde(default)]
    pub fuel: f32,
    /// Velocity of the gas in the source.
    #[serde(default)]
    #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
    pub velocity: Vec3,
    /// Speed away from the middle of the source.
    #[serde(default)]
    pub spread: f32,
    /// Depth of the lumps of the source's surface, relative to its smallest radius.
    #[serde(default)]
    pub noise: f32,
    /// Lumps per box width.
    #[serde(default = "default_noise_frequency")]
    pub noise_frequency: f32,
    /// Changes of the lumps per second.
    #[serde(default)]
    pub noise_rate: f32,
    /// Different seeds give different lumps of the same kind.
    #[serde(default)]
    pub seed: u32,
}

fn default_noise_frequency() -> f32 {
    8.0
}

impl Fields for Source {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.choice("shape", &mut self.shape);
        visitor.vector("position", &mut self.position, -4.0..=4.0, "box widths");
        visitor.vector("radius", &mut self.radius, 0.001..=4.0, "box widths");
        visitor.number("start", &mut self.start, 0.0..=60.0, "s");
        visitor.number("end", &mut self.end, self.start..=1000.0, "s");
        visitor.number("smoke", &mut self.smoke, 0.0..=100.0, "");
        visitor.number("heat", &mut self.heat, 0.0..=100.0, "");
        visitor.number("fuel", &mut self.fuel, 0.0..=100.0, "");
        visitor.vector("velocity", &mut self.velocity, -20.0..=20.0, "box widths/s");
        visitor.number("spread", &mut self.spread, -20.0..=20.0, "box widths/s");
        visitor.number("noise", &mut self.noise, 0.0..=4.0, "");
        visitor.number("noise_frequency", &mut self.noise_frequency, 0.0..=64.0, "per box width");
        visitor.number("noise_rate", &mut self.noise_rate, 0.0..=60.0, "per second");
        visitor.seed("seed", &mut self.seed);
    }
}
