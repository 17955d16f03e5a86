//! Accumulation by compute shaders: resources that all systems of a device share, and those of each system.

mod accumulate_variants;
mod emitted_particles;
mod measured_particles;
mod shadow_volume;
mod sort_buffers;
mod sorted_particles;
mod storage_buffers;
mod tile_buffers;
mod tiled_passes;
mod tiled_pipelines;
mod tiled_system;

pub(crate) use emitted_particles::EmittedParticles;
pub(crate) use measured_particles::{MeasureInputs, MeasuredParticles};
pub(crate) use shadow_volume::{FrameShadow, ShadowVolume, SplatParticles, volume};
pub(crate) use sorted_particles::SortedParticles;
pub(crate) use tile_buffers::{PARTICLE_ALIGNMENT, TILE_SPRITE_BYTES};
pub(crate) use tiled_passes::TiledPasses;
pub(crate) use tiled_pipelines::{TiledKeys, TiledPipelines};
pub(crate) use tiled_system::{TiledInputs, TiledSystem};
