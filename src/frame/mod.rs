//! Input of a frame.

mod frame_input;
mod material;
mod shadow_map;

pub use frame_input::{AliveCount, FrameInput, ParticleBuffer, ParticleSystem, Particles, SceneDepth};
pub use material::Material;
pub(crate) use material::UploadedImage;
pub use shadow_map::ShadowMap;
