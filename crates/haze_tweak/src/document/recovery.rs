//! Recovery of unsaved work after a crash.
//!
//! Every running tweaker has a pair of files in the state folder: `recovery-N.json`, the preset, while it is not saved;
//! and `recovery-N.lock` with the path of the preset, which the process keeps locked while it runs. An unlocked pair
//! belongs to a process that has crashed.

use std::path::{Path, PathBuf};

use haze_core::error::{AssetError, Error};
use haze_preset::Preset;

use super::Document;
use crate::platform::clock::{Duration, Instant};
use crate::platform::file_io;
use crate::platform::lock_file::Lock;

/// Interval of writing the file: at most this much work is lost.
pub const RECOVERY_WRITE_INTERVAL: Duration = Duration::from_secs(3);

/// Recovery files of this process. If it is dropped without [`Recovery::finish`], as in a panic, the files stay.
pub struct Recovery {
    folder: PathBuf,
    lock: Option<Lock>,
    /// Content of the files.
    written: Option<(Preset, PathBuf)>,
    last: Option<Instant>,
    is_broken: bool,
}

impl Recovery {
    /// Creates no file yet.
    pub fn new(folder: &Path) -> Self {
        Self { folder: folder.into(), lock: None, written: None, last: None, is_broken: false }
    }

    /// Writes the file while the document is not saved, at most once in [`RECOVERY_WRITE_INTERVAL`], and removes it once the
    /// document is saved. Call often. A write error is returned once.
    pub fn write_periodically(&mut self, document: &Document, now: Instant) -> Result<(), Error> {
        if !document.is_dirty() {
            self.forget();
            return Ok(());
        }
        if self.last.is_some_and(|last| now.saturating_duration_since(last) < RECOVERY_WRITE_INTERVAL) {
            return Ok(());
        }
        self.last = Some(now);
        let done = self.write(document);
        let was_broken = std::mem::replace(&mut self.is_broken, done.is_err());
        if was_broken { Ok(()) } else { done }
    }

    /// Writes the file now, unless it already has this preset. An invalid preset is not written, because it could not
    /// be opened again; the file keeps the last valid one.
    pub fn write(&mut self, document: &Document) -> Result<(), Error> {
        let is_written = self.written.as_ref().is_some_and(|(preset, _)| *preset == document.preset);
        if is_written || document.preset.validate().is_err() {
            return Ok(());
        }
        let path = if document.is_built_in() { document.path().into() } else { file_io::absolute(document.path()) };
        let lock = match &mut self.lock {
            Some(lock) => lock,
            none => {
                file_io::make_folder(&self.folder)?;
                none.insert(free_lock(&self.folder)?)
            }
        };
        if self.written.as_ref().is_none_or(|(_, written)| *written != path) {
            // A path that is not Unicode cannot be written as text; the work is then recovered without it.
            let written = lock.write(path.to_str().unwrap_or_default());
            written.map_err(|error| Error::from(AssetError::Io { path: lock.path().into(), error }))?;
        }
        file_io::write_state_file(&preset_beside(lock.path()), document.preset.to_json("").as_bytes())?;
        self.written = Some((document.preset.clone(), path));
        Ok(())
    }

    /// Returns true if [`Recovery::write_periodically`] will write something when the interval is over.
    pub fn has_pending_write(&self, document: &Document) -> bool {
        let is_written = self.written.as_ref().is_some_and(|(preset, _)| *preset == document.preset);
        document.is_dirty() && !is_written && !self.is_broken && document.preset.validate().is_ok()
    }

    fn forget(&mut self) {
        if self.written.take().is_some()
            && let Some(lock) = &self.lock
        {
            file_io::remove(&preset_beside(lock.path()));
        }
    }

    /// Removes the files. Call when the program ends normally.
    pub fn finish(mut self) {
        self.forget();
        if let Some(lock) = self.lock {
            lock.remove();
        }
    }
}

fn preset_beside(lock: &Path) -> PathBuf {
    lock.with_extension("json")
}

/// Takes a lock file that no process uses.
fn free_lock(folder: &Path) -> Result<Lock, Error> {
    /// Far more than the number of tweakers that run at the same time.
    const MAX_LOCKS: u32 = 1000;
    let path = |number| folder.join(format!("recovery-{number}.lock"));
    let is_free = |path: &PathBuf| !file_io::is_taken(&preset_beside(path));
    let free = (1..MAX_LOCKS).map(path).filter(is_free).find_map(|path| Lock::take(&path));
    free.ok_or_else(|| {
        let error = std::io::Error::other("cannot lock a file here; expected a writable folder");
        Error::from(AssetError::Io { path: path(1), error })
    })
}

/// Unsaved work of a crashed process. It stays locked, so that no other tweaker offers it too. If it is dropped, it is
/// offered again at the next start.
pub struct CrashedWork {
    lock: Lock,
    /// Unsaved preset.
    pub preset: Preset,
    /// File or built-in preset that it came from.
    pub source: PathBuf,
}

impl CrashedWork {
    /// Removes its files: it was restored, or the user does not want it.
    pub fn discard(self) {
        file_io::remove(&preset_beside(self.lock.path()));
        self.lock.remove();
    }
}

/// Returns the unsaved work of crashed processes in the folder, and the errors of files that cannot be read. Those
/// files stay.
pub fn find_crashed_work(folder: &Path) -> (Vec<CrashedWork>, Vec<Error>) {
    let mut found = Vec::new();
    let mut errors = Vec::new();
    let is_lock = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        name.starts_with("recovery-") && name.ends_with(".lock")
    };
    for path in file_io::list(folder).into_iter().filter(is_lock) {
        let Some(mut lock) = Lock::take(&path) else { continue };
        let preset = preset_beside(&path);
        if !file_io::exists(&preset) {
            // The process crashed without unsaved work.
            lock.remove();
            continue;
        }
        let source = lock.read().unwrap_or_default();
        let source = if source.is_empty() { "recovered.json".into() } else { PathBuf::from(source) };
        match file_io::read_preset(&preset) {
            Ok((preset, _)) => found.push(CrashedWork { lock, preset, source }),
            Err(error) => errors.push(error),
        }
    }
    (found, errors)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::platform::lock_file::eventually;

    /// Returns the work that is offered after the locks are released.
    fn offered(folder: &Path) -> Vec<CrashedWork> {
        eventually(|| Some(find_crashed_work(folder).0).filter(|offered| !offered.is_empty()))
    }

    fn changed(exposure: f32) -> Document {
        let mut document = Document::open(Path::new("column")).unwrap();
        document.preset.camera.exposure = exposure;
        document
    }

    fn names(folder: &Path) -> Vec<String> {
        file_io::list(folder).iter().map(|path| path.file_name().unwrap().to_str().unwrap().to_owned()).collect()
    }

    #[test]
    fn work_left_by_a_crash_is_offered_once() {
        let folder = tempfile::tempdir().unwrap();
        let state = folder.path().join("state");
        let now = Instant::now();
        let mut document = changed(1.0);
        let mut recovery = Recovery::new(&state);
        recovery.write_periodically(&document, now).unwrap();
        // While the process runs, with another one beside it, nothing is offered.
        let mut beside = Recovery::new(&state);
        beside.write_periodically(&changed(3.0), now).unwrap();
        assert_eq!(find_crashed_work(&state).0.len(), 0);
        // It is not written more often than every few seconds.
        document.preset.camera.exposure = 2.0;
        recovery.write_periodically(&document, now + RECOVERY_WRITE_INTERVAL / 2).unwrap();
        let found = |name: &str| Preset::load(state.join(name)).unwrap().camera.exposure;
        assert_eq!((found("recovery-1.json"), found("recovery-2.json")), (1.0, 3.0));
        recovery.write_periodically(&document, now + RECOVERY_WRITE_INTERVAL).unwrap();
        assert_eq!((found("recovery-1.json"), found("recovery-2.json")), (2.0, 3.0));
        // Dropping releases the lock, like the end of the process.
        drop(recovery);
        let mut offered = offered(&state);
        assert_eq!(offered.len(), 1);
        assert_eq!(find_crashed_work(&state).0.len(), 0, "offered to one only");
        let one = offered.remove(0);
        let recovered = Document::recovered(one.preset.clone(), &one.source);
        assert!(recovered.is_dirty() && recovered.is_built_in() && recovered.preset == document.preset);
        assert_eq!(recovered.history().undo_name(), Some("Recover"));
        one.discard();
        assert_eq!(names(&state), ["recovery-2.json", "recovery-2.lock"]);
        beside.finish();
        assert_eq!(names(&state), [""; 0]);
    }

    #[test]
    fn saved_work_leaves_no_files() {
        let folder = tempfile::tempdir().unwrap();
        let state = folder.path();
        let now = Instant::now();
        let mut document = changed(1.0);
        let mut recovery = Recovery::new(state);
        recovery.write_periodically(&document, now).unwrap();
        document.undo();
        recovery.write_periodically(&document, now).unwrap();
        assert_eq!(names(state), ["recovery-1.lock"]);
        // Undo and redo do not cause more frequent writes.
        document.redo();
        recovery.write_periodically(&document, now).unwrap();
        assert_eq!(names(state), ["recovery-1.lock"]);
        recovery.write_periodically(&document, now + RECOVERY_WRITE_INTERVAL).unwrap();
        assert_eq!(names(state), ["recovery-1.json", "recovery-1.lock"]);
        document.undo();
        recovery.write_periodically(&document, now + RECOVERY_WRITE_INTERVAL).unwrap();
        drop(recovery);
        eventually(|| {
            assert_eq!(find_crashed_work(state).0.len(), 0);
            names(state).is_empty().then_some(())
        });
    }

    #[test]
    fn the_last_valid_preset_is_kept_with_its_path() {
        let folder = tempfile::tempdir().unwrap();
        let state = folder.path().join("state");
        let file = folder.path().join("shot.json");
        let mut document = changed(1.0);
        document.save_as(&file).unwrap();
        let mut recovery = Recovery::new(&state);
        document.preset.camera.exposure = 2.0;
        recovery.write(&document).unwrap();
        document.preset.camera.exposure = f32::NAN;
        recovery.write(&document).unwrap();
        drop(recovery);
        fs::remove_file(&file).unwrap();
        let one = offered(&state).remove(0);
        assert_eq!((one.preset.camera.exposure, &one.source), (2.0, &file));
        let recovered = Document::recovered(one.preset.clone(), &one.source);
        assert!(recovered.is_dirty() && recovered.saved().is_none() && recovered.path() == file);
        drop(one);
        // A file that was corrupted from outside is reported and not touched.
        fs::write(state.join("recovery-1.json"), "{").unwrap();
        let (offered, errors) = eventually(|| Some(find_crashed_work(&state)).filter(|(_, errors)| !errors.is_empty()));
        assert!(offered.is_empty() && errors.len() == 1 && state.join("recovery-1.json").exists());
        // Its number is not used again.
        let mut recovery = Recovery::new(&state);
        recovery.write(&changed(3.0)).unwrap();
        assert_eq!(fs::read_to_string(state.join("recovery-1.json")).unwrap(), "{");
    }

    #[test]
    fn an_unwritable_folder_is_reported_once() {
        let folder = tempfile::tempdir().unwrap();
        let blocked = folder.path().join("state");
        fs::write(&blocked, "a file").unwrap();
        let mut recovery = Recovery::new(&blocked);
        let now = Instant::now();
        assert!(recovery.write_periodically(&changed(1.0), now).is_err());
        assert!(recovery.write_periodically(&changed(1.0), now + RECOVERY_WRITE_INTERVAL).is_ok());
        fs::remove_file(&blocked).unwrap();
        recovery.write_periodically(&changed(1.0), now + 2 * RECOVERY_WRITE_INTERVAL).unwrap();
        assert_eq!(names(&blocked).len(), 2);
    }
}
