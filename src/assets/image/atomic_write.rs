//! Atomic file writes: a file is written completely or left unchanged.
//!
//! Not by the crate `tempfile`: `persist` neither syncs nor keeps permissions and hard links, and it leaves the files of
//! killed processes.

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, ErrorKind, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Mutex, PoisonError};

use crate::error::Error;

/// Writes a temporary file in the same folder and renames it to `path`. Readers never see a partial file, and a failed
/// write leaves the old file. The new file keeps the old one's permissions. A symbolic link is followed and stays a
/// link. The data is synced before the rename, so a killed process or a power failure leaves either the old or the new
/// file. Temporary files that a killed process left in the folder are removed.
///
/// A file with several hard links, or in a folder in which no file can be created, is overwritten in place. If that
/// fails, the old contents are restored.
///
/// # Errors
/// [`Error::Io`] if the file cannot be written.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    write_atomically(&resolve_links(path), bytes).map_err(|error| Error::Io { path: path.into(), error })
}

/// Checks that [`write_file`] could start now, for callers with long work before the write. Changes nothing.
///
/// # Errors
/// The system's error, if the write could not start.
pub fn check_writable(path: &Path) -> io::Result<()> {
    let target = resolve_links(path);
    match OpenOptions::new().write(true).open(&target) {
        Err(error) if error.kind() == ErrorKind::NotFound => {
            create_partial(&target).and_then(|(partial, _)| fs::remove_file(partial))
        }
        opened => opened.map(drop),
    }
}

/// Identity of a file, independent of its path: equal for two paths to the same file, or to the same location where a
/// file does not exist yet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileIdentity(Identity);

#[derive(Clone, Debug, PartialEq, Eq)]
enum Identity {
    #[cfg(unix)]
    Inode(u64, u64),
    Place(PathBuf),
}

impl FileIdentity {
    /// Determines the identity of the file that is at `path` now.
    pub fn of(path: &Path) -> Self {
        #[cfg(unix)]
        if let Ok(found) = fs::metadata(path) {
            use std::os::unix::fs::MetadataExt;
            return Self(Identity::Inode(found.dev(), found.ino()));
        }
        let target = resolve_links(path);
        let folder = folder_of(&target);
        let folder = fs::canonicalize(folder).unwrap_or_else(|_| folder.into());
        Self(Identity::Place(folder.join(target.file_name().unwrap_or_default())))
    }
}

/// Maximum number of symbolic links to follow; the limit of Linux.
const MAX_LINKS: u32 = 40;

/// Follows symbolic links. The target need not exist.
fn resolve_links(path: &Path) -> PathBuf {
    let mut path = path.to_path_buf();
    for _ in 0..MAX_LINKS {
        let Ok(target) = fs::read_link(&path) else { break };
        path = path.parent().unwrap_or(Path::new("")).join(target);
    }
    path
}

fn write_atomically(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let old = match fs::metadata(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => None,
        found => Some(found?),
    };
    if old.as_ref().is_some_and(has_hard_links) {
        return overwrite(path, bytes);
    }
    let (partial, mut file) = match create_partial(path) {
        Err(_) if old.is_some() => return overwrite(path, bytes),
        made => made?,
    };
    remove_stale_partials(folder_of(path));
    let write = || {
        file.write_all(bytes)?;
        if let Some(old) = old {
            fs::set_permissions(&partial, old.permissions())?;
        }
        // Without a sync, a file system may persist the rename before the data.
        file.sync_all()?;
        fs::rename(&partial, path)
    };
    write().inspect_err(|_| {
        let _ = fs::remove_file(&partial);
    })?;
    sync_folder(folder_of(path));
    Ok(())
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Syncs the folder, so that the rename is persistent. Only on Unix.
fn sync_folder(folder: &Path) {
    if cfg!(unix) {
        // Errors are ignored: some file systems do not support it, and the file is complete without it.
        let _ = File::open(folder).and_then(|folder| folder.sync_all());
    }
}

const PARTIAL: (&str, &str) = (".haze-", ".partial");

/// Removes temporary files that killed processes left in a folder, once per folder and process. Running processes hold
/// a lock on their file.
fn remove_stale_partials(folder: &Path) {
    static SWEPT: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
    if !SWEPT.lock().unwrap_or_else(PoisonError::into_inner).insert(folder.into()) {
        return;
    }
    // Files that cannot be opened are left alone.
    for path in fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()) {
        let is_partial =
            |name: &str| name.strip_prefix(PARTIAL.0).is_some_and(|rest| rest.strip_suffix(PARTIAL.1).is_some());
        if path.file_name().and_then(OsStr::to_str).is_some_and(is_partial)
            && let Ok(left) = OpenOptions::new().write(true).open(&path)
            && left.try_lock().is_ok()
        {
            let _ = fs::remove_file(&path);
        }
    }
}

#[cfg(unix)]
fn has_hard_links(file: &Metadata) -> bool {
    std::os::unix::fs::MetadataExt::nlink(file) > 1
}

#[cfg(not(unix))]
fn has_hard_links(_: &Metadata) -> bool {
    false
}

/// Creates a temporary file in the same folder, locked while it is open. Its name does not contain the final name,
/// which may already have the maximum length.
fn create_partial(path: &Path) -> io::Result<(PathBuf, File)> {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    loop {
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let partial = path.with_file_name(format!("{}{}-{count}{}", PARTIAL.0, std::process::id(), PARTIAL.1));
        let file = match OpenOptions::new().write(true).create_new(true).open(&partial) {
            // Left by a process that no longer runs.
            Err(error) if error.kind() == ErrorKind::AlreadyExists => continue,
            made => made?,
        };
        // If the file system has no locks, `remove_stale_partials` removes nothing.
        let _ = file.lock();
        // Another process may have removed it before it was locked.
        if partial.exists() {
            return Ok((partial, file));
        }
    }
}

fn overwrite(path: &Path, bytes: &[u8]) -> io::Result<()> {
    fn write(file: &mut File, bytes: &[u8]) -> io::Result<()> {
        file.rewind()?;
        file.write_all(bytes)?;
        file.set_len(bytes.len() as u64)?;
        file.sync_all()
    }
    let before = fs::read(path)?;
    let mut file = OpenOptions::new().write(true).open(path)?;
    write(&mut file, bytes).inspect_err(|_| {
        let _ = write(&mut file, &before);
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_files_are_identified_by_their_location() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::create_dir(path("in")).unwrap();
        let same = |a: &str, b: &str| FileIdentity::of(&path(a)) == FileIdentity::of(&path(b));
        assert!(same("a.png", "in/../a.png") && same("a.png", "./a.png"));
        assert!(!same("a.png", "b.png") && !same("a.png", "in/a.png"));
        fs::write(path("a.png"), "").unwrap();
        assert!(same("a.png", "in/../a.png") && !same("a.png", "b.png"));
    }

    #[test]
    fn checking_a_file_changes_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        check_writable(&path).unwrap();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        fs::write(&path, "old").unwrap();
        check_writable(&path).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert!(
            check_writable(&folder.path().join("missing/a.png")).is_err() && check_writable(folder.path()).is_err()
        );
    }

    #[test]
    fn a_file_name_of_the_maximum_length_can_be_written_repeatedly() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(format!("{}.png", "n".repeat(251)));
        for text in ["first", "second"] {
            write_file(&path, text.as_bytes()).unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), text);
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn stale_temporary_files_are_removed_and_locked_ones_stay() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        for name in [".haze-1-0.partial", ".haze-1-1.partial", ".haze-1.png", "haze-1-2.partial"] {
            fs::write(path(name), "half").unwrap();
        }
        let written = OpenOptions::new().write(true).open(path(".haze-1-1.partial")).unwrap();
        written.lock().unwrap();
        write_file(&path("a.png"), b"new").unwrap();
        let mut names: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        names.sort();
        assert_eq!(names, [".haze-1-1.partial", ".haze-1.png", "a.png", "haze-1-2.partial"]);
    }

    #[cfg(unix)]
    #[test]
    fn symbolic_links_permissions_and_hard_links_are_preserved() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let read = |name: &str| fs::read_to_string(path(name)).unwrap();
        // A link to a link to a missing file: the missing file is created.
        fs::create_dir(path("in")).unwrap();
        symlink("in/b.png", path("a.png")).unwrap();
        symlink("../c.png", path("in/b.png")).unwrap();
        write_file(&path("a.png"), b"made").unwrap();
        assert!(path("a.png").is_symlink() && path("in/b.png").is_symlink() && !path("c.png").is_symlink());
        assert_eq!(read("c.png"), "made");

        fs::set_permissions(path("c.png"), fs::Permissions::from_mode(0o640)).unwrap();
        write_file(&path("c.png"), b"again").unwrap();
        assert_eq!(fs::metadata(path("c.png")).unwrap().permissions().mode() & 0o777, 0o640);

        fs::hard_link(path("c.png"), path("d.png")).unwrap();
        assert_eq!(FileIdentity::of(&path("a.png")), FileIdentity::of(&path("d.png")));
        write_file(&path("d.png"), b"both").unwrap();
        assert_eq!((read("c.png"), read("d.png")), ("both".into(), "both".into()));

        symlink("loop.png", path("loop.png")).unwrap();
        assert!(write_file(&path("loop.png"), b"").is_err() && check_writable(&path("loop.png")).is_err());
    }
}
