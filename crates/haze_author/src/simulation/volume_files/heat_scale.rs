//! Scale of the heat of a file, which it does not name.

use crate::particle_files::{KELVIN, MIN_KELVIN};

/// Scale of the heat of all frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HeatScale {
    /// 0 to 1; larger values of single voxels are clamped.
    Fraction,
    /// Units of a tool: relative to the largest value.
    Largest(f32),
    Kelvin,
}

impl HeatScale {
    /// Decides the scale by the largest value of all frames.
    pub fn of_largest(largest: f32) -> Self {
        match largest {
            _ if largest > MIN_KELVIN => Self::Kelvin,
            _ if largest > 1.0 => Self::Largest(largest),
            _ => Self::Fraction,
        }
    }

    /// Returns the heat, 0 to 1, of a value of a file.
    pub fn heat(self, value: f32) -> f32 {
        let heat = match self {
            Self::Fraction => value,
            Self::Largest(largest) => value / largest,
            Self::Kelvin => (value - KELVIN.start()) / (KELVIN.end() - KELVIN.start()),
        };
        heat.clamp(0.0, 1.0)
    }

    /// Describes the scale after the grid's name.
    pub fn description(self) -> String {
        match self {
            Self::Fraction => ", 0 to 1".into(),
            Self::Largest(largest) => format!(", of which {largest} is 1"),
            Self::Kelvin => format!(" in kelvin: {} is 0, {} is 1", KELVIN.start(), KELVIN.end()),
        }
    }
}
