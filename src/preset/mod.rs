//! Presets: a camera, lights and particle systems in a JSON file.

mod animated_preset;
mod animation;
mod asset_folders;
mod camera;
mod environment;
mod image_cache;
mod image_source;
mod json_writer;
mod material_names;
mod particle_source;
mod preset_file;
mod sequence;

pub use animated_preset::AnimatedPreset;
pub use animation::{Ease, Flicker, KeyValue, Keyframe, MAX_KEYFRAMES, MAX_TIME, Track};
pub use asset_folders::AssetFolders;
pub use camera::Camera;
pub use environment::{Environment, SceneName};
#[doc(hidden)]
pub use environment::{backdrop_file_path, backdrop_kind};
pub use image_cache::{ImageCache, MAX_IMAGE_BYTES};
pub use image_source::ImageSource;
pub use material_names::MaterialNames;
#[doc(hidden)]
pub use material_names::image_file_path;
#[doc(hidden)]
pub use particle_source::particle_file_path;
pub use particle_source::{EndBehaviour, ParticleFiles, UpAxis};
#[doc(hidden)]
pub use preset_file::with_system_context;
pub use preset_file::{MAX_SYSTEMS, PRESET_VERSION, Preset, PresetSystem};
#[doc(hidden)]
pub use sequence::{Sequence, exists, frame_files, watched_paths};
