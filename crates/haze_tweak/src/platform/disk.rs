//! Files and folders on a disk.

use std::fs;
use std::path::{Path, PathBuf};

use eframe::egui;
use haze_core::error::{AssetError, Error};
use haze_preset::FileIdentity;

use haze_export::file_kind::files_to_open;

pub use crate::file_watcher::{Stamp, Watcher};

/// Creates a folder and its parents.
pub fn make_folder(path: &Path) -> Result<(), Error> {
    fs::create_dir_all(path).map_err(|error| Error::from(AssetError::Io { path: path.into(), error }))
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

/// Returns the file to open of those that were dropped on the window.
pub fn dropped_file(context: &egui::Context) -> Option<PathBuf> {
    let files = context.input(|input| input.raw.dropped_files.iter().map(|file| file.path().to_owned()).collect());
    files_to_open(files).into_iter().next()
}

/// Does nothing: a written file is on the user's disk.
pub fn offer_download(_: &Path) {}

/// Returns a link without the address of a page, which a program does not know.
pub fn link_address(fragment: &str) -> String {
    format!("#{fragment}")
}
