//! Limits of a device's compute shaders.

use super::auto::PathReason;
use super::context::Shared;
use super::tiled::{PARTICLE_ALIGNMENT, TILE_SPRITE_BYTES, TiledPipelines};
use crate::frame::{ParticleBuffer, ParticleSystem, Particles};

/// Returns the reason why the path `auto` cannot choose `tiled` for a system; `None` if it can.
pub(crate) fn tiled_unavailable_reason(shared: &Shared, system: &ParticleSystem<'_, '_>) -> Option<PathReason> {
    let Some(tiled) = &shared.pipelines.tiled else { return Some(PathReason::TiledUnsupported) };
    let is_readable = match &system.particles {
        Particles::Buffer(particles) => is_readable_by_compute(particles),
        Particles::Slice(_) | Particles::Emitter(_) => true,
    };
    if !is_readable {
        return Some(PathReason::BufferNotReadable);
    }
    exceeds_tiled_limits(tiled, system.particles.count()).then_some(PathReason::TooManyParticles)
}

/// True for more particles than the buffers of the compute shaders hold.
pub(crate) fn exceeds_tiled_limits(tiled: &TiledPipelines, count: u32) -> bool {
    u64::from(count) > tiled.limits.max_storage_buffer_binding_size / TILE_SPRITE_BYTES
}

/// Returns true if compute shaders can read a host's particles.
pub(crate) fn is_readable_by_compute(particles: &ParticleBuffer<'_>) -> bool {
    particles.buffer.usage().contains(wgpu::BufferUsages::STORAGE)
        && particles.offset.is_multiple_of(PARTICLE_ALIGNMENT)
}
