//! Images and the recipes they are baked from: ramps, sprites, noise. This module works on memory and files only and
//! never uses a GPU device.

pub mod builtin;
pub mod cache;
mod exact;
pub mod file;
pub mod finding;
pub mod json;
pub mod material;
pub mod noise;
pub mod path_trace;
pub mod picture;
pub mod ramp;
pub mod sprite;
mod threads;
