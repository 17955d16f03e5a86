//! How a puff of smoke answers light from every side: as it is, path-traced, and as ramps have it; and the ramps that come nearest.

mod fit;
mod puff;
mod solve;

pub use fit::{FittedRamps, Shape};
pub use puff::{DiffuseRamps, LIGHTS, LightResponse, Puff, Response, angle};

#[cfg(test)]
mod tests;
