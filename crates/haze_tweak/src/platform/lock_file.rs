//! Lock files that show that a process is running. The system releases the lock when the process ends, even after a
//! crash.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Read as _, Seek as _, Write as _};
use std::path::{Path, PathBuf};

/// File that this process has locked. Other processes can see the lock, and on some systems cannot read the file.
pub struct Lock {
    path: PathBuf,
    file: File,
}

impl Lock {
    /// Locks a file, and creates it if necessary. Returns `None` if another process holds the lock, if files cannot be
    /// locked, or if the path is a link, a device or a pipe, which the text must not be written to.
    pub fn take(path: &Path) -> Option<Self> {
        if fs::symlink_metadata(path).is_ok_and(|found| !found.is_file()) {
            return None;
        }
        let file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path).ok()?;
        file.try_lock().ok()?;
        let lock = Self { path: path.into(), file };
        // The previous owner may have removed the file meanwhile, or something else may have replaced it.
        lock.is_in_place().then_some(lock)
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    #[cfg(unix)]
    fn is_in_place(&self) -> bool {
        use std::os::unix::fs::MetadataExt;
        let inode = |found: io::Result<fs::Metadata>| found.ok().map(|found| (found.dev(), found.ino()));
        inode(fs::symlink_metadata(&self.path)) == inode(self.file.metadata())
    }

    #[cfg(not(unix))]
    fn is_in_place(&self) -> bool {
        true
    }

    /// Returns the text in the file, written by this process or by the previous owner.
    pub fn read(&mut self) -> io::Result<String> {
        /// Longer than any path.
        const MAX_BYTES: u64 = 1 << 16;
        let mut text = String::new();
        self.file.rewind()?;
        (&self.file).take(MAX_BYTES).read_to_string(&mut text)?;
        Ok(text)
    }

    /// Replaces the text in the file, for the next owner.
    pub fn write(&mut self, text: &str) -> io::Result<()> {
        self.file.set_len(0)?;
        self.file.rewind()?;
        self.file.write_all(text.as_bytes())
    }

    /// Removes the file and releases the lock.
    pub fn remove(self) {
        let _ = fs::remove_file(&self.path);
    }
}

/// Retries until there is an answer. A process that another test starts briefly has copies of all file handles, and
/// with them the locks.
#[cfg(test)]
pub fn eventually<T>(ask: impl Fn() -> Option<T>) -> T {
    let start = std::time::Instant::now();
    loop {
        if let Some(answer) = ask() {
            return answer;
        }
        assert!(start.elapsed().as_secs() < 10, "no answer");
        std::thread::yield_now();
    }
}

#[cfg(test)]
#[cfg(target_os = "linux")]
mod tests {
    use std::io::{BufRead as _, BufReader};
    use std::process::{Command, Stdio};

    use super::*;

    #[test]
    fn a_killed_process_releases_its_lock() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lock");
        let script = "exec 9>lock; flock 9; echo held; exec sleep 60";
        let mut command = Command::new("sh");
        let mut other =
            command.current_dir(folder.path()).args(["-ec", script]).stdout(Stdio::piped()).spawn().unwrap();
        BufReader::new(other.stdout.take().unwrap()).read_line(&mut String::new()).unwrap();
        assert!(Lock::take(&path).is_none());
        other.kill().unwrap();
        other.wait().unwrap();
        let mut lock = eventually(|| Lock::take(&path));
        lock.write("a longer text").unwrap();
        lock.write("short").unwrap();
        drop(lock);
        let mut lock = eventually(|| Lock::take(&path));
        assert_eq!(lock.read().unwrap(), "short");
        assert!(Lock::take(&path).is_none());
        lock.remove();
        assert!(!path.exists());
    }
}
