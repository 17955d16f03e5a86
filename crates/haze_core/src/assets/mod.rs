//! Images and the recipes they are baked from: ramps, sprites, noise. This module works on memory and files only and
//! never uses a GPU device.

#[cfg(not(target_arch = "wasm32"))]
pub mod bounded_read;
#[cfg(not(target_arch = "wasm32"))]
pub mod file_type;
pub mod image;
mod image_number;
pub mod json;
pub mod material_assets;
pub mod measured;
#[cfg(target_arch = "wasm32")]
pub mod memory_files;
pub mod noise;
pub mod parallel;
pub mod ramp;
pub mod ramp_steps;
pub mod sprite;

#[cfg(target_arch = "wasm32")]
pub use memory_files as bounded_read;
