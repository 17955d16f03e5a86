//! Roles of ramps.

use crate::settings::choice;

choice! {
    /// Use of a ramp; `ramps/README.md` describes the axes.
    RampRole {
        /// Diffuse light by the angle between normal and light.
        #[default]
        Diffuse = "diffuse",
        /// Diffuse light from behind, by the same angle.
        Backlight = "backlight",
        /// Light that has come through smoke, by the smoke's optical depth and the angle between light and viewer.
        Shadow = "shadow",
        /// Soft scatter, by amount.
        Scatter = "scatter",
        /// Specular scatter of a light behind the smoke, by distance and amount.
        Specular = "specular",
        /// Coverage by amount.
        Coverage = "coverage",
        /// Particle color by age.
        Age = "age",
        /// Heat by age.
        Heat = "heat",
        /// Light of hot smoke, by heat and by how much of it is there.
        Fire = "fire",
    }
}

impl RampRole {
    /// Returns the role from a file name: `specular_moon.png` is a specular ramp.
    pub fn from_name(name: &str) -> Option<Self> {
        let first = name.split(['_', '.', '-']).next().unwrap_or_default();
        Self::ALL.iter().copied().find(|role| role.name() == first)
    }

    /// Returns the role from a material field's name: `soft_scatter_ramp` holds a scatter ramp.
    pub fn from_field(field: &str) -> Option<Self> {
        let field = field.strip_suffix("_ramp")?;
        Self::ALL.iter().copied().find(|role| field.ends_with(role.name()))
    }
}
