//! What a frame draws, and in how many layers.

/// What the last frame draws, as far as the CPU knows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FrameCounts {
    /// Systems in sight.
    pub systems: u64,
    /// Their sprites: those of a slice that can be drawn, all of a buffer; times `debug_loop`.
    pub sprites: u64,
    /// Texels of the accumulation targets that are in use. Forward systems have none.
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

/// How many layers the sprites of a frame lie in.
///
/// Worked out from where each sprite stands, without the scene: a depth test spares what is hidden, if the hardware rejects it before
/// it is shaded. Systems whose particles are in a buffer are left out, as the CPU does not know them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Overdraw {
    /// Fragments: the areas of all sprites, in texels of the accumulation targets, and in pixels where they are drawn forward.
    pub fragments: f64,
    /// What they fall on: the texels, and pixels, that the boxes of the systems cover.
    pub texels: f64,
}

impl Overdraw {
    /// Layers over each other in the mean; 0 where there is nothing.
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
