//! Noise: by formula, and baked into a tiling volume.

mod gradient;
mod volume;

pub use gradient::{Noise, curl_noise, fractal_noise, gradient_noise, pcg3d, tiling_noise, unit};
pub use volume::{MAX_SIZE, NoiseRecipe, NoiseVolume, RECIPE_VERSION};
