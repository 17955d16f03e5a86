//! What was being done when the program was ended without a chance to ask.
//!
//! Every running tweaker has a pair of files in the state folder: `recovery-N.json`, the preset, while it is not saved; and
//! `recovery-N.lock`, with the path that it came from, which it holds as long as it lives. A pair that nobody holds is of one that
//! has crashed.

use std::path::{Path, PathBuf};

use haze::Error;
use haze::preset::Preset;

use super::document::Document;
use crate::tweak::platform::clock::{Duration, Instant};
use crate::tweak::platform::files;
use crate::tweak::platform::lock::Lock;

/// Between two times that the file is written: this much work is lost at most.
pub const WRITE_EVERY: Duration = Duration::from_secs(3);

/// The files of this process. Dropped without [`Recovery::finish`], as in a panic, they stay.
pub struct Recovery {
    folder: PathBuf,
    lock: Option<Lock>,
    /// What is in the files.
    written: Option<(Preset, PathBuf)>,
    last: Option<Instant>,
    is_broken: bool,
}

impl Recovery {
    /// Makes nothing yet.
    pub fn new(folder: &Path) -> Self {
        Self { folder: folder.into(), lock: None, written: None, last: None, is_broken: false }
    }

    /// To be called often: writes the file, not more often than every [`WRITE_EVERY`], while the document is not saved, and removes
    /// it once it is. That it cannot be written is said once.
    pub fn keep(&mut self, document: &Document, now: Instant) -> Result<(), Error> {
        if !document.is_dirty() {
            self.forget();
            return Ok(());
        }
        if self.last.is_some_and(|last| now.saturating_duration_since(last) < WRITE_EVERY) {
            return Ok(());
        }
        self.last = Some(now);
        let done = self.write(document);
        let was_broken = std::mem::replace(&mut self.is_broken, done.is_err());
        if was_broken { Ok(()) } else { done }
    }

    /// Writes the file now, if it does not hold the document already. A preset that could not be opened again is not written: the
    /// file keeps the last one that could.
    pub fn write(&mut self, document: &Document) -> Result<(), Error> {
        let is_written = self.written.as_ref().is_some_and(|(preset, _)| *preset == document.preset);
        if is_written || document.preset.validate().is_err() {
            return Ok(());
        }
        let path = if document.is_built_in() { document.path().into() } else { files::absolute(document.path()) };
        let lock = match &mut self.lock {
            Some(lock) => lock,
            none => {
                files::make_folder(&self.folder)?;
                none.insert(free_lock(&self.folder)?)
            }
        };
        if self.written.as_ref().is_none_or(|(_, written)| *written != path) {
            // A path that is no text cannot be said in one: it is recovered without.
            let written = lock.write(path.to_str().unwrap_or_default());
            written.map_err(|error| Error::Io { path: lock.path().into(), error })?;
        }
        files::write(&preset_beside(lock.path()), document.preset.to_text("").as_bytes())?;
        self.written = Some((document.preset.clone(), path));
        Ok(())
    }

    /// Whether there is something that [`Recovery::keep`] will write, once it is time to.
    pub fn is_behind(&self, document: &Document) -> bool {
        let is_written = self.written.as_ref().is_some_and(|(preset, _)| *preset == document.preset);
        document.is_dirty() && !is_written && !self.is_broken && document.preset.validate().is_ok()
    }

    fn forget(&mut self) {
        if self.written.take().is_some()
            && let Some(lock) = &self.lock
        {
            files::remove(&preset_beside(lock.path()));
        }
    }

    /// Leaves nothing, when the program ends as it should.
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

/// A name that no tweaker uses.
fn free_lock(folder: &Path) -> Result<Lock, Error> {
    /// Many more than anybody runs.
    const MOST: u32 = 1000;
    let path = |number| folder.join(format!("recovery-{number}.lock"));
    let is_free = |path: &PathBuf| !files::exists(&preset_beside(path));
    let free = (1..MOST).map(path).filter(is_free).find_map(|path| Lock::take(&path));
    free.ok_or_else(|| {
        let error = std::io::Error::other("no file can be held here; expected a folder that can be written");
        Error::Io { path: path(1), error }
    })
}

/// The work of a tweaker that has crashed. It is held, so that no other tweaker offers it too; dropped, it is offered again at the
/// next start.
pub struct Abandoned {
    lock: Lock,
    /// What was being done.
    pub preset: Preset,
    /// The file or built-in preset that it came from.
    pub source: PathBuf,
}

impl Abandoned {
    /// Removes it: it has been taken over, or nobody wants it.
    pub fn discard(self) {
        files::remove(&preset_beside(self.lock.path()));
        self.lock.remove();
    }
}

/// What crashed tweakers have left in the folder; with what is wrong with files that cannot be read, which are left alone.
pub fn abandoned(folder: &Path) -> (Vec<Abandoned>, Vec<Error>) {
    let (mut found, mut errors) = (Vec::new(), Vec::new());
    let is_lock = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        name.starts_with("recovery-") && name.ends_with(".lock")
    };
    for path in files::list(folder).into_iter().filter(is_lock) {
        let Some(mut lock) = Lock::take(&path) else { continue };
        let preset = preset_beside(&path);
        if !files::exists(&preset) {
            // It crashed with everything saved.
            lock.remove();
            continue;
        }
        let source = lock.read().unwrap_or_default();
        let source = if source.is_empty() { "recovered.json".into() } else { PathBuf::from(source) };
        match files::read_preset(&preset) {
            Ok((preset, _)) => found.push(Abandoned { lock, preset, source }),
            Err(error) => errors.push(error),
        }
    }
    (found, errors)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::tweak::platform::lock::eventually;

    /// What is offered once the locks are given back.
    fn offered(folder: &Path) -> Vec<Abandoned> {
        eventually(|| Some(abandoned(folder).0).filter(|offered| !offered.is_empty()))
    }

    fn changed(exposure: f32) -> Document {
        let mut document = Document::open(Path::new("column")).unwrap();
        document.preset.camera.exposure = exposure;
        document
    }

    fn names(folder: &Path) -> Vec<String> {
        files::list(folder).iter().map(|path| path.file_name().unwrap().to_str().unwrap().to_owned()).collect()
    }

    #[test]
    fn what_a_crash_leaves_is_offered_once() {
        let folder = tempfile::tempdir().unwrap();
        let (state, now) = (folder.path().join("state"), Instant::now());
        let mut document = changed(1.0);
        let mut recovery = Recovery::new(&state);
        recovery.keep(&document, now).unwrap();
        // While it lives, and another works beside it, nothing is offered.
        let mut beside = Recovery::new(&state);
        beside.keep(&changed(3.0), now).unwrap();
        assert_eq!(abandoned(&state).0.len(), 0);
        // Not more often than every few seconds.
        document.preset.camera.exposure = 2.0;
        recovery.keep(&document, now + WRITE_EVERY / 2).unwrap();
        let found = |name: &str| Preset::load(state.join(name)).unwrap().camera.exposure;
        assert_eq!((found("recovery-1.json"), found("recovery-2.json")), (1.0, 3.0));
        recovery.keep(&document, now + WRITE_EVERY).unwrap();
        assert_eq!((found("recovery-1.json"), found("recovery-2.json")), (2.0, 3.0));
        // The end of a process gives its locks back, as this does.
        drop(recovery);
        let mut offered = offered(&state);
        assert_eq!(offered.len(), 1);
        assert_eq!(abandoned(&state).0.len(), 0, "offered to one only");
        let one = offered.remove(0);
        let recovered = Document::recovered(one.preset.clone(), &one.source);
        assert!(recovered.is_dirty() && recovered.is_built_in() && recovered.preset == document.preset);
        assert_eq!(recovered.history().undo_name(), Some("recover"));
        one.discard();
        assert_eq!(names(&state), ["recovery-2.json", "recovery-2.lock"]);
        beside.finish();
        assert_eq!(names(&state), [""; 0]);
    }

    #[test]
    fn saved_work_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let (state, now) = (folder.path(), Instant::now());
        let mut document = changed(1.0);
        let mut recovery = Recovery::new(state);
        recovery.keep(&document, now).unwrap();
        document.undo();
        recovery.keep(&document, now).unwrap();
        assert_eq!(names(state), ["recovery-1.lock"]);
        // To and fro is not written more often than anything else.
        document.redo();
        recovery.keep(&document, now).unwrap();
        assert_eq!(names(state), ["recovery-1.lock"]);
        recovery.keep(&document, now + WRITE_EVERY).unwrap();
        assert_eq!(names(state), ["recovery-1.json", "recovery-1.lock"]);
        document.undo();
        recovery.keep(&document, now + WRITE_EVERY).unwrap();
        drop(recovery);
        eventually(|| {
            assert_eq!(abandoned(state).0.len(), 0);
            names(state).is_empty().then_some(())
        });
    }

    #[test]
    fn the_last_good_state_is_kept_with_its_file() {
        let folder = tempfile::tempdir().unwrap();
        let (state, file) = (folder.path().join("state"), folder.path().join("shot.json"));
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
        // Broken by other hands: said, and left.
        fs::write(state.join("recovery-1.json"), "{").unwrap();
        let (offered, errors) = eventually(|| Some(abandoned(&state)).filter(|(_, errors)| !errors.is_empty()));
        assert!(offered.is_empty() && errors.len() == 1 && state.join("recovery-1.json").exists());
        // Its name is not taken.
        let mut recovery = Recovery::new(&state);
        recovery.write(&changed(3.0)).unwrap();
        assert_eq!(fs::read_to_string(state.join("recovery-1.json")).unwrap(), "{");
    }

    #[test]
    fn a_folder_that_cannot_be_written_is_said_once() {
        let folder = tempfile::tempdir().unwrap();
        let blocked = folder.path().join("state");
        fs::write(&blocked, "a file").unwrap();
        let (mut recovery, now) = (Recovery::new(&blocked), Instant::now());
        assert!(recovery.keep(&changed(1.0), now).is_err());
        assert!(recovery.keep(&changed(1.0), now + WRITE_EVERY).is_ok());
        fs::remove_file(&blocked).unwrap();
        recovery.keep(&changed(1.0), now + 2 * WRITE_EVERY).unwrap();
        assert_eq!(names(&blocked).len(), 2);
    }
}
