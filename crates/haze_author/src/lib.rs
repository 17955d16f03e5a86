//! Makes the assets that haze draws with: path tracing, sprite and ramp bakes, fits, importers, checks, particle files.
//!
//! The library `haze` links none of this: it loads the PNG files and presets that this crate writes.

pub mod backdrop;
mod bytes;
pub mod color_temperature;
pub mod daylight;
pub mod deterministic_math;
pub mod finding;
pub mod light_angles;
pub mod noise_recipe;
pub mod particle_files;
pub mod path_trace;
pub mod preset;
pub mod ramp;
pub mod simulation;
pub mod sprite;
pub mod vdb;
