//! Stands for the lock files of a desktop. A page keeps the unsaved work of one window; the last one that writes has it.

use std::io;
use std::path::{Path, PathBuf};

use haze_core::assets::{bounded_read, memory_files};

/// Longer than any path.
const MAX_BYTES: u64 = 1 << 16;

/// File that names the preset of the unsaved work.
pub struct Lock {
    path: PathBuf,
}

impl Lock {
    /// Always succeeds.
    pub fn take(path: &Path) -> Option<Self> {
        Some(Self { path: path.into() })
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the text in the file.
    pub fn read(&mut self) -> io::Result<String> {
        let bytes = bounded_read::read(&self.path, "path", MAX_BYTES).map_err(io::Error::other)?;
        String::from_utf8(bytes).map_err(io::Error::other)
    }

    /// Replaces the text in the file.
    pub fn write(&mut self, text: &str) -> io::Result<()> {
        memory_files::write_file(&self.path, text.as_bytes()).map_err(io::Error::other)
    }

    /// Removes the file.
    pub fn remove(self) {
        memory_files::remove(&self.path);
    }
}
