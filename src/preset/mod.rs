//! Presets: a camera, lights and particle systems in a JSON file.

mod cache;
mod camera;
mod environment;
mod folders;
mod material_names;
mod pictures;
#[allow(clippy::module_inception, reason = "one file per part of a preset, and one for the whole")]
mod preset;
mod sequence;
mod text;

pub use cache::{CacheEnd, CacheSource, UpAxis, cache_file};
pub use camera::Camera;
pub use environment::{Environment, SceneName};
pub use folders::PictureFolders;
pub use material_names::{MaterialNames, picture_file};
pub use pictures::{MAX_PICTURE_BYTES, Pictures};
#[doc(hidden)]
pub use preset::in_system;
pub use preset::{DESIGN_HEIGHT, MAX_SYSTEMS, PRESET_VERSION, Preset, PresetSystem};
pub use sequence::{Sequence, frame_files, is_there, places};
