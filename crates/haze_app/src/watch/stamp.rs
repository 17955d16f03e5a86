//! What tells that a file has been written.

use std::fs;
use std::path::Path;
use std::time::SystemTime;

/// What a file looks like from outside: as long as it stays, the file has not been written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stamp {
    /// In bytes.
    pub length: u64,
    modified: Option<SystemTime>,
    /// Device and inode, and when that was changed, which no program can set back.
    inode: (u64, u64, i64, i64),
}

impl Stamp {
    /// Of what is there now; links are followed.
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
