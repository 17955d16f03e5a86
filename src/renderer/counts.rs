//! Counts of a frame's draws, and its overdraw.

/// Counts of the last frame, as far as the CPU knows them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct FrameCounts {
    /// Visible systems.
    pub systems: u64,
    /// Their sprites, times `debug.draw_count`. Of a slice, only visible particles count; of a buffer, all particles; of an
    /// emitter that the GPU evaluates, all births that may be alive.
    pub sprites: u64,
    /// Texels in use in the accumulation targets; 0 for forward systems.
    pub texels: u64,
}

impl std::iter::Sum for FrameCounts {
    fn sum<I: Iterator<Item = Self>>(parts: I) -> Self {
        parts.fold(Self::default(), |sum, part| Self {
            systems: sum.systems + part.systems,
            sprites: sum.sprites + part.sprites,
            texels: sum.texels + part.texels,
        })
    }
}

/// Overdraw of the sprites of a frame.
///
/// Computed from sprite positions, without the scene: a depth test removes hidden fragments if the hardware rejects
/// them before shading. Systems whose particles are in a buffer are excluded, because the CPU does not know them. Slices
/// of more than 4096 particles, and emitters that the GPU evaluates, are estimated from a sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Overdraw {
    /// Sum of the areas of all sprites, in texels of the accumulation targets; in pixels for forward systems.
    pub fragments: f64,
    /// Texels that the bounding boxes of the systems cover; pixels for forward systems.
    pub texels: f64,
}

impl Overdraw {
    /// Returns the mean number of layers; 0 if nothing is drawn.
    pub fn mean(&self) -> f64 {
        self.fragments / self.texels.max(1.0)
    }
}

impl std::iter::Sum for Overdraw {
    fn sum<I: Iterator<Item = Self>>(parts: I) -> Self {
        parts.fold(Self::default(), |sum, part| Self {
            fragments: sum.fragments + part.fragments,
            texels: sum.texels + part.texels,
        })
    }
}
