//! Bounding box of a particle system.

use glam::Vec3;

use crate::error::FieldError;

/// Axis-aligned box in world space, metres. Contains every particle of a system with its sprite.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Bounds {
    /// Minimum corner.
    pub min: Vec3,
    /// Maximum corner.
    pub max: Vec3,
}

impl Bounds {
    /// Empty box, which grows with [`Bounds::include`].
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// Grows the box to contain a sphere.
    pub fn include(&mut self, center: Vec3, radius: f32) {
        self.min = self.min.min(center - radius);
        self.max = self.max.max(center + radius);
    }

    /// True if the box is empty.
    pub fn is_empty(&self) -> bool {
        self.min.cmpgt(self.max).any()
    }

    /// Center of the box.
    pub fn center(&self) -> Vec3 {
        0.5 * (self.min + self.max)
    }

    /// Checks the corners.
    ///
    /// # Errors
    /// Names the field at `path` if a corner of a box that is not empty is not finite.
    pub fn validate(&self, path: impl FnOnce() -> String) -> Result<(), FieldError> {
        if self.is_empty() || (self.min.is_finite() && self.max.is_finite()) {
            return Ok(());
        }
        Err(FieldError::new(path(), format!("{}..{}", self.min, self.max), "finite corners"))
    }

    /// Corner `index`, 0..8: bit 0 is x, bit 1 is y, bit 2 is z; a set bit selects the maximum. `BOX_CORNERS` in
    /// transfer.wgsl counts alike.
    pub fn corner(&self, index: u32) -> Vec3 {
        let pick = |bit: u32, min: f32, max: f32| if index & bit == 0 { min } else { max };
        Vec3::new(pick(1, self.min.x, self.max.x), pick(2, self.min.y, self.max.y), pick(4, self.min.z, self.max.z))
    }
}
