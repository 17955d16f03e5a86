//! Presets (a camera, lights and particle systems in a JSON file), layers to add to them, the built-in images, and what reads and
//! writes them: folders, atomic writes, PNG files.

mod animated_preset;
mod animation;
mod asset_folders;
#[cfg(not(target_arch = "wasm32"))]
mod atomic_write;
mod baked_png;
pub mod builtin;
mod camera;
#[cfg(not(target_arch = "wasm32"))]
pub mod directory;
mod environment;
mod image_cache;
mod image_source;
mod json_writer;
pub mod layers;
mod material_sources;
mod particle_source;
mod png_writer;
mod preset_file;
mod sequence;
pub mod system_list;

#[cfg(target_arch = "wasm32")]
use haze_core::assets::memory_files as atomic_write;
#[cfg(target_arch = "wasm32")]
pub use haze_core::assets::memory_files as directory;

pub use animated_preset::AnimatedPreset;
pub use animation::{Ease, Flicker, KeyValue, Keyframe, MAX_KEYFRAMES, MAX_TIME, Track};
pub use asset_folders::AssetFolders;
pub use atomic_write::{FileIdentity, write_file, write_state_file};
#[cfg(not(target_arch = "wasm32"))]
pub use atomic_write::{check_writable, write_file_from};
pub use baked_png::{encode_baked_png, is_baked_png, write_baked_png};
pub use camera::Camera;
pub use environment::{Environment, SceneName, backdrop_endings, backdrop_file_path, backdrop_kind};
pub use image_cache::{ImageCache, MAX_IMAGE_BYTES};
pub use image_source::ImageSource;
pub use material_sources::{MaterialSources, image_file_path};
pub use particle_source::{EndBehavior, ParticleFiles, UpAxis, particle_file_path};
pub use png_writer::{CompressionEffort, write_png};
pub use preset_file::{MAX_SYSTEMS, PRESET_VERSION, Preset, PresetSystem, with_system_context};
pub use sequence::{Sequence, exists, frame_files, watched_paths};
