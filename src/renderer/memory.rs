//! What a renderer holds.

/// Bytes of GPU memory that a renderer holds, its materials aside.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MemoryUse {
    /// Accumulation targets, lit smoke, reduced depths and baked light of all systems.
    pub targets: u64,
    /// Particles and uniforms, and all of `tiled`.
    pub buffers: u64,
    /// Of the buffers, what the path `tiled` has made.
    pub tiled: TiledMemory,
}

/// Bytes of GPU memory that the path `tiled` holds, by what is in it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TiledMemory {
    /// The particles of emitters.
    pub emitted: u64,
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
        let Self { emitted, sprites, keys, counts, lists } = self;
        emitted + sprites + keys + counts + lists
    }
}

impl std::iter::Sum for MemoryUse {
    fn sum<I: Iterator<Item = Self>>(parts: I) -> Self {
        parts.fold(Self::default(), |sum, part| Self {
            targets: sum.targets + part.targets,
            buffers: sum.buffers + part.buffers,
            tiled: TiledMemory {
                emitted: sum.tiled.emitted + part.tiled.emitted,
                sprites: sum.tiled.sprites + part.tiled.sprites,
                keys: sum.tiled.keys + part.tiled.keys,
                counts: sum.tiled.counts + part.tiled.counts,
                lists: sum.tiled.lists + part.tiled.lists,
            },
        })
    }
}
