//! Detects changed files, however they are written.
//!
//! File-system events in the folders on the way to a file only trigger a re-check. A file counts as changed when its
//! size, modification time or inode differs and then stays the same for a moment, so in-place writes, atomic renames,
//! deletion and re-creation, and swapped links are handled alike. Without file-system events, the files are checked
//! twice a second.
//!
//! The crate notify-debouncer-full is not used: its thread wakes on a timer even when nothing happens, and it would
//! replace only `settle`: links, folders that appear later and the comparison of stamps would stay here.

mod file_events;
mod resolve;
mod settle;
mod stamp;
mod state;

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};
use std::{io, thread};

pub use stamp::Stamp;

use file_events::{MakeNotifier, WatchedFolders};
use settle::FileState;
use state::Shared;

/// Interval of the checks without file-system events.
const POLL_INTERVAL: Duration = Duration::from_millis(500);

/// Delay that gathers events of one moment into one check.
const DEBOUNCE: Duration = Duration::from_millis(5);

/// A set of files, and a thread that sleeps until a file may have changed.
pub struct Watcher {
    shared: Arc<Shared>,
}

impl Watcher {
    /// Creates a watcher of no files. `wake` is called from another thread when [`Watcher::poll`] has new changes.
    pub fn new(wake: impl Fn() + Send + 'static) -> io::Result<Self> {
        Self::start(wake, file_events::system_notifier)
    }

    fn start(wake: impl Fn() + Send + 'static, make: MakeNotifier) -> io::Result<Self> {
        let shared = Arc::new(Shared::default());
        let thread_shared = Arc::clone(&shared);
        thread::Builder::new().name("haze watch".into()).spawn(move || run(&thread_shared, wake, make))?;
        Ok(Self { shared })
    }

    /// Watches these files, and no others; they need not exist yet. Call this before reading them: every change from
    /// now on is reported.
    pub fn set(&self, files: impl IntoIterator<Item = PathBuf>) {
        self.watch(files, true);
    }

    /// The same for files that have not been read yet: files that are new to the watcher are reported once as they are.
    pub fn watch_unread(&self, files: impl IntoIterator<Item = PathBuf>) {
        self.watch(files, false);
    }

    fn watch(&self, files: impl IntoIterator<Item = PathBuf>, is_reported: bool) {
        let files: BTreeSet<_> = files.into_iter().collect();
        let known: BTreeSet<_> = self.shared.lock().files.keys().cloned().collect();
        if files == known {
            return;
        }
        let new: Vec<_> = files.difference(&known).map(|file| (file.clone(), Stamp::of(file))).collect();
        let mut state = self.shared.lock();
        state.files.retain(|file, _| files.contains(file));
        state.changed.retain(|file| files.contains(file));
        state
            .files
            .extend(new.into_iter().map(|(file, stamp)| (file, FileState::new(stamp, is_reported, Instant::now()))));
        drop(state);
        self.shared.signal(false);
    }

    /// Returns the files that were changed or deleted since the last call, each once and only when it is complete.
    pub fn poll(&self) -> Vec<PathBuf> {
        std::mem::take(&mut self.shared.lock().changed).into_iter().collect()
    }

    /// Returns a message about the watcher itself, once.
    pub fn take_message(&self) -> Option<String> {
        self.shared.lock().message.take()
    }
}

impl Drop for Watcher {
    fn drop(&mut self) {
        self.shared.end();
    }
}

fn run(shared: &Arc<Shared>, wake: impl Fn(), make: MakeNotifier) {
    let fall_back_to_polling = |error: notify::Error| {
        let message =
            format!("files are checked for changes only twice a second: the system reports no file events ({error})");
        shared.lock().message = Some(message);
        wake();
    };
    let mut folders = make(Arc::clone(shared)).map(WatchedFolders::new).map_err(fall_back_to_polling).ok();
    let mut next = None;
    loop {
        let until = if folders.is_some() { next } else { Some(next.unwrap_or_else(|| Instant::now() + POLL_INTERVAL)) };
        let Some(signal) = shared.wait(until) else { return };
        if signal.paths_changed
            && let Some(watched) = &mut folders
        {
            let files: Vec<_> = shared.lock().files.keys().cloned().collect();
            if let Err(error) = watched.follow(shared, &files, signal.rewatch_all) {
                folders = None;
                fall_back_to_polling(error);
            }
        }
        thread::sleep(DEBOUNCE);
        let (is_new, again) = shared.check_files();
        next = again;
        if is_new {
            wake();
        }
    }
}

#[cfg(test)]
#[cfg(target_os = "linux")]
mod tests;
