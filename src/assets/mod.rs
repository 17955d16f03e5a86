//! Pictures and the recipes that they are made from: ramps, sprites, noise. Everything here is in memory or in files; nothing
//! knows a device.

pub mod builtin;
pub mod file;
pub mod json;
pub mod material;
pub mod noise;
pub mod picture;
pub mod ramp;
pub mod sprite;
#[doc(hidden)]
pub mod threads;
