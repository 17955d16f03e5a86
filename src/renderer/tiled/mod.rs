//! Accumulation by compute shaders: what all systems of a device share, and what one system owns.

mod emission;
mod shared;
mod system;

pub(crate) use emission::Emitted;
pub(crate) use shared::{Tiled, TiledKeys};
pub(crate) use system::{PARTICLE_STEP, SPRITE, TiledInputs, TiledPasses, TiledSystem};
