//! Names in a folder.

use std::io::{self, ErrorKind};
use std::path::Path;

/// Lists the names in a folder, in no order; of names that are not text none. The empty path is the working directory.
///
/// # Errors
/// The system's error if the folder cannot be read.
pub fn names(folder: &Path) -> io::Result<impl Iterator<Item = String>> {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    Ok(std::fs::read_dir(folder)?.filter_map(|entry| entry.ok()?.file_name().into_string().ok()))
}

/// True if something has this path. Also true if the path cannot be examined: reading it then reports the reason.
pub fn is_taken(path: &Path) -> bool {
    match path.symlink_metadata() {
        Ok(_) => true,
        Err(error) => error.kind() != ErrorKind::NotFound,
    }
}
