//! The system's dialogs for files, which wait on a thread of their own.

use std::ffi::OsString;
use std::io;
use std::path::{Path, PathBuf};

use super::clock::{Duration, Instant};
use super::worker::Worker;

/// What a file is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    Open,
    SaveAs,
}

/// What came of it.
#[derive(Debug, PartialEq, Eq)]
pub enum Answer {
    Chosen(PathBuf),
    Cancelled,
    /// The system has no dialogs after all.
    NoDialogs,
}

/// Dialogs that ask for a file, one at a time.
pub struct Dialogs {
    worker: Worker<Answer>,
    has_dialogs: bool,
}

/// No one says no as soon.
const TOO_SOON: Duration = Duration::from_millis(300);

impl Dialogs {
    /// `wake` is called from another thread when there is an answer.
    pub fn new(has_dialogs: bool, wake: impl Fn() + Send + 'static) -> io::Result<Self> {
        Ok(Self { worker: Worker::new("haze dialogs", wake)?, has_dialogs })
    }

    /// Whether the system is likely to have dialogs: on Linux a program asks for them over the session's bus, or has zenity show
    /// one. `variable` is [`std::env::var_os`], but for tests.
    pub fn are_likely(variable: impl Fn(&str) -> Option<OsString>) -> bool {
        let is_set = |name| variable(name).is_some_and(|value| !value.is_empty());
        let has_bus = || variable("XDG_RUNTIME_DIR").is_some_and(|folder| Path::new(&folder).join("bus").exists());
        let is_there = |folder: PathBuf| folder.join("zenity").is_file();
        let has_zenity = || variable("PATH").is_some_and(|folders| std::env::split_paths(&folders).any(is_there));
        !cfg!(target_os = "linux") || is_set("DBUS_SESSION_BUS_ADDRESS") || has_bus() || has_zenity()
    }

    /// Asks for a file like this one; false where the system has no dialogs.
    pub fn ask(&self, purpose: Purpose, near: &Path) -> bool {
        if !self.has_dialogs || self.worker.is_busy() {
            return self.has_dialogs;
        }
        let dialog = rfd::AsyncFileDialog::new().add_filter("Presets", &["json"]);
        let folder = std::path::absolute(near).ok().and_then(|path| path.parent().map(Path::to_owned));
        let dialog = folder.into_iter().fold(dialog, rfd::AsyncFileDialog::set_directory);
        let name = near.file_name().unwrap_or_default().to_string_lossy();
        // Some systems want dialogs to be begun by the thread of the window.
        let chosen: std::pin::Pin<Box<dyn Future<Output = _> + Send>> = match purpose {
            Purpose::Open => Box::pin(dialog.pick_file()),
            Purpose::SaveAs => Box::pin(dialog.set_file_name(name).save_file()),
        };
        let begun = Instant::now();
        self.worker.submit(move |_| match pollster::block_on(chosen) {
            Some(file) => Answer::Chosen(file.path().to_owned()),
            None if begun.elapsed() < TOO_SOON => Answer::NoDialogs,
            None => Answer::Cancelled,
        });
        true
    }

    /// The answer, once.
    pub fn poll(&mut self) -> Option<Answer> {
        let answer = self.worker.poll()?.unwrap_or(Answer::NoDialogs);
        self.has_dialogs &= answer != Answer::NoDialogs;
        Some(answer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(target_os = "linux")]
    #[test]
    fn dialogs_come_over_the_bus_or_from_zenity() {
        let folder = tempfile::tempdir().unwrap();
        let likely = |variables: &[(&str, &Path)]| {
            let find = |name: &str| variables.iter().find(|(variable, _)| *variable == name);
            Dialogs::are_likely(|name| find(name).map(|(_, value)| (*value).into()))
        };
        let here = folder.path();
        assert!(!likely(&[]) && !likely(&[("XDG_RUNTIME_DIR", here), ("PATH", here)]));
        assert!(likely(&[("DBUS_SESSION_BUS_ADDRESS", "unix:path=/bus".as_ref())]));
        for (name, variable) in [("bus", "XDG_RUNTIME_DIR"), ("zenity", "PATH")] {
            std::fs::write(here.join(name), "").unwrap();
            assert!(likely(&[(variable, here)]), "{name}");
        }
    }
}
