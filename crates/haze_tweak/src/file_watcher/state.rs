//! State that the threads of a watcher share.

use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::path::PathBuf;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use super::settle::{FileAction, FileState};
use super::stamp::Stamp;

/// Its size does not grow with events: signals are flags, and a changed file is listed once however often it was
/// written.
#[derive(Default)]
pub struct Shared {
    state: Mutex<State>,
    has_changed: Condvar,
}

#[derive(Default)]
pub struct State {
    pub files: BTreeMap<PathBuf, FileState>,
    /// All locations that decide where the files are.
    pub locations: HashSet<PathBuf>,
    /// Changed files that have not been polled.
    pub changed: BTreeSet<PathBuf>,
    /// Message to report once.
    pub message: Option<String>,
    pub is_over: bool,
    signal: Option<Signal>,
}

/// Events since the last check.
#[derive(Clone, Copy, Default)]
pub struct Signal {
    /// Paths of files may lead elsewhere now.
    pub paths_changed: bool,
    /// A folder on the way may have been replaced by another of the same name.
    pub rewatch_all: bool,
}

impl Shared {
    pub fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Signals that something has happened at an unknown path.
    pub fn signal(&self, rewatch_all: bool) {
        self.add(&mut self.lock(), Signal { paths_changed: true, rewatch_all });
    }

    /// Signals that something has happened at these paths, if one path matters.
    pub fn signal_at(&self, paths: &[PathBuf], paths_changed: bool) {
        let mut state = self.lock();
        let Some(path) = paths.iter().find(|path| state.locations.contains(*path)) else { return };
        let is_inside = |location: &PathBuf| location.starts_with(path) && location != path;
        let rewatch_all = paths_changed && state.locations.iter().any(is_inside);
        self.add(&mut state, Signal { paths_changed, rewatch_all });
    }

    fn add(&self, state: &mut State, signal: Signal) {
        let signals = state.signal.get_or_insert_default();
        signals.paths_changed |= signal.paths_changed;
        signals.rewatch_all |= signal.rewatch_all;
        self.has_changed.notify_all();
    }

    pub fn end(&self) {
        self.lock().is_over = true;
        self.has_changed.notify_all();
    }

    /// Waits for a signal, or until a time; for ever without a time. Returns `None` when the watcher ends.
    pub fn wait(&self, until: Option<Instant>) -> Option<Signal> {
        let mut state = self.lock();
        loop {
            if state.is_over {
                return None;
            }
            if let Some(signal) = state.signal.take() {
                return Some(signal);
            }
            state = match until.map(|until| until.saturating_duration_since(Instant::now())) {
                None => self.has_changed.wait(state).unwrap_or_else(PoisonError::into_inner),
                Some(left) if left.is_zero() => return Some(Signal::default()),
                Some(left) => self.has_changed.wait_timeout(state, left).unwrap_or_else(PoisonError::into_inner).0,
            };
        }
    }

    /// Checks every file. Returns true if there are new changes to report, and the time of the next check.
    pub fn check_files(&self) -> (bool, Option<Instant>) {
        // The state is not locked meanwhile, because a disk may be slow.
        let files: Vec<_> = self.lock().files.keys().cloned().collect();
        let stamps: Vec<_> = files.into_iter().map(|file| (Stamp::of(&file), file)).collect();
        let mut state = self.lock();
        let mut is_new = false;
        let mut next = None::<Instant>;
        for (stamp, file) in stamps {
            match state.files.get_mut(&file).map(|file| file.update(stamp, Instant::now())) {
                None | Some(FileAction::Nothing) => {}
                Some(FileAction::Report) => is_new |= state.changed.insert(file),
                Some(FileAction::CheckAgain(at)) => next = Some(next.map_or(at, |next| next.min(at))),
            }
        }
        (is_new, next)
    }
}
