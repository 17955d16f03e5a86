//! Images and the recipes they are baked from: ramps, sprites, noise. This module works on memory and files only and
//! never uses a GPU device.

pub mod builtin;
pub mod file;
pub mod image;
pub mod json;
pub mod material;
pub mod noise;
pub mod ramp;
pub mod sprite;
#[doc(hidden)]
pub mod threads;
