//! GPU memory that a renderer holds.

/// GPU memory that a renderer holds, without its materials. All figures are bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct MemoryUse {
    /// Accumulation targets, lit smoke, reduced depths and baked light of all systems.
    pub targets: u64,
    /// Particles, uniforms, and everything counted in `tiled`.
    pub buffers: u64,
    /// Part of `buffers` that compute shaders use.
    pub tiled: TiledMemory,
    /// Density grid and optical depths, for shadow.
    pub shadow: u64,
}

/// GPU memory of the path `tiled`, and of the sort of a host's particles for the other paths. All figures are bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct TiledMemory {
    /// Particles of emitters that the GPU evaluates.
    pub emitted: u64,
    /// Particles that a compute shader sorted back to front.
    pub sorted: u64,
    /// Projected sprites, and the rectangles of texels that they touch.
    pub sprites: u64,
    /// Sort keys (depths) and particle indices.
    pub keys: u64,
    /// Counts per digit of the sort, and per bin.
    pub counts: u64,
    /// Sprite lists of all bins, front to back.
    pub lists: u64,
}

impl TiledMemory {
    /// Returns the sum of all fields.
    pub fn total(&self) -> u64 {
        let Self { emitted, sorted, sprites, keys, counts, lists } = self;
        emitted + sorted + sprites + keys + counts + lists
    }
}

impl std::ops::Add for TiledMemory {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            emitted: self.emitted + other.emitted,
            sorted: self.sorted + other.sorted,
            sprites: self.sprites + other.sprites,
            keys: self.keys + other.keys,
            counts: self.counts + other.counts,
            lists: self.lists + other.lists,
        }
    }
}

impl std::iter::Sum for MemoryUse {
    fn sum<I: Iterator<Item = Self>>(parts: I) -> Self {
        parts.fold(Self::default(), |sum, part| Self {
            targets: sum.targets + part.targets,
            buffers: sum.buffers + part.buffers,
            tiled: sum.tiled + part.tiled,
            shadow: sum.shadow + part.shadow,
        })
    }
}
