//! Input of a frame from the host: camera, scene depth, lights and particle systems.

mod bounds;
mod emitter_snapshot;
mod frame_input;
mod light;
mod material;
mod particle;
mod shadow_map;
mod sprite_extent;
#[doc(hidden)]
pub mod validate_input;
mod view;

pub use bounds::Bounds;
pub use emitter_snapshot::EmitterSnapshot;
pub use frame_input::{AliveCount, FrameInput, ParticleBuffer, ParticleSystem, Particles, SceneDepth};
pub use light::{Light, LightKind, LightRole, MAX_LIGHTS};
pub use material::Material;
pub use particle::{MAX_MAGNITUDE, Particle, particle_bounds};
pub use shadow_map::{ShadowMap, ShadowProjection};
pub use sprite_extent::SpriteExtent;
pub use view::View;
