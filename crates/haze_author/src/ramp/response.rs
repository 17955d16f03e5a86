//! Brightness of a puff of smoke under light from every side: path-traced, and shaded with ramps or six-way maps. Also
//! fits the ramps that come closest to the path-traced result.

mod fit_ramps;
mod fit_shadow;
mod normal_equations;
mod traced_puff;

pub use fit_ramps::{FitShape, FittedRamps};
pub use fit_shadow::{ShadedLight, ShadowShape, fit_shadow_ramp};
pub use traced_puff::{DiffuseRamps, LIGHTS, LightResponse, Puff, Response, light_angle};

#[cfg(test)]
mod tests;
