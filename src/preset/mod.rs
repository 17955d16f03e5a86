//! Presets: a camera, lights and particle systems in a JSON file.

mod cache;
mod caches;
mod camera;
mod check;
mod effect;
mod environment;
mod folders;
mod material_names;
#[cfg(feature = "app")]
mod page;
mod pictures;
#[allow(clippy::module_inception, reason = "one file per part of a preset, and one for the whole")]
mod preset;
mod role;
#[cfg(feature = "app")]
mod schema;
mod text;
#[cfg(feature = "app")]
mod tooltips;

pub use cache::{CacheEnd, CacheSource, UpAxis, cache_file};
pub use caches::MAX_CACHE_BYTES;
pub use camera::Camera;
pub use environment::{Environment, SceneName};
pub use folders::PictureFolders;
pub use material_names::{MaterialNames, picture_file};
#[cfg(feature = "app")]
pub use page::settings_page;
pub use pictures::MAX_PICTURE_BYTES;
pub use preset::{DESIGN_HEIGHT, MAX_SYSTEMS, PRESET_VERSION, Preset, PresetSystem};
#[cfg(feature = "app")]
pub use schema::schema;
#[cfg(feature = "app")]
pub use tooltips::Tooltips;
