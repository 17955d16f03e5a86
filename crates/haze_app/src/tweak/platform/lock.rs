//! Files that say that a process lives: the system gives a lock back when its process ends, however it ends.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Read as _, Seek as _, Write as _};
use std::path::{Path, PathBuf};

/// A file that this process holds. Another can tell, and read nothing from it.
pub struct Lock {
    path: PathBuf,
    file: File,
}

impl Lock {
    /// Holds a file, made if it is not there; none if another holds it, or where files cannot be held.
    pub fn take(path: &Path) -> Option<Self> {
        let file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path).ok()?;
        file.try_lock().ok()?;
        let lock = Self { path: path.into(), file };
        // Whoever held it may have removed it meanwhile.
        lock.is_in_place().then_some(lock)
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    #[cfg(unix)]
    fn is_in_place(&self) -> bool {
        use std::os::unix::fs::MetadataExt;
        let inode = |found: io::Result<fs::Metadata>| found.ok().map(|found| (found.dev(), found.ino()));
        inode(fs::metadata(&self.path)) == inode(self.file.metadata())
    }

    #[cfg(not(unix))]
    fn is_in_place(&self) -> bool {
        true
    }

    /// What was written into it, by this process or the one before.
    pub fn read(&mut self) -> io::Result<String> {
        /// More than any path is long.
        const MOST: u64 = 1 << 16;
        let mut text = String::new();
        self.file.rewind()?;
        (&self.file).take(MOST).read_to_string(&mut text)?;
        Ok(text)
    }

    /// Writes something for whoever holds it next.
    pub fn write(&mut self, text: &str) -> io::Result<()> {
        self.file.set_len(0)?;
        self.file.rewind()?;
        self.file.write_all(text.as_bytes())
    }

    /// Gives it back and leaves nothing.
    pub fn remove(self) {
        let _ = fs::remove_file(&self.path);
    }
}

/// Asks until there is an answer. For a moment, a process that another test begins has a copy of every handle, and holds what they
/// hold.
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
    fn a_process_that_is_killed_gives_its_lock_back() {
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
