//! File picker of the browser.

use std::cell::RefCell;
use std::ffi::OsString;
use std::io;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use super::page;
use crate::file_kind::files_to_open;
pub use crate::tweak::platform::dialog_answer::{Answer, Purpose};

/// File pickers, one at a time.
pub struct Dialogs {
    chosen: Rc<RefCell<Option<PathBuf>>>,
    wake: Rc<dyn Fn()>,
}

impl Dialogs {
    /// `wake` is called when there is an answer.
    ///
    /// # Errors
    /// None; those of a desktop need a thread.
    pub fn new(_: bool, wake: impl Fn() + 'static) -> io::Result<Self> {
        Ok(Self { chosen: Rc::default(), wake: Rc::new(wake) })
    }

    /// Returns true: every browser has a file picker.
    pub fn are_likely(_: impl Fn(&str) -> Option<OsString>) -> bool {
        true
    }

    /// Opens the picker. Returns false for a save: the user types a name, and the browser downloads the file.
    pub fn ask(&self, purpose: Purpose, _: &Path) -> bool {
        if purpose == Purpose::SaveAs {
            return false;
        }
        let (chosen, wake) = (Rc::clone(&self.chosen), Rc::clone(&self.wake));
        page::pick_files(move |files| {
            *chosen.borrow_mut() = files_to_open(files).into_iter().next();
            wake();
        });
        true
    }

    /// Returns the answer, once.
    pub fn poll(&mut self) -> Option<Answer> {
        self.chosen.borrow_mut().take().map(Answer::Chosen)
    }
}
