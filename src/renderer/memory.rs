//! What a renderer holds.

/// Bytes of GPU memory that a renderer holds, its materials aside.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MemoryUse {
    /// Accumulation targets, lit smoke, reduced depths and baked light of all systems.
    pub targets: u64,
    /// Particles and uniforms.
    pub buffers: u64,
}

impl std::iter::Sum for MemoryUse {
    fn sum<I: Iterator<Item = Self>>(parts: I) -> Self {
        parts.fold(Self::default(), |sum, part| Self {
            targets: sum.targets + part.targets,
            buffers: sum.buffers + part.buffers,
        })
    }
}
