//! Particle files of an external simulation: CSV or PLY, one file or one per frame, as exported by Blender and Houdini.
//!
//! All frames are loaded at once and stay in memory, 64 bytes per particle. Any time can then be evaluated in any
//! order, scrubbing does not wait for the disk, and a broken frame is reported before the first image is drawn.
//! [`Limits`] bounds the memory.

mod column_role;
mod columns;
mod csv_reader;
mod evaluate;
mod file_frame;
mod parse_error;
mod particle_frame;
mod particle_frames;
mod ply;
mod preset_files;

pub use file_frame::ColumnUse;
pub(crate) use file_frame::{KELVIN, MIN_KELVIN};
pub use parse_error::ParseError;
pub use particle_frame::{FileParticle, ParticleFrame, ProvidedAttributes};
pub use particle_frames::{FramePair, Limits, MAX_FILE_BYTES, ParticleFrames, parse};
pub use preset_files::{
    MAX_PARTICLE_FILE_BYTES, check_particle_files, emission, load_particle_files, particles, particles_along,
    unused_columns,
};

#[cfg(test)]
mod tests;
