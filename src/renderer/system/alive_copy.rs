//! Copy of the number of a host's particles into the uniforms of their system.

use std::mem::offset_of;

use haze_core::formula::uniforms::SystemUniform;

use crate::frame::{AliveCount, ParticleBuffer, Particles};

/// Copy of one number from a host's buffer.
#[derive(Debug)]
pub(crate) struct AliveCopy {
    source: wgpu::Buffer,
    offset: u64,
    /// Uniforms of the system.
    system: wgpu::Buffer,
}

impl AliveCopy {
    /// Returns `None` if the CPU knows the number.
    pub fn new(particles: &Particles<'_>, system: &wgpu::Buffer) -> Option<Self> {
        let Particles::Buffer(ParticleBuffer { alive: Some(AliveCount { buffer, offset }), .. }) = *particles else {
            return None;
        };
        Some(Self { source: buffer.clone(), offset, system: system.clone() })
    }

    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        let offset = offset_of!(SystemUniform, alive_count) as u64;
        encoder.copy_buffer_to_buffer(&self.source, self.offset, &self.system, offset, wgpu::COPY_BUFFER_ALIGNMENT);
    }
}
