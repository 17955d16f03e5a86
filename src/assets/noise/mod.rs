//! Noise: by formula, and baked into a tiling volume.

mod gradient;
mod volume;

pub use crate::formula::hash::{pcg3d, unit};
pub use gradient::{Noise, NoiseCell, curl_noise, fractal_noise, gradient_noise, tiling_noise};
pub use volume::{MAX_SIZE, NoiseRecipe, NoiseVolume, RECIPE_VERSION};
