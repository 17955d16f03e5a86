//! Procedural noise, and noise baked into a tiling volume.

mod noise_volume;

pub use crate::formula::gradient_noise::{CachedGradientNoise, Noise, curl_noise, gradient_noise, tiling_noise};
pub use crate::formula::hash::{pcg3d, unit};
pub use noise_volume::{MAX_SIZE, NoiseVolume};
