//! Input of a frame from the host: camera, scene depth, lights and particle systems.

mod bounds;
mod emitter_snapshot;
#[allow(clippy::module_inception, reason = "one file per part of the input, and one of them is the frame")]
mod frame;
mod light;
mod material;
mod particle;
#[doc(hidden)]
pub mod validate;
mod view;

pub use bounds::Bounds;
pub use emitter_snapshot::EmitterSnapshot;
pub use frame::{Frame, Particles, SceneDepth, System};
pub use light::{Light, LightKind, MAX_LIGHTS};
pub use material::Material;
pub use particle::{LARGEST, Particle, particle_bounds};
pub use view::View;
