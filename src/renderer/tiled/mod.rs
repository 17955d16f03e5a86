//! Accumulation by compute shaders: resources that all systems of a device share, and those of each system.

mod buffers;
mod depth_sorted;
mod emission;
mod passes;
mod shared;
mod sort_buffers;
mod storage;
mod system;

pub(crate) use buffers::{PARTICLE_ALIGNMENT, TILE_SPRITE_BYTES};
pub(crate) use depth_sorted::SortedParticles;
pub(crate) use emission::Emitted;
pub(crate) use passes::TiledPasses;
pub(crate) use shared::{Tiled, TiledKeys};
pub(crate) use system::{TiledInputs, TiledSystem};
