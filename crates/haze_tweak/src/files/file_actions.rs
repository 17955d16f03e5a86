//! Actions of the File menu, and the question that is asked before unsaved work is lost.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use eframe::egui;
use haze_core::error::{AssetError, Error};
use haze_preset::{AssetFolders, backdrop_kind};

use super::dropped_backdrop::DroppedBackdrop;
use super::dropped_image::DroppedImage;
use crate::document::{Document, OnDisk, Saving};
use crate::platform::asset_loading::{self, LoadedAssets};
use crate::platform::clock::{self, Duration};
use crate::platform::file_dialog::{Answer, Dialogs, Purpose};
use crate::platform::worker::Worker;
use crate::platform::{IS_PAGE, file_io};
use crate::session::Session;
use crate::session::messages::truncate_middle;

/// State of the File menu's actions.
pub struct FileActions {
    worker: Worker<FileResult>,
    dialogs: Dialogs,
    /// Purpose of the open dialog, if one is open.
    purpose: Option<(Purpose, PathBuf)>,
    /// Action that waits for the user's decision about unsaved work.
    pub waiting: Option<AfterUnsaved>,
    /// Action that follows a successful save.
    then: Option<AfterUnsaved>,
    /// Path that the user types, on systems without file dialogs.
    pub typed: Option<TypedPath>,
    /// Path that the user has chosen for an export; the outer `Some` ends the question.
    exported: Option<Option<PathBuf>>,
    /// The window may close without a question about unsaved work.
    may_close: bool,
    /// The window closes as soon as the sprite that is being baked is written.
    closes_after_baking: bool,
    title: String,
}

/// Longest wait for the file thread at exit.
const MAX_EXIT_WAIT: Duration = Duration::from_millis(500);

/// Action that ends the work on the document.
pub enum AfterUnsaved {
    /// Shows another document.
    Show(Box<Document>, LoadedAssets),
    Close,
}

/// Path that is being typed.
pub struct TypedPath {
    pub purpose: Purpose,
    pub text: String,
}

/// Result from the file thread.
enum FileResult {
    Opened(Box<Document>, LoadedAssets),
    /// Image for the system of this index.
    Dropped(usize, DroppedImage),
    Backdrop(Box<DroppedBackdrop>),
    Saved(Box<Saving>, Result<(), Error>),
    /// The window layout was written.
    LayoutWritten(Result<(), Error>),
    Failed(Error),
}

impl FileActions {
    /// `wake` is called from other threads when a result is ready.
    ///
    /// # Errors
    /// [`AssetError::Io`] if the system cannot start another thread.
    pub fn new(has_dialogs: bool, wake: impl Fn() + Send + Sync + 'static) -> Result<Self, Error> {
        let thread = |error| Error::from(AssetError::Io { path: "a thread for files".into(), error });
        let wake = Arc::new(wake);
        let its = Arc::clone(&wake);
        Ok(Self {
            worker: Worker::new("haze files", move || its()).map_err(thread)?,
            dialogs: Dialogs::new(has_dialogs, move || wake()).map_err(thread)?,
            purpose: None,
            exported: None,
            waiting: None,
            then: None,
            typed: None,
            may_close: false,
            closes_after_baking: false,
            title: String::new(),
        })
    }

    /// Handles answers of dialogs, results of the file thread, dropped files and requests to close. Call once a frame.
    pub fn advance(&mut self, session: &mut Session, context: &egui::Context) {
        if let Some(answer) = self.dialogs.poll() {
            let (purpose, near) = self.purpose.take().map_or((Purpose::Open, PathBuf::new()), |asked| asked);
            match answer {
                Answer::Chosen(path) => self.chosen(purpose, &path, session),
                Answer::NoDialogs => self.type_path(purpose, &near),
                Answer::Cancelled => self.cancelled(purpose, session),
            }
        }
        while let Some(done) = self.worker.poll() {
            match done {
                Some(FileResult::Opened(document, loaded)) => {
                    self.begin_or_ask(AfterUnsaved::Show(document, loaded), session);
                }
                Some(FileResult::Saved(saving, done)) => self.saved(*saving, done, session),
                Some(FileResult::Dropped(system, dropped)) => {
                    match dropped.apply(&mut session.document.preset, system, session.view.size) {
                        Ok(said) => session.messages.info("file", said),
                        Err(error) => session.messages.error("file", error),
                    }
                }
                Some(FileResult::Backdrop(dropped)) => dropped.apply(session),
                Some(FileResult::LayoutWritten(Ok(()))) => session.messages.clear("remembered"),
                Some(FileResult::LayoutWritten(Err(error))) => session.messages.error("remembered", error),
                Some(FileResult::Failed(error)) => session.messages.error("file", error),
                None => {
                    session.messages.error("file", "The file was not read or written: internal error");
                }
            }
        }
        if let Some(path) = file_io::dropped_file(context) {
            self.take(path, session);
        }
        if let Some(kind) = session.backdrop_request.take() {
            self.ask(Purpose::Backdrop(kind), suggested(session));
        }
        let is_baking = session.sprites.is_baking() || session.simulation.is_baking();
        let is_asked_to_close = context.input(|input| input.viewport().close_requested());
        if self.may_close || self.closes_after_baking && !is_baking {
            self.closes_after_baking = false;
            context.send_viewport_cmd(egui::ViewportCommand::Close);
        } else if is_asked_to_close && is_baking && !self.closes_after_baking {
            // A second request closes without waiting; the sprite file then stays as it was.
            context.send_viewport_cmd(egui::ViewportCommand::CancelClose);
            self.closes_after_baking = true;
            session.messages.info("file", "A sprite is being baked. The window closes when it is written.");
        } else if is_asked_to_close
            && (session.document.is_dirty() || session.document.is_being_saved())
            && session.screenshot.is_none()
        {
            context.send_viewport_cmd(egui::ViewportCommand::CancelClose);
            let when = if session.document.is_being_saved() { &mut self.then } else { &mut self.waiting };
            *when = Some(AfterUnsaved::Close);
        }
        let mark = if session.document.is_dirty() { "* " } else { "" };
        let title = format!("{mark}{} - haze", truncate_middle(&session.document.title(), 80));
        if title != self.title {
            context.send_viewport_cmd(egui::ViewportCommand::Title(title.clone()));
            self.title = title;
        }
    }

    /// Handles a file that was dropped or chosen: a preset to open, an image for the shown system, a scene or a sky.
    fn take(&self, path: PathBuf, session: &Session) {
        if let Some(kind) = backdrop_kind(&path) {
            let folders = session.folders();
            self.worker.submit(move |_| match DroppedBackdrop::read(kind, &path, &folders) {
                Ok(dropped) => FileResult::Backdrop(Box::new(dropped)),
                Err(error) => FileResult::Failed(error),
            });
        } else if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
            let folders = session.folders();
            let index = session.view.system;
            let system = session.document.preset.systems.get(index);
            let material = system.map(|system| system.material.clone()).unwrap_or_default();
            self.worker.submit(move |_| match DroppedImage::read(&path, &folders, &material) {
                Ok(dropped) => FileResult::Dropped(index, dropped),
                Err(error) => FileResult::Failed(error),
            });
        } else {
            self.open(path, session);
        }
    }

    /// Runs a write that does not concern the preset on the file thread.
    pub fn write_in_background(&self, write: impl FnOnce() -> Result<(), Error> + Send + 'static) {
        self.worker.submit(move |_| FileResult::LayoutWritten(write()));
    }

    /// Waits at exit for pending writes, but no longer than [`MAX_EXIT_WAIT`].
    pub fn finish(&self) {
        let begun = clock::now();
        while self.worker.is_busy() && begun.elapsed() < MAX_EXIT_WAIT {
            clock::sleep(Duration::from_millis(5));
        }
    }

    /// Opens a file, or a built-in preset by name. Nothing changes if it cannot be opened.
    pub fn open(&self, path: PathBuf, session: &Session) {
        let assets = session.assets.clone();
        self.worker.submit(move |_| match load(&path, assets) {
            Ok((document, loaded)) => FileResult::Opened(Box::new(document), loaded),
            Err(error) => FileResult::Failed(error),
        });
    }

    fn begin_or_ask(&mut self, next: AfterUnsaved, session: &mut Session) {
        if session.document.is_dirty() { self.waiting = Some(next) } else { self.begin(next, session) }
    }

    fn begin(&mut self, next: AfterUnsaved, session: &mut Session) {
        match next {
            AfterUnsaved::Show(document, loaded) => session.replace_document(*document, loaded),
            AfterUnsaved::Close => self.may_close = true,
        }
    }

    /// Handles the answer about unsaved work: `Some(true)` saves it first, `Some(false)` discards it, `None` cancels
    /// the action.
    pub fn answer(&mut self, is_saved: Option<bool>, session: &mut Session) {
        let next = self.waiting.take();
        match (is_saved, next) {
            (Some(true), Some(next)) => {
                self.then = Some(next);
                self.save(session);
            }
            (Some(false), Some(next)) => self.begin(next, session),
            _ => {}
        }
    }

    /// Asks for a preset to open.
    pub fn ask_open(&mut self, session: &Session) {
        self.ask(Purpose::Open, suggested(session));
    }

    /// Saves the document, or asks for a path if it is a built-in preset.
    pub fn save(&mut self, session: &mut Session) {
        if session.document.is_being_saved() {
            return session.messages.info("file", "Saving already");
        }
        if session.document.is_built_in() {
            return self.save_as(session);
        }
        if session.document.on_disk() == OnDisk::Changed {
            session.is_changed_on_disk = true;
            self.then = None;
            return session
                .messages
                .error("file", "Not saved: another program changed the file. Choose a version above.");
        }
        let folders = session.backdrop_folders.clone();
        let begun = session.document.begin_saving().map(|saving| saving.with_backdrop_folders(folders));
        self.write(begun, session);
    }

    /// Writes on the file thread, because images may be large and disks slow.
    fn write(&mut self, begun: Result<Saving, Error>, session: &mut Session) {
        match begun {
            Ok(saving) => {
                self.worker.submit(move |_| {
                    let done = saving.write();
                    FileResult::Saved(Box::new(saving), done)
                });
            }
            Err(error) => {
                self.then = None;
                session.cancel_copies();
                session.messages.error("file", error);
            }
        }
    }

    /// Asks for a path to save under.
    pub fn save_as(&mut self, session: &Session) {
        self.ask(Purpose::SaveAs, suggested(session));
    }

    fn saved(&mut self, saving: Saving, done: Result<(), Error>, session: &mut Session) {
        let then = self.then.take();
        let path = saving.path().to_owned();
        session.document.finish_saving(saving, done.is_ok());
        match done {
            Ok(()) => {
                session.is_changed_on_disk = false;
                session.messages.clear("preset");
                session.messages.info("file", format!("Saved {}", path.display()));
                file_io::offer_download(&path);
                // The document may have been changed during the save.
                if let Some(next) = then {
                    self.begin_or_ask(next, session);
                }
            }
            Err(error) => {
                session.cancel_copies();
                session.messages.error("file", error);
            }
        }
    }

    /// Asks where to export to, and suggests a path.
    pub fn ask_export(&mut self, suggested: PathBuf) {
        self.ask(Purpose::Export, suggested);
    }

    /// Returns the answer to [`Self::ask_export`], once; the inner `None` means that the user has cancelled.
    pub fn take_exported(&mut self) -> Option<Option<PathBuf>> {
        self.exported.take()
    }

    fn ask(&mut self, purpose: Purpose, near: PathBuf) {
        // The answer belongs to the dialog that is open. A browser does not tell when its picker is closed.
        if self.purpose.is_some() && !IS_PAGE {
            return;
        }
        if self.dialogs.ask(purpose, &near) {
            self.purpose = Some((purpose, near));
        } else {
            self.type_path(purpose, &near);
        }
    }

    fn type_path(&mut self, purpose: Purpose, near: &Path) {
        let text = match purpose {
            Purpose::Open | Purpose::Backdrop(_) => String::new(),
            Purpose::SaveAs | Purpose::Export => near.display().to_string(),
        };
        self.typed = Some(TypedPath { purpose, text });
    }

    /// Forgets what would have followed an answer.
    fn cancelled(&mut self, purpose: Purpose, session: &mut Session) {
        match purpose {
            Purpose::Export => self.exported = Some(None),
            Purpose::Backdrop(_) => {}
            Purpose::Open | Purpose::SaveAs => {
                self.then = None;
                session.cancel_copies();
            }
        }
    }

    /// Handles the typed path; `None` cancels.
    pub fn finish_typing(&mut self, path: Option<&Path>, session: &mut Session) {
        match (self.typed.take(), path) {
            (Some(typed), Some(path)) => self.chosen(typed.purpose, path, session),
            (Some(typed), None) => self.cancelled(typed.purpose, session),
            (None, _) => {}
        }
    }

    fn chosen(&mut self, purpose: Purpose, path: &Path, session: &mut Session) {
        match purpose {
            Purpose::Open | Purpose::Backdrop(_) => self.take(path.into(), session),
            Purpose::SaveAs => {
                let path = if path.extension().is_none() { path.with_extension("json") } else { path.into() };
                let folders = session.backdrop_folders.clone();
                let begun = session.document.begin_saving_as(&path).map(|saving| saving.with_backdrop_folders(folders));
                self.write(begun, session);
            }
            Purpose::Export => self.exported = Some(Some(path.into())),
        }
    }
}

/// Returns the path to suggest for a save: the document's file, or a file of the built-in preset's name in the working
/// directory.
fn suggested(session: &Session) -> PathBuf {
    let document = &session.document;
    if document.is_built_in() { document.path().with_extension("json") } else { document.path().into() }
}

fn load(path: &Path, assets: Option<PathBuf>) -> Result<(Document, LoadedAssets), Error> {
    let document = Document::open(path)?;
    let folders = AssetFolders::for_preset_file(path).with_shared(assets);
    let loaded = asset_loading::all(&document.preset, path, &folders)?;
    Ok((document, loaded))
}

#[cfg(test)]
mod tests;
