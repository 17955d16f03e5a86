//! What a frame draws.

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
