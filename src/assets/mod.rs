//! Images and the recipes they are baked from: ramps, sprites, noise. This module works on memory and files only and
//! never uses a GPU device.

pub mod bounded_read;
pub mod builtin;
pub mod file_type;
pub mod image;
pub mod json;
pub mod material_assets;
pub mod noise;
#[doc(hidden)]
pub mod parallel;
pub mod ramp;
pub mod ramp_steps;
pub mod sprite;
