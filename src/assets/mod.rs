//! Pictures and the recipes that they are made from: ramps, sprites, noise. Everything here is in memory or in files; nothing
//! knows a device.

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
