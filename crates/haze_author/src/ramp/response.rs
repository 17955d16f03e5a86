//! Brightness of a puff of smoke under light from every side: path-traced, and shaded with ramps or six-way maps. Also
//! fits the ramps that come closest to the path-traced result.

mod fit;
mod puff;
mod solve;

pub use fit::{FittedRamps, Shape};
pub use puff::{DiffuseRamps, LIGHTS, LightResponse, Puff, Response, angle};

#[cfg(test)]
mod tests;
