//! Files in memory, as a disk. The user gives files to the page and gets them from it.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

use eframe::egui;
use haze_core::assets::memory_files;
use haze_core::error::Error;
use haze_export::file_kind::files_to_open;
use wasm_bindgen_futures::spawn_local;

use super::page;

/// Changes with each write of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stamp(u64);

impl Stamp {
    /// Returns the stamp of the current file; `None` if there is none.
    pub fn of(path: &Path) -> Option<Self> {
        memory_files::stamp(path).map(Self)
    }
}

/// A set of files, which only the page itself changes.
pub struct Watcher(RefCell<BTreeMap<PathBuf, Option<Stamp>>>);

impl Watcher {
    /// # Errors
    /// None; a watcher of the system has some.
    pub fn new(_: impl Fn() + 'static) -> std::io::Result<Self> {
        Ok(Self(RefCell::default()))
    }

    /// Watches these files, and no others; they need not exist yet.
    pub fn set(&self, files: impl IntoIterator<Item = PathBuf>) {
        let mut watched = self.0.borrow_mut();
        let known = std::mem::take(&mut *watched);
        watched.extend(files.into_iter().map(|file| {
            let stamp = known.get(&file).copied().unwrap_or_else(|| Stamp::of(&file));
            (file, stamp)
        }));
    }

    /// Returns the files that were changed or removed since the last call.
    pub fn poll(&self) -> Vec<PathBuf> {
        let mut changed = Vec::new();
        for (file, stamp) in self.0.borrow_mut().iter_mut() {
            let now = Stamp::of(file);
            if now != std::mem::replace(stamp, now) {
                changed.push(file.clone());
            }
        }
        changed
    }

    /// Returns a message about the watcher itself: none.
    pub fn take_message(&self) -> Option<String> {
        None
    }
}

/// Folders need not be created.
///
/// # Errors
/// None; a disk has some.
pub fn make_folder(_: &Path) -> Result<(), Error> {
    Ok(())
}

/// Removes a file.
pub fn remove(path: &Path) {
    memory_files::remove(path);
}

/// Returns the files of a folder, sorted by path.
pub fn list(folder: &Path) -> Vec<PathBuf> {
    memory_files::names(folder).into_iter().flatten().map(|name| folder.join(name)).collect()
}

/// Returns true if a file exists.
pub fn exists(path: &Path) -> bool {
    memory_files::is_taken(path)
}

/// As [`exists`].
pub fn is_taken(path: &Path) -> bool {
    exists(path)
}

/// Returns the path from the only root, without `.`.
pub fn absolute(path: &Path) -> PathBuf {
    path.components().filter(|part| matches!(part, Component::Normal(_))).collect()
}

/// Returns true if two paths lead to the same file.
pub fn is_same(one: &Path, other: &Path) -> bool {
    absolute(one) == absolute(other)
}

thread_local! {
    /// Files that were dropped on the page and read since.
    static DROPPED: RefCell<Vec<PathBuf>> = const { RefCell::new(Vec::new()) };
}

/// Returns a file that was dropped on the page, once it is read.
pub fn dropped_file(context: &egui::Context) -> Option<PathBuf> {
    let files = context.input(|input| input.raw.dropped_files.clone());
    if !files.is_empty() {
        let context = context.clone();
        spawn_local(async move {
            let mut read = Vec::new();
            for file in files {
                if let Ok(bytes) = file.bytes_async().await
                    && memory_files::write_file(file.path(), &bytes).is_ok()
                {
                    read.push(file.path().to_owned());
                }
            }
            DROPPED.with_borrow_mut(|dropped| dropped.extend(files_to_open(read)));
            context.request_repaint();
        });
    }
    let next = DROPPED.with_borrow_mut(|dropped| if dropped.is_empty() { None } else { Some(dropped.remove(0)) });
    if next.is_some() {
        context.request_repaint();
    }
    next
}

/// Writes a file to where the user has saved it, or offers it as a download; of a folder, each file.
pub fn offer_download(path: &Path) {
    let files = if exists(path) { vec![path.to_owned()] } else { list(path) };
    for file in files {
        page::offer(&file);
    }
}

/// Returns the link, which also becomes the address of the page.
pub fn link_address(fragment: &str) -> String {
    page::set_fragment(fragment)
}
