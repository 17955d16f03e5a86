//! Input of a frame that both renderers read.

mod bounds;
mod emitter_paths;
mod emitter_snapshot;
mod light;
mod particle;
mod shadow_projection;
mod sprite_extent;
pub mod validate_input;
mod view;

pub use bounds::Bounds;
pub use emitter_paths::EmitterPaths;
pub use emitter_snapshot::EmitterSnapshot;
pub use light::{Light, LightKind, LightRole, MAX_LIGHTS};
pub use particle::{MAX_MAGNITUDE, Particle, particle_bounds};
pub use shadow_projection::ShadowProjection;
pub use sprite_extent::SpriteExtent;
pub use view::{FOV_RANGE, View};
