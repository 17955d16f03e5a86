//! Reads files with a size limit, and writes files atomically.

use std::fs;
use std::path::{Path, PathBuf};

use haze::Error;
use haze::assets::{bounded_read, json};
pub use haze::image::{CompressionEffort, read_color_png, read_png, write_baked_png, write_png, write_state_file};
use haze::image::{FileIdentity, MAX_BYTES, write_file};
use haze::preset::Preset;
use haze_author::particle_files;

pub use crate::file_watcher::{Stamp, Watcher};

/// Reads a preset, and the text that it was read from.
pub fn read_preset(name_or_path: &Path) -> Result<(Preset, String), Error> {
    Preset::read(name_or_path)
}

/// Reads the text of a JSON file.
pub fn read_text(path: &Path) -> Result<String, Error> {
    json::read(path, json::MAX_BYTES)
}

/// Reads the bytes of an image file.
pub fn read_picture(path: &Path) -> Result<Vec<u8>, Error> {
    bounded_read::read(path, "PNG picture", MAX_BYTES)
}

/// Reads the bytes of a recipe file.
pub fn read_recipe(path: &Path) -> Result<Vec<u8>, Error> {
    bounded_read::read(path, "recipe", json::MAX_BYTES)
}

/// Reads the bytes of a particle file.
pub fn read_particles(path: &Path) -> Result<Vec<u8>, Error> {
    bounded_read::read(path, "CSV or PLY file", particle_files::MAX_FILE_BYTES)
}

/// Writes a complete file, or leaves the old one.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    write_file(path, bytes)
}

/// Creates a folder and its parents.
pub fn make_folder(path: &Path) -> Result<(), Error> {
    fs::create_dir_all(path).map_err(|error| Error::Io { path: path.into(), error })
}

/// Removes a file. Errors are ignored.
pub fn remove(path: &Path) {
    let _ = fs::remove_file(path);
}

/// Returns the entries of a folder, sorted by path; empty if there is no folder.
pub fn list(folder: &Path) -> Vec<PathBuf> {
    let mut files: Vec<_> = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
    files.sort();
    files
}

/// Returns true if a file or folder exists.
pub fn exists(path: &Path) -> bool {
    path.exists()
}

/// Returns true if a name is not free: it is that of a file, a folder or a link, even of a link to nothing.
pub fn is_taken(path: &Path) -> bool {
    path.symlink_metadata().is_ok()
}

/// Returns the absolute path, or the path itself if that is not known.
pub fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or(path.into())
}

/// Returns true if two paths lead to the same file.
pub fn is_same(one: &Path, other: &Path) -> bool {
    FileIdentity::of(one) == FileIdentity::of(other)
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
