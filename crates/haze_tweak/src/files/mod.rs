//! Data flow between the session and files: open, save, hot reload, export, stored layout, dropped images.

pub mod dropped_backdrop;
pub mod dropped_image;
pub mod export_job;
pub mod file_actions;
pub mod hot_reload;
pub mod persistence;
pub mod preset_thumbnails;
pub mod shared_look;
pub mod thumbnail_cache;
pub mod value_spread;
pub mod window_screenshot;

#[cfg(test)]
#[cfg(target_os = "linux")]
mod special_targets;
