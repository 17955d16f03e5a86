//! What smoke is made of, to light.

use glam::Vec3;

use haze::settings::{FieldVisitor, Fields};

/// What smoke is made of, to light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    /// The share of light that is scattered where it meets the medium; the rest is lost. Linear RGB.
    pub albedo: Vec3,
    /// Mean cosine of the angle that light is scattered by: 0 evenly, towards 1 onwards, below 0 back.
    pub g: f32,
    /// Extinction where a volume has a density of 1, for each half side of it: how opaque it is.
    pub density: f32,
}

impl Fields for Medium {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.colour("albedo", &mut self.albedo, 0.0..=1.0);
        visitor.number("g", &mut self.g, -0.95..=0.95, "");
        visitor.number("density", &mut self.density, 0.1..=100.0, "per half side");
    }
}

/// A medium with a name.
#[derive(Clone, Copy, Debug)]
pub struct NamedMedium {
    /// As it is asked for.
    pub name: &'static str,
    /// What it is, in a few words.
    pub description: &'static str,
    /// How it scatters.
    pub medium: Medium,
}

/// Media of every day: of the order of what is measured of them, and of a thickness that a puff has.
pub const MEDIA: &[NamedMedium] = &[
    medium("steam", "white vapour, droplets that scatter nearly all light onwards", [0.99, 0.99, 0.995], 0.7, 6.0),
    medium("ash", "grey, coarse, scatters evenly", [0.72, 0.71, 0.70], 0.2, 8.0),
    medium("soot", "black, swallows most of the light", [0.28, 0.25, 0.23], 0.3, 10.0),
    medium("dust", "sand and earth, brown", [0.95, 0.85, 0.70], 0.45, 6.0),
    medium("diesel", "thin, dark and bluish", [0.55, 0.58, 0.63], 0.5, 3.0),
    medium("milk", "dense and white, light wanders in it", [0.998, 0.996, 0.985], 0.3, 12.0),
];

const fn medium(name: &'static str, description: &'static str, albedo: [f32; 3], g: f32, density: f32) -> NamedMedium {
    NamedMedium { name, description, medium: Medium { albedo: Vec3::from_array(albedo), g, density } }
}
