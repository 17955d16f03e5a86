//! What the threads of a watcher share.

use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::path::PathBuf;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use super::quiet::{Seen, Todo};
use super::stamp::Stamp;

/// Nothing in here grows with what happens: signals are flags, and a file is told once however often it was written.
#[derive(Default)]
pub struct Shared {
    state: Mutex<State>,
    has_changed: Condvar,
}

#[derive(Default)]
pub struct State {
    pub files: BTreeMap<PathBuf, Seen>,
    /// All places that decide where the files are.
    pub places: HashSet<PathBuf>,
    /// The files that have changed.
    pub changed: BTreeSet<PathBuf>,
    /// To be said once.
    pub note: Option<String>,
    pub is_over: bool,
    signal: Option<Signal>,
}

/// Something has happened.
#[derive(Clone, Copy, Default)]
pub struct Signal {
    /// The files may be elsewhere.
    pub has_moved: bool,
    /// A folder on the way may be another by the same name.
    pub is_lost: bool,
}

impl Shared {
    pub fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Says that something has happened somewhere.
    pub fn signal(&self, is_lost: bool) {
        self.add(&mut self.lock(), Signal { has_moved: true, is_lost });
    }

    /// Says that something has happened there, if it matters.
    pub fn signal_at(&self, paths: &[PathBuf], has_moved: bool) {
        let mut state = self.lock();
        let Some(path) = paths.iter().find(|path| state.places.contains(*path)) else { return };
        let is_inside = |place: &PathBuf| place.starts_with(path) && place != path;
        let is_lost = has_moved && state.places.iter().any(is_inside);
        self.add(&mut state, Signal { has_moved, is_lost });
    }

    fn add(&self, state: &mut State, signal: Signal) {
        let signals = state.signal.get_or_insert_default();
        signals.has_moved |= signal.has_moved;
        signals.is_lost |= signal.is_lost;
        self.has_changed.notify_all();
    }

    pub fn end(&self) {
        self.lock().is_over = true;
        self.has_changed.notify_all();
    }

    /// Waits for a signal, or until then; for ever where there is no then. None when it is over.
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

    /// Looks at every file. Gives whether there is something new to tell, and when to look again.
    pub fn look(&self) -> (bool, Option<Instant>) {
        // Not while the state is locked: a disk may be slow.
        let files: Vec<_> = self.lock().files.keys().cloned().collect();
        let stamps: Vec<_> = files.into_iter().map(|file| (Stamp::of(&file), file)).collect();
        let mut state = self.lock();
        let (mut is_new, mut next) = (false, None::<Instant>);
        for (stamp, file) in stamps {
            match state.files.get_mut(&file).map(|seen| seen.look(stamp, Instant::now())) {
                None | Some(Todo::Nothing) => {}
                Some(Todo::Tell) => is_new |= state.changed.insert(file),
                Some(Todo::LookAgain(at)) => next = Some(next.map_or(at, |next| next.min(at))),
            }
        }
        (is_new, next)
    }
}
