//! Stamp of a file, which differs after the file was written.

use std::fs;
use std::path::Path;
use std::time::SystemTime;

/// Size, modification time and inode of a file. While they stay the same, the file has not been written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stamp {
    /// Bytes.
    pub length: u64,
    modified: Option<SystemTime>,
    /// Device, inode, and the time of the inode's last change, which no program can set back. Zero on systems other
    /// than Unix.
    inode: (u64, u64, i64, i64),
}

impl Stamp {
    /// Returns the stamp of the current file, following links; `None` if there is none.
    pub fn of(path: &Path) -> Option<Self> {
        let found = fs::metadata(path).ok()?;
        #[cfg(unix)]
        let inode = {
            use std::os::unix::fs::MetadataExt;
            (found.dev(), found.ino(), found.ctime(), found.ctime_nsec())
        };
        #[cfg(not(unix))]
        let inode = Default::default();
        Some(Self { length: found.len(), modified: found.modified().ok(), inode })
    }
}
