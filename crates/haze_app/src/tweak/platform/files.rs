//! Files: read with a limit, written whole.

use std::fs;
use std::path::{Path, PathBuf};

use haze::Error;
use haze::assets::{file, json};
use haze::picture::{FileIdentity, MAX_BYTES, write_file};
use haze::preset::Preset;
use haze_author::particle_files;

pub use crate::watch::{Stamp, Watcher};
pub use haze::picture::{Effort, read_colour_png, read_png, write_png};

/// A preset and the text that it was read from.
pub fn read_preset(name_or_path: &Path) -> Result<(Preset, String), Error> {
    Preset::read(name_or_path)
}

/// The text of a JSON file.
pub fn read_text(path: &Path) -> Result<String, Error> {
    json::read(path, json::MAX_BYTES)
}

/// The bytes of a picture's file.
pub fn read_picture(path: &Path) -> Result<Vec<u8>, Error> {
    file::read(path, "PNG picture", MAX_BYTES)
}

/// The bytes of a recipe's file.
pub fn read_recipe(path: &Path) -> Result<Vec<u8>, Error> {
    file::read(path, "recipe", json::MAX_BYTES)
}

/// The bytes of a file of particles.
pub fn read_particles(path: &Path) -> Result<Vec<u8>, Error> {
    file::read(path, "CSV or PLY file", particle_files::MAX_FILE_BYTES)
}

/// Writes a file whole, or leaves the old one.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    write_file(path, bytes)
}

/// Makes a folder, and those that it is in.
pub fn make_folder(path: &Path) -> Result<(), Error> {
    fs::create_dir_all(path).map_err(|error| Error::Io { path: path.into(), error })
}

/// Removes a file, if it can be.
pub fn remove(path: &Path) {
    let _ = fs::remove_file(path);
}

/// The files in a folder, by name; none where there is no folder.
pub fn list(folder: &Path) -> Vec<PathBuf> {
    let mut files: Vec<_> = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
    files.sort();
    files
}

/// Whether something is there.
pub fn exists(path: &Path) -> bool {
    path.exists()
}

/// The path from the root on; as it is where that is not known.
pub fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or(path.into())
}

/// Whether two paths lead to one place.
pub fn is_same(one: &Path, other: &Path) -> bool {
    FileIdentity::of(one) == FileIdentity::of(other)
}

/// `NAME_mine.png`, or the first of `NAME_mine_2.png` and so on that is free: what a copy of a built-in picture is called.
pub fn own_name(name: &str, is_free: impl Fn(&str) -> bool) -> String {
    let names = (1..).map(|number: u32| match number {
        1 => format!("{name}_mine.png"),
        number => format!("{name}_mine_{number}.png"),
    });
    names.into_iter().find(|file| is_free(file)).unwrap_or_default()
}
