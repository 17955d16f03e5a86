//! The light on the smoke: by its normal, by its amount, and from behind.

use glam::Vec3;

use crate::fields::{FieldVisitor, Fields};

choice! {
    /// How the diffuse light of a normal is found.
    DiffuseMode {
        /// Every light through the diffuse ramp, in every pixel. Point lights vary across the smoke.
        #[default]
        Ramp = "ramp",
        /// All lights through the ramp into a small cubemap by normal, once; then one lookup.
        Cubemap = "cubemap",
        /// The same into a picture of a lit sphere, looked up by the normal's xy.
        Motif = "motif",
        /// A painted picture of a lit sphere; the scene's lights do not enter.
        PaintedMotif = "painted_motif",
        /// The same projected on nine spherical harmonics.
        SphericalHarmonics = "spherical_harmonics",
    }
}

choice! {
    /// How soft scatter depends on the amount.
    SoftScatterMode {
        /// From `scatter_colour` to `ambient_colour` by a smoothstep.
        #[default]
        Smoothstep = "smoothstep",
        /// From a painted ramp over the amount.
        Ramp = "ramp",
    }
}

/// Diffuse light: `ramp(dot(n, l)/2 + 1/2)` per light.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "app", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct Diffuse {
    /// How the light of a normal is found.
    pub mode: DiffuseMode,
    /// Multiplies the sum over all lights.
    pub intensity: f32,
}

impl Default for Diffuse {
    fn default() -> Self {
        Self { mode: DiffuseMode::default(), intensity: 1.0 }
    }
}

impl Fields for Diffuse {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.number("intensity", &mut self.intensity, 0.0..=100.0, "");
    }
}

/// Soft scatter: the even backlight of thin smoke, darker as the amount grows.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "app", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct SoftScatter {
    /// Curve or painted ramp.
    pub mode: SoftScatterMode,
    /// Amount at which `scatter_colour` begins to give way.
    pub scatter_amount: f32,
    /// Amount after that at which `ambient_colour` is reached.
    pub scatter_smooth: f32,
    /// Linear RGB of thin smoke.
    #[cfg_attr(feature = "app", schemars(with = "[f32; 3]"))]
    pub scatter_colour: Vec3,
    /// Linear RGB of thick smoke.
    #[cfg_attr(feature = "app", schemars(with = "[f32; 3]"))]
    pub ambient_colour: Vec3,
    /// Multiplies the result.
    pub intensity: f32,
}

impl Default for SoftScatter {
    fn default() -> Self {
        Self {
            mode: SoftScatterMode::default(),
            scatter_amount: 0.0,
            scatter_smooth: 0.7,
            scatter_colour: Vec3::new(0.05, 0.055, 0.065),
            ambient_colour: Vec3::new(0.012, 0.013, 0.017),
            intensity: 1.0,
        }
    }
}

impl Fields for SoftScatter {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.number("scatter_amount", &mut self.scatter_amount, 0.0..=1.0, "");
        visitor.number("scatter_smooth", &mut self.scatter_smooth, 0.0..=1.0, "");
        visitor.vector("scatter_colour", &mut self.scatter_colour, 0.0..=100.0, "");
        visitor.vector("ambient_colour", &mut self.ambient_colour, 0.0..=100.0, "");
        visitor.number("intensity", &mut self.intensity, 0.0..=100.0, "");
    }
}

/// Specular scatter: the glow round a light seen through smoke.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "app", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct SpecularScatter {
    /// Half the side of the quad, whatever the distance.
    pub size: f32,
    /// Multiplies the glow. 0 draws no quads.
    pub intensity: f32,
}

impl Default for SpecularScatter {
    fn default() -> Self {
        Self { size: 160.0, intensity: 1.0 }
    }
}

impl Fields for SpecularScatter {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.number("size", &mut self.size, 1.0..=8192.0, "pixels");
        visitor.number("intensity", &mut self.intensity, 0.0..=100.0, "");
    }
}
