//! Base of both renderers of haze, without a device: settings, formulas, images, the emitter, and the setup of a view.

pub mod assets;
pub mod emitter;
pub mod error;
pub mod fire;
pub mod formula;
pub mod frame;
pub mod settings;
pub mod view_setup;

// The one source of glam for the crates above, of which a host could otherwise get two versions.
pub use glam;
