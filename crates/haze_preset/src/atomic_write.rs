//! Atomic file writes: a file is written completely or left unchanged.
//!
//! Not by the crate `tempfile`: `persist` neither syncs nor keeps permissions and hard links, and it leaves the files of
//! killed processes.

use std::collections::BTreeSet;
use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, ErrorKind, Read, Seek};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Mutex, PoisonError};

use haze_core::assets::file_type::{self, nonblocking};
use haze_core::error::{AssetError, LINK_LOOP, display_path};

/// Writes a temporary file in the same folder and renames it to `path`. Readers never see a partial file, and a failed
/// write leaves the old file. The new file keeps the old one's owner and permissions. A symbolic link is followed and
/// stays a link. The data is synced before the rename, so a killed process or a power failure leaves either the old or
/// the new file. Temporary files that a killed process left in the folder are removed.
///
/// Only a file is replaced: a device, a pipe, a socket and a folder stay, also at the end of a link. The type is checked
/// before the write and again right before the rename; the system has no rename that checks it.
///
/// A file with several hard links, in a folder in which no file can be created, or of an owner that the new file cannot
/// have, is overwritten in place. If that fails, the old contents are restored.
///
/// # Errors
/// [`AssetError::Io`] if the file cannot be written.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), AssetError> {
    write_file_from(path, &mut &*bytes)
}

/// As [`write_file`], for contents that are not in memory.
///
/// # Errors
/// [`AssetError::Io`] if the contents cannot be read, or the file cannot be written.
pub fn write_file_from(path: &Path, contents: &mut dyn Read) -> Result<(), AssetError> {
    let io = |error| AssetError::Io { path: path.into(), error };
    let target = resolve_links(path).map_err(io)?;
    let old = replaceable_file(&target).map_err(|error| io(explain_link(path, &target, error)))?;
    write_atomically(&target, old.as_ref(), contents).map_err(io)
}

/// Writes a file that a program keeps for itself, such as the layout of its window. It differs from [`write_file`] in
/// that nothing outside the folder can change: a symbolic link is refused, and of a file with several hard links only
/// this one gets the new contents.
///
/// # Errors
/// [`AssetError::Io`] if the file cannot be written, or no file can be created in the folder.
pub fn write_state_file(path: &Path, bytes: &[u8]) -> Result<(), AssetError> {
    let write = || {
        let old = replaceable_file(path)?;
        let (partial, file) = create_partial(path)?;
        put(&partial, file, path, old.as_ref(), &mut &*bytes)
    };
    write().map_err(|error| AssetError::Io { path: path.into(), error })
}

/// Checks that [`write_file`] could start now, for callers with long work before the write. Changes nothing.
///
/// # Errors
/// The system's error, if the write could not start.
pub fn check_writable(path: &Path) -> io::Result<()> {
    let target = resolve_links(path)?;
    match replaceable_file(&target)? {
        None => create_partial(&target).and_then(|(partial, _)| fs::remove_file(partial)),
        Some(_) => nonblocking().write(true).open(&target).map(drop),
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
        let target = resolve_links(path).unwrap_or_else(|_| path.into());
        let folder = folder_of(&target);
        let folder = fs::canonicalize(folder).unwrap_or_else(|_| folder.into());
        Self(Identity::Place(folder.join(target.file_name().unwrap_or_default())))
    }
}

/// Maximum number of symbolic links to follow; the limit of Linux.
const MAX_LINKS: u32 = 40;

/// Follows symbolic links. The target need not exist.
fn resolve_links(path: &Path) -> io::Result<PathBuf> {
    let mut target = path.to_path_buf();
    for _ in 0..=MAX_LINKS {
        let Ok(link) = fs::read_link(&target) else { return Ok(target) };
        target = target.parent().unwrap_or(Path::new("")).join(link);
    }
    Err(io::Error::from_raw_os_error(LINK_LOOP))
}

/// Returns the file at a path; `None` if nothing is there.
///
/// # Errors
/// If something other than a file is there.
fn replaceable_file(path: &Path) -> io::Result<Option<Metadata>> {
    match fs::symlink_metadata(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        found => {
            let found = found?;
            check_is_file(&found)?;
            Ok(Some(found))
        }
    }
}

fn check_is_file(found: &Metadata) -> io::Result<()> {
    if found.is_file() {
        return Ok(());
    }
    let found = file_type::name(found);
    let reason = format!("{found}, not a file; expected a file, or a name that does not exist yet");
    Err(io::Error::new(ErrorKind::InvalidData, reason))
}

/// Names the target of a link in the error of a target that is not a file.
fn explain_link(path: &Path, target: &Path, error: io::Error) -> io::Error {
    if path == target || error.kind() != ErrorKind::InvalidData {
        return error;
    }
    io::Error::new(error.kind(), format!("a link to {}: {error}", display_path(target)))
}

fn write_atomically(path: &Path, old: Option<&Metadata>, contents: &mut dyn Read) -> io::Result<()> {
    if old.is_some_and(has_hard_links) {
        return overwrite(path, contents);
    }
    let (partial, file) = match create_partial(path) {
        Err(_) if old.is_some() => return overwrite(path, contents),
        made => made?,
    };
    if old.is_some_and(|old| !take_owner(&file, old)) {
        fs::remove_file(&partial)?;
        return overwrite(path, contents);
    }
    put(&partial, file, path, old, contents)
}

/// Writes the temporary file and renames it.
fn put(partial: &Path, mut file: File, path: &Path, old: Option<&Metadata>, contents: &mut dyn Read) -> io::Result<()> {
    remove_stale_partials(folder_of(path));
    let mut write = || {
        io::copy(contents, &mut file)?;
        if let Some(old) = old {
            fs::set_permissions(partial, old.permissions())?;
        }
        // Without a sync, a file system may persist the rename before the data.
        file.sync_all()?;
        // Another program may have put something else in place meanwhile.
        replaceable_file(path)?;
        fs::rename(partial, path)
    };
    write().inspect_err(|_| {
        let _ = fs::remove_file(partial);
    })?;
    sync_folder(folder_of(path));
    Ok(())
}

/// Gives a new file the owner and the group of an old one. Returns false if that is not permitted.
#[cfg(unix)]
fn take_owner(file: &File, old: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    let owner = |found: &Metadata| (found.uid(), found.gid());
    file.metadata().is_ok_and(|new| owner(&new) == owner(old))
        || std::os::unix::fs::fchown(file, Some(old.uid()), Some(old.gid())).is_ok()
}

#[cfg(not(unix))]
fn take_owner(_: &File, _: &Metadata) -> bool {
    true
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
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let is_partial =
            |name: &str| name.strip_prefix(PARTIAL.0).is_some_and(|rest| rest.strip_suffix(PARTIAL.1).is_some());
        if entry.file_name().to_str().is_some_and(is_partial)
            && entry.file_type().is_ok_and(|kind| kind.is_file())
            && let Ok(left) = nonblocking().write(true).open(entry.path())
            && left.try_lock().is_ok()
        {
            let _ = fs::remove_file(entry.path());
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

fn overwrite(path: &Path, contents: &mut dyn Read) -> io::Result<()> {
    fn write(file: &mut File, contents: &mut dyn Read) -> io::Result<()> {
        file.rewind()?;
        let written = io::copy(contents, file)?;
        file.set_len(written)?;
        file.sync_all()
    }
    let mut file = nonblocking().read(true).write(true).open(path)?;
    check_is_file(&file.metadata()?)?;
    let mut before = Vec::new();
    file.read_to_end(&mut before)?;
    write(&mut file, contents).inspect_err(|_| {
        let _ = write(&mut file, &mut &*before);
    })
}

#[cfg(test)]
mod tests;
