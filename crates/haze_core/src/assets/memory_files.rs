//! Files in memory, for browsers, which have no disk. They replace the system's files in a build for wasm32: what a preset
//! or a recipe names is read from here.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, ErrorKind};
use std::path::{Component, Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::error::AssetError;

static FILES: Mutex<Files> = Mutex::new(Files { files: BTreeMap::new(), changed: BTreeSet::new(), writes: 0 });

struct Files {
    /// Contents, and the number of the write that they are from.
    files: BTreeMap<PathBuf, (u64, Vec<u8>)>,
    /// Paths since the last [`take_changed`].
    changed: BTreeSet<PathBuf>,
    writes: u64,
}

/// Returns the path from the only root: `./a.png` and `/a.png` are `a.png`.
fn key(path: &Path) -> PathBuf {
    path.components().filter(|part| matches!(part, Component::Normal(_))).collect()
}

fn lock() -> MutexGuard<'static, Files> {
    FILES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Reads a file of at most `max_bytes` bytes. `kind` names the expected file type in errors.
///
/// # Errors
/// [`AssetError::Io`], which names what was found and what is expected.
pub fn read(path: &Path, kind: &str, max_bytes: u64) -> Result<Vec<u8>, AssetError> {
    let io = |error| AssetError::Io { path: path.into(), error };
    let files = lock();
    let (_, bytes) = files.files.get(&key(path)).ok_or_else(|| io(ErrorKind::NotFound.into()))?;
    if bytes.len() as u64 > max_bytes {
        let expected = format!("a {kind} of at most {max_bytes} bytes ({} MiB)", max_bytes >> 20);
        let reason = format!("{} bytes; expected {expected}", bytes.len());
        return Err(io(io::Error::new(ErrorKind::InvalidData, reason)));
    }
    Ok(bytes.clone())
}

/// Adds or replaces a file.
///
/// # Errors
/// None; files on a disk have some.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), AssetError> {
    let mut files = lock();
    files.writes += 1;
    let write = files.writes;
    files.files.insert(key(path), (write, bytes.into()));
    files.changed.insert(key(path));
    Ok(())
}

/// As [`write_file`].
///
/// # Errors
/// As [`write_file`].
pub fn write_state_file(path: &Path, bytes: &[u8]) -> Result<(), AssetError> {
    write_file(path, bytes)
}

/// Removes a file, if it is there.
pub fn remove(path: &Path) {
    let mut files = lock();
    if files.files.remove(&key(path)).is_some() {
        files.changed.insert(key(path));
    }
}

/// Returns a number that differs after each write of the file; `None` if it is not there.
pub fn stamp(path: &Path) -> Option<u64> {
    lock().files.get(&key(path)).map(|(write, _)| *write)
}

/// Returns the paths that were written or removed since the last call.
pub fn take_changed() -> BTreeSet<PathBuf> {
    std::mem::take(&mut lock().changed)
}

/// Lists the names of the files directly in a folder.
///
/// # Errors
/// None; folders on a disk have some.
pub fn names(folder: &Path) -> io::Result<impl Iterator<Item = String>> {
    let folder = key(folder);
    let is_in = |path: &&PathBuf| path.parent() == Some(&folder);
    let name = |path: &PathBuf| path.file_name()?.to_str().map(str::to_owned);
    Ok(lock().files.keys().filter(is_in).filter_map(name).collect::<Vec<_>>().into_iter())
}

/// True if there is a file of this path.
pub fn is_taken(path: &Path) -> bool {
    lock().files.contains_key(&key(path))
}

/// Identity of a file: its path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileIdentity(PathBuf);

impl FileIdentity {
    /// Determines the identity of the file at `path`.
    pub fn of(path: &Path) -> Self {
        Self(key(path))
    }
}
