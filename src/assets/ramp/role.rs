//! What a ramp is used for.

use crate::settings::choice;

choice! {
    /// What a ramp is used for; `ramps/README.md` has the axes.
    Role {
        /// Light of a surface, by how far it faces the light.
        #[default]
        Diffuse = "diffuse",
        /// The same for light from behind.
        Backlight = "backlight",
        /// Soft scatter, by amount.
        Scatter = "scatter",
        /// Glow of a light behind the smoke, by distance and amount.
        Specular = "specular",
        /// How opaque an amount is.
        Coverage = "coverage",
        /// Colour of a particle by its age.
        Age = "age",
    }
}

impl Role {
    /// What the name of a file says: `specular_moon.png` is a specular ramp.
    pub fn of_name(name: &str) -> Option<Self> {
        let first = name.split(['_', '.', '-']).next().unwrap_or_default();
        Self::ALL.iter().copied().find(|role| role.name() == first)
    }

    /// The role of the ramp that a field of a material names: `soft_scatter_ramp` wants one for scatter.
    pub fn of_field(field: &str) -> Option<Self> {
        let field = field.strip_suffix("_ramp")?;
        Self::ALL.iter().copied().find(|role| field.ends_with(role.name()))
    }
}
