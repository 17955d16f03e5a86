//! Reads files with a size limit, and writes files atomically.

use std::path::Path;

use haze_author::backdrop::MAX_BACKDROP_FILE_BYTES;
use haze_author::particle_files;
use haze_core::assets::image::MAX_BYTES;
pub use haze_core::assets::image::{read_color_png, read_png};
use haze_core::assets::{bounded_read, json};
use haze_core::error::Error;
pub use haze_preset::{CompressionEffort, write_baked_png, write_png, write_state_file};
use haze_preset::{Preset, write_file};

pub use super::disk::{
    Stamp, Watcher, absolute, dropped_file, exists, is_same, is_taken, link_address, list, make_folder, offer_download,
    remove,
};

/// Reads a preset, and the text that it was read from.
pub fn read_preset(name_or_path: &Path) -> Result<(Preset, String), Error> {
    Ok(Preset::load_with_source(name_or_path)?)
}

/// Reads the text of a JSON file.
pub fn read_text(path: &Path) -> Result<String, Error> {
    Ok(json::read(path, json::MAX_BYTES)?)
}

/// Reads the bytes of an image file.
pub fn read_image(path: &Path) -> Result<Vec<u8>, Error> {
    Ok(bounded_read::read(path, "PNG image", MAX_BYTES)?)
}

/// Reads the bytes of a recipe file.
pub fn read_recipe(path: &Path) -> Result<Vec<u8>, Error> {
    Ok(bounded_read::read(path, "recipe", json::MAX_BYTES)?)
}

/// Reads the bytes of a particle file.
pub fn read_particles(path: &Path) -> Result<Vec<u8>, Error> {
    Ok(bounded_read::read(path, "CSV or PLY file", particle_files::MAX_FILE_BYTES)?)
}

/// Reads the bytes of a scene, of a file beside it, or of a sky.
pub fn read_backdrop(path: &Path) -> Result<Vec<u8>, Error> {
    Ok(bounded_read::read(path, "scene or sky", MAX_BACKDROP_FILE_BYTES)?)
}

/// Writes a complete file, or leaves the old one.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    Ok(write_file(path, bytes)?)
}

/// Returns a free name for a copy of a built-in image: `NAME_mine.png`, or else the first free one of `NAME_mine_2.png`
/// and so on.
pub fn free_copy_name(name: &str, is_free: impl Fn(&str) -> bool) -> String {
    let names = (1..).map(|number: u32| match number {
        1 => format!("{name}_mine.png"),
        number => format!("{name}_mine_{number}.png"),
    });
    names.into_iter().find(|file| is_free(file)).unwrap_or_default()
}

/// Returns a name that only this text has.
pub fn name_of_contents(text: &str) -> String {
    // FNV-1a.
    let hash = text
        .bytes()
        .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3));
    format!("{hash:016x}")
}
