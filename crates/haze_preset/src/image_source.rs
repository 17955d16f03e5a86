//! Source of the image files that a preset names.

use std::io;
use std::path::{Path, PathBuf};

use haze_core::assets::image::{MAX_BYTES, read_file};
use haze_core::error::AssetError;

use super::asset_folders::AssetFolders;

/// Source of the image files that a preset names: none, folders, or a host's own reader.
pub enum ImageSource<'a> {
    /// No files: only built-in images are found.
    BuiltIn,
    /// Folders, in which a file is searched for.
    Folders(AssetFolders),
    /// Reader of a host, for packed files, asset servers and web pages. It gets the name as the preset has it, and
    /// returns the bytes of the file.
    Reader(&'a mut dyn FnMut(&Path) -> io::Result<Vec<u8>>),
}

impl ImageSource<'_> {
    /// One folder, usually that of the preset.
    pub fn folder(path: &Path) -> Self {
        Self::Folders(AssetFolders::new(path))
    }

    /// Returns the path of a file, for messages, and its bytes.
    ///
    /// # Errors
    /// [`AssetError::Image`] if no folder has the file or there is none, [`AssetError::Io`] if it cannot be read or has more than 64 MiB.
    pub(super) fn read(&mut self, file: &Path) -> Result<(PathBuf, Vec<u8>), AssetError> {
        match self {
            Self::BuiltIn => {
                let reason = "no folder to search; expected the name of a built-in image".into();
                Err(AssetError::Image { path: file.into(), reason })
            }
            Self::Folders(folders) => {
                if let Some(bytes) = folders.image(file) {
                    return Ok((file.into(), bytes.into()));
                }
                let path = folders.find(file)?;
                let bytes = read_file(&path)?;
                Ok((path, bytes))
            }
            Self::Reader(read) => {
                let io = |error| AssetError::Io { path: file.into(), error };
                let bytes = read(file).map_err(io)?;
                if bytes.len() as u64 > MAX_BYTES {
                    let reason =
                        format!("{} bytes; expected a PNG file of at most {} MiB", bytes.len(), MAX_BYTES >> 20);
                    return Err(io(io::Error::new(io::ErrorKind::InvalidData, reason)));
                }
                Ok((file.into(), bytes))
            }
        }
    }
}
