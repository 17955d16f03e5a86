//! File picker of the browser.

use std::cell::RefCell;
use std::ffi::OsString;
use std::io;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use haze_export::file_kind::files_to_open;

use super::page;
pub use crate::platform::dialog_answer::{Answer, Purpose, backdrop_title};

/// File pickers, one at a time.
pub struct Dialogs {
    answer: Rc<RefCell<Option<Answer>>>,
    wake: Rc<dyn Fn()>,
}

impl Dialogs {
    /// `wake` is called when there is an answer.
    ///
    /// # Errors
    /// None; those of a desktop need a thread.
    pub fn new(_: bool, wake: impl Fn() + 'static) -> io::Result<Self> {
        Ok(Self { answer: Rc::default(), wake: Rc::new(wake) })
    }

    /// Returns true: every browser has a file picker.
    pub fn are_likely(_: impl Fn(&str) -> Option<OsString>) -> bool {
        true
    }

    /// Opens a picker that starts with a path. Returns false for a save in a browser without a dialog for it: the user types
    /// a name, and the browser downloads the file.
    pub fn ask(&self, purpose: Purpose, near: &Path) -> bool {
        let answer = Rc::clone(&self.answer);
        let wake = Rc::clone(&self.wake);
        let finish = move |chosen: Option<PathBuf>| {
            *answer.borrow_mut() = Some(chosen.map_or(Answer::Cancelled, Answer::Chosen));
            wake();
        };
        match purpose {
            Purpose::Open | Purpose::Backdrop(_) => {
                page::pick_files(move |files| finish(files_to_open(files).into_iter().next()));
            }
            Purpose::SaveAs if page::has_save_dialog() => {
                let name = near.file_name().unwrap_or_default().to_string_lossy();
                page::pick_save(name.into_owned(), finish);
            }
            Purpose::SaveAs | Purpose::Export => return false,
        }
        true
    }

    /// Returns the answer, once.
    pub fn poll(&mut self) -> Option<Answer> {
        self.answer.borrow_mut().take()
    }
}
