//! Renders the images of the window inside egui's paint callbacks.

mod callback;
pub mod canvas;
mod drawing;
#[allow(clippy::module_inception, reason = "one file per part of what draws, and one for the whole")]
mod easel;
mod motion;
pub mod other;
mod pace;

pub use drawing::{Exhibit, RenderStats, Texels};
pub use easel::Easel;
