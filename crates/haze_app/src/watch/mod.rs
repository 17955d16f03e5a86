//! Tells which files have changed, whichever way they are written.
//!
//! The system gives notice of whatever happens in the folders on the way to the files; that is only a sign to look. What counts is
//! whether a file looks another, and has stayed so for a moment: writing in place, renaming over, deleting and making anew, and
//! swapping a link are all one then. Without notice the files are looked at twice a second.

mod notice;
mod quiet;
mod route;
mod stamp;
mod state;

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};
use std::{io, thread};

pub use stamp::Stamp;

use notice::{Folders, Make};
use quiet::Seen;
use state::Shared;

/// Between two looks at the files where the system gives no notice.
const LOOK_EVERY: Duration = Duration::from_millis(500);

/// What happens at once is looked at once.
const GATHER: Duration = Duration::from_millis(5);

/// A set of files, and a thread that sleeps until something happens to one of them.
pub struct Watcher {
    shared: Arc<Shared>,
}

impl Watcher {
    /// Watches nothing yet. `wake` is called from another thread when [`Watcher::poll`] has something new.
    pub fn new(wake: impl Fn() + Send + 'static) -> io::Result<Self> {
        Self::start(wake, notice::system)
    }

    fn start(wake: impl Fn() + Send + 'static, make: Make) -> io::Result<Self> {
        let shared = Arc::new(Shared::default());
        let its = Arc::clone(&shared);
        thread::Builder::new().name("haze watch".into()).spawn(move || run(&its, wake, make))?;
        Ok(Self { shared })
    }

    /// Watches these files, of which some may not be there yet, and no others. To be called before they are read: what happens
    /// from now on is told.
    pub fn set(&self, files: impl IntoIterator<Item = PathBuf>) {
        self.watch(files, true);
    }

    /// The same for who has not read them: those that are new to it are told as they are.
    pub fn set_unread(&self, files: impl IntoIterator<Item = PathBuf>) {
        self.watch(files, false);
    }

    fn watch(&self, files: impl IntoIterator<Item = PathBuf>, is_told: bool) {
        let files: BTreeSet<_> = files.into_iter().collect();
        let known: BTreeSet<_> = self.shared.lock().files.keys().cloned().collect();
        if files == known {
            return;
        }
        let new: Vec<_> = files.difference(&known).map(|file| (file.clone(), Stamp::of(file))).collect();
        let mut state = self.shared.lock();
        state.files.retain(|file, _| files.contains(file));
        state.changed.retain(|file| files.contains(file));
        state.files.extend(new.into_iter().map(|(file, stamp)| (file, Seen::new(stamp, is_told, Instant::now()))));
        drop(state);
        self.shared.signal(false);
    }

    /// The files that have changed since it was asked last, or are gone: each once, when it is whole.
    pub fn poll(&self) -> Vec<PathBuf> {
        std::mem::take(&mut self.shared.lock().changed).into_iter().collect()
    }

    /// What is to be said about the watching itself, once.
    pub fn note(&self) -> Option<String> {
        self.shared.lock().note.take()
    }
}

impl Drop for Watcher {
    fn drop(&mut self) {
        self.shared.end();
    }
}

fn run(shared: &Arc<Shared>, wake: impl Fn(), make: Make) {
    let give_up = |error: notify::Error| {
        let said =
            format!("changes of files are seen twice a second only: the system gives no notice of them ({error})");
        shared.lock().note = Some(said);
        wake();
    };
    let mut folders = make(Arc::clone(shared)).map(Folders::new).map_err(give_up).ok();
    let mut next = None;
    loop {
        let until = if folders.is_some() { next } else { Some(next.unwrap_or_else(|| Instant::now() + LOOK_EVERY)) };
        let Some(signal) = shared.wait(until) else { return };
        if signal.has_moved
            && let Some(watched) = &mut folders
        {
            let files: Vec<_> = shared.lock().files.keys().cloned().collect();
            if let Err(error) = watched.follow(shared, &files, signal.is_lost) {
                folders = None;
                give_up(error);
            }
        }
        thread::sleep(GATHER);
        let (is_new, again) = shared.look();
        next = again;
        if is_new {
            wake();
        }
    }
}

#[cfg(test)]
#[cfg(target_os = "linux")]
mod tests;
