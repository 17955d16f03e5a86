//! haze
#![allow(missing_docs)]
pub mod bounds;
pub mod builtin;
#[cfg(feature = "app")]
pub mod demo;
pub mod descriptor;
pub mod emitter;
pub mod error;
pub mod fields;
pub mod frame;
mod frame_bindings;
pub mod gpu_types;
pub mod headless;
mod json;
pub mod light;
pub mod material;
pub mod noise;
pub mod particle;
mod pass;
pub mod picture;
pub mod preset;
pub mod ramp;
pub mod reference;
mod renderer;
pub mod settings;
pub mod shader;
mod slot;
pub mod sprite;
mod system;
mod targets;
pub mod view;

pub use bounds::Bounds;
pub use descriptor::Descriptor;
pub use error::{Error, FieldError};
pub use frame::{Frame, Particles, SceneDepth, System};
pub use light::{Light, LightKind};
pub use material::{Material, MaterialAssets};
pub use particle::Particle;
pub use renderer::{MemoryUse, Renderer, TargetViews};
pub use settings::Settings;
pub use view::View;
pub use wgpu;
