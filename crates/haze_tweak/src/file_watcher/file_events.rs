//! File-system events in folders, from the `notify` crate.

use std::collections::{BTreeSet, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use notify::event::{EventKind, ModifyKind};
use notify::{ErrorKind, Event, RecommendedWatcher, RecursiveMode, Watcher as _};

use super::resolve::locations;
use super::state::Shared;

/// Creates a notifier. Tests pass one that fails.
pub type MakeNotifier = fn(Arc<Shared>) -> notify::Result<RecommendedWatcher>;

/// Creates the system's notifier.
pub fn system_notifier(shared: Arc<Shared>) -> notify::Result<RecommendedWatcher> {
    notify::recommended_watcher(move |event| handle_event(&shared, event))
}

/// Handles an event in one of the folders. Runs on notify's thread and must not block.
fn handle_event(shared: &Shared, event: notify::Result<Event>) {
    let Ok(event) = event else { return shared.signal(true) };
    if event.kind.is_access() {
        return;
    }
    if event.need_rescan() || event.paths.is_empty() {
        return shared.signal(true);
    }
    let writes = matches!(event.kind, EventKind::Modify(ModifyKind::Data(_)));
    shared.signal_at(&event.paths, !writes);
}

/// The watched folders. The files themselves are not watched: an editor that renames would move the watch away with the
/// old file.
pub struct WatchedFolders {
    notifier: RecommendedWatcher,
    watched: BTreeSet<PathBuf>,
}

impl WatchedFolders {
    pub fn new(notifier: RecommendedWatcher) -> Self {
        Self { notifier, watched: BTreeSet::new() }
    }

    /// Watches every folder on the way to these files. If `rewatch_all`, creates all watches anew, because a folder may
    /// have been replaced by another of the same name.
    ///
    /// # Errors
    /// The error of a folder that contains a file and cannot be watched.
    pub fn follow(&mut self, shared: &Shared, files: &[PathBuf], rewatch_all: bool) -> Result<(), notify::Error> {
        if rewatch_all {
            std::mem::take(&mut self.watched).into_iter().for_each(|folder| drop(self.notifier.unwatch(&folder)));
        }
        /// Most passes over the paths. What moves during a pass sends an event itself, once its folder is watched.
        const MAX_PASSES: u32 = 3;
        for _ in 0..MAX_PASSES {
            let routes: Vec<_> = files.iter().map(|file| locations(file)).collect();
            let all: HashSet<_> = routes.iter().flatten().cloned().collect();
            let ends: HashSet<_> = routes.iter().filter_map(|route| route.last()?.parent()).collect();
            let folders: HashSet<_> = all.iter().filter_map(|path| path.parent()).collect();
            shared.lock().locations.clone_from(&all);
            let is_unused = |folder: &Path| !folders.contains(folder);
            let unused: Vec<_> = self.watched.iter().filter(|folder| is_unused(folder)).cloned().collect();
            for folder in unused {
                self.watched.remove(&folder);
                let _ = self.notifier.unwatch(&folder);
            }
            // Outer folders first, so that they report when an inner one moves.
            let mut new: Vec<_> = folders.into_iter().filter(|folder| !self.watched.contains(*folder)).collect();
            if new.is_empty() {
                break;
            }
            new.sort();
            for folder in new {
                match self.notifier.watch(folder, RecursiveMode::NonRecursive) {
                    Ok(()) => drop(self.watched.insert(folder.into())),
                    Err(error) if is_limit_reached(&error) || ends.contains(folder) && folder.is_dir() => {
                        return Err(error);
                    }
                    // The folder is gone again, or it may be traversed but not listed.
                    Err(_) => {}
                }
            }
        }
        Ok(())
    }
}

fn is_limit_reached(error: &notify::Error) -> bool {
    matches!(error.kind, ErrorKind::MaxFilesWatch)
}
