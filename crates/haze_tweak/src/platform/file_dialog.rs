//! File dialogs of the system, which wait on a thread of their own.

use std::ffi::OsString;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use haze_preset::backdrop_endings;

use super::clock::{Duration, Instant};
pub use super::dialog_answer::{Answer, Purpose, backdrop_title};
use super::worker::Worker;

/// File dialogs, one at a time.
pub struct Dialogs {
    worker: Worker<Answer>,
    has_dialogs: bool,
}

/// A dialog that ends without a choice within this time was not closed by the user, so the system has no dialogs. The
/// time counts from the request, or from the last failure that rfd logged.
const TOO_SOON: Duration = Duration::from_millis(300);

/// Time of the last failure that rfd logged. If one way to open a dialog fails, rfd tries another and reports it to the
/// log only.
static FAILED: Mutex<Option<Instant>> = Mutex::new(None);

/// Records log messages of rfd. Returns true for these; the window reports them itself.
pub fn is_dialog_target(target: &str) -> bool {
    let is_ours = target.starts_with("rfd::");
    if is_ours {
        *FAILED.lock().unwrap_or_else(PoisonError::into_inner) = Some(Instant::now());
    }
    is_ours
}

/// Returns the reason why no file was chosen.
fn without_choice(begun: Instant, failed: Option<Instant>, now: Instant) -> Answer {
    let since = failed.map_or(begun, |failed| failed.max(begun));
    if now.saturating_duration_since(since) < TOO_SOON { Answer::NoDialogs } else { Answer::Cancelled }
}

impl Dialogs {
    /// `wake` is called from another thread when there is an answer.
    pub fn new(has_dialogs: bool, wake: impl Fn() + Send + 'static) -> io::Result<Self> {
        Ok(Self { worker: Worker::new("haze dialogs", wake)?, has_dialogs })
    }

    /// Returns true if the system probably has dialogs. On Linux a program requests them over the session bus, or runs
    /// zenity. `variable` is [`std::env::var_os`], except in tests.
    pub fn are_likely(variable: impl Fn(&str) -> Option<OsString>) -> bool {
        let is_set = |name| variable(name).is_some_and(|value| !value.is_empty());
        let has_bus = || variable("XDG_RUNTIME_DIR").is_some_and(|folder| Path::new(&folder).join("bus").exists());
        let is_there = |folder: PathBuf| folder.join("zenity").is_file();
        let has_zenity = || variable("PATH").is_some_and(|folders| std::env::split_paths(&folders).any(is_there));
        !cfg!(target_os = "linux") || is_set("DBUS_SESSION_BUS_ADDRESS") || has_bus() || has_zenity()
    }

    /// Opens a dialog that starts at a path. Returns false if the system has no dialogs.
    pub fn ask(&self, purpose: Purpose, near: &Path) -> bool {
        if !self.has_dialogs || self.worker.is_busy() {
            return self.has_dialogs;
        }
        let (kind, endings) = match (purpose, near.extension().and_then(std::ffi::OsStr::to_str)) {
            (Purpose::Open | Purpose::SaveAs, _) => ("Presets", vec!["json"]),
            (Purpose::Export, ending) => ("Images", ending.into_iter().collect()),
            (Purpose::Backdrop(kind), _) => (backdrop_title(kind), backdrop_endings(kind).to_vec()),
        };
        let mut dialog = rfd::AsyncFileDialog::new();
        if !endings.is_empty() {
            dialog = dialog.add_filter(kind, &endings);
        }
        let folder = std::path::absolute(near).ok().and_then(|path| path.parent().map(Path::to_owned));
        let dialog = folder.into_iter().fold(dialog, rfd::AsyncFileDialog::set_directory);
        let name = near.file_name().unwrap_or_default().to_string_lossy();
        // Some systems require that the window's thread creates the dialog.
        let chosen: std::pin::Pin<Box<dyn Future<Output = _> + Send>> = match purpose {
            Purpose::Open | Purpose::Backdrop(_) => Box::pin(dialog.pick_file()),
            Purpose::SaveAs | Purpose::Export => Box::pin(dialog.set_file_name(name).save_file()),
        };
        let begun = Instant::now();
        self.worker.submit(move |_| match pollster::block_on(chosen) {
            Some(file) => Answer::Chosen(file.path().to_owned()),
            None => without_choice(begun, *FAILED.lock().unwrap_or_else(PoisonError::into_inner), Instant::now()),
        });
        true
    }

    /// Returns the answer, once.
    pub fn poll(&mut self) -> Option<Answer> {
        let answer = self.worker.poll()?.unwrap_or(Answer::NoDialogs);
        self.has_dialogs &= answer != Answer::NoDialogs;
        Some(answer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_late_failure_to_open_a_dialog_does_not_count_as_cancelled() {
        let begun = Instant::now();
        let after = |seconds: f32| begun + Duration::from_secs_f32(seconds);
        for (failed, now, expected) in [
            (None, 0.1, Answer::NoDialogs),
            (None, 5.0, Answer::Cancelled),
            // The bus refused late, and there is no zenity.
            (Some(25.0), 25.01, Answer::NoDialogs),
            // There is zenity, and the user closed the dialog.
            (Some(25.0), 31.0, Answer::Cancelled),
        ] {
            assert_eq!(without_choice(begun, failed.map(after), after(now)), expected, "{failed:?} {now}");
        }
        // A failure of an earlier dialog.
        assert_eq!(without_choice(after(30.0), Some(after(25.0)), after(40.0)), Answer::Cancelled);
        assert!(is_dialog_target("rfd::backend::xdg_desktop_portal::portal") && !is_dialog_target("wgpu_core"));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn dialogs_are_likely_with_a_session_bus_or_zenity() {
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
