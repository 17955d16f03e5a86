//! Participating media: optical properties of smoke.

use std::ops::RangeInclusive;

use glam::Vec3;

/// Optical properties of smoke.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    /// Single-scattering albedo, linear RGB: the fraction of light that is scattered; the rest is absorbed.
    pub albedo: Vec3,
    /// Anisotropy: the mean cosine of the scattering angle. 0 is isotropic, towards 1 forward, below 0 backward.
    pub anisotropy: f32,
    /// Extinction per half side of the volume at a density of 1.
    pub density: f32,
}

impl Medium {
    /// Range of a channel of the albedo.
    pub const ALBEDO_RANGE: RangeInclusive<f32> = 0.0..=1.0;
    /// Range of the anisotropy.
    pub const ANISOTROPY_RANGE: RangeInclusive<f32> = -0.95..=0.95;
    /// Range of the density.
    pub const DENSITY_RANGE: RangeInclusive<f32> = 0.1..=100.0;
}

/// A medium with a name.
#[derive(Clone, Copy, Debug)]
pub struct NamedMedium {
    /// Name for the command line.
    pub name: &'static str,
    /// One-line description for users.
    pub description: &'static str,
    /// Optical properties.
    pub medium: Medium,
}

/// Common media. Albedo and anisotropy are of the order of measured values; the density suits a puff.
pub const MEDIA: &[NamedMedium] = &[
    medium("steam", "white vapour, scatters nearly all light forwards", [0.99, 0.99, 0.995], 0.7, 6.0),
    medium("ash", "gray, coarse, scatters evenly", [0.72, 0.71, 0.70], 0.2, 8.0),
    medium("soot", "black, absorbs most of the light", [0.28, 0.25, 0.23], 0.3, 10.0),
    medium("dust", "sand and earth, brown", [0.95, 0.85, 0.70], 0.45, 6.0),
    medium("diesel", "thin, dark and bluish", [0.55, 0.58, 0.63], 0.5, 3.0),
    medium("milk", "dense and white, light scatters many times", [0.998, 0.996, 0.985], 0.3, 12.0),
];

const fn medium(
    name: &'static str,
    description: &'static str,
    albedo: [f32; 3],
    anisotropy: f32,
    density: f32,
) -> NamedMedium {
    NamedMedium { name, description, medium: Medium { albedo: Vec3::from_array(albedo), anisotropy, density } }
}
