//! What a renderer holds.

/// Bytes of GPU memory that a renderer holds, its materials aside.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MemoryUse {
    /// Accumulation targets, lit smoke, reduced depths and baked light of all systems.
    pub targets: u64,
    /// Particles and uniforms, and all of `tiled`.
    pub buffers: u64,
    /// Of the buffers, what compute shaders work on.
    pub tiled: TiledMemory,
}

/// Bytes of GPU memory that the path `tiled` holds, by what is in it, and what sorts a host's particles for the others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TiledMemory {
    /// The particles of emitters.
    pub emitted: u64,
    /// A host's particles, back to front.
    pub sorted: u64,
    /// Particles as they lie in the view, and the rectangles that they touch.
    pub sprites: u64,
    /// What is sorted: depths, and the numbers of particles.
    pub keys: u64,
    /// How many there are of each digit, and in each bin.
    pub counts: u64,
    /// The sprites of every bin, front to back.
    pub lists: u64,
}

impl TiledMemory {
    /// All of it.
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
        })
    }
}
