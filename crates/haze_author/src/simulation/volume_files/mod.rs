//! Smoke of other tools, from VDB files: one file, or one per frame, as a [`Recording`](super::Recording).
//!
//! Files are read twice: for the box and the largest values of all frames, then for the smoke. One frame is in memory at
//! a time; what is kept of it are cells of half floats.

mod cell_grid;
mod frame_grids;
mod heat_scale;
mod volume_sequence;

pub use volume_sequence::{VolumeOptions, VolumeRecording, VolumeSequence};

#[cfg(test)]
mod tests;
