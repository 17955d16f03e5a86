//! Decides that a file is complete: it has not changed for a while.

use std::time::{Duration, Instant};

use super::stamp::Stamp;

/// Time without a change after which a file is complete. Programs that write a file in parts pause for less.
pub const SETTLE_TIME: Duration = Duration::from_millis(50);

/// The same for a file that is empty or gone, which a program may be about to write anew.
pub const SETTLE_TIME_IF_EMPTY: Duration = Duration::from_millis(200);

/// A file as it was last reported, and as it was last seen.
pub struct FileState {
    reported: Option<Stamp>,
    now: Option<Stamp>,
    since: Instant,
}

/// Action to take for a file.
#[derive(Debug, PartialEq, Eq)]
pub enum FileAction {
    /// It is as it was reported.
    Nothing,
    /// It has changed and is complete.
    Report,
    /// It has changed; check it again at this time.
    CheckAgain(Instant),
}

impl FileState {
    /// `is_reported`: the caller knows the current state of the file.
    pub fn new(stamp: Option<Stamp>, is_reported: bool, at: Instant) -> Self {
        Self { reported: stamp.filter(|_| is_reported), now: stamp, since: at }
    }

    pub fn update(&mut self, stamp: Option<Stamp>, at: Instant) -> FileAction {
        if stamp != self.now {
            self.now = stamp;
            self.since = at;
        }
        if self.now == self.reported {
            return FileAction::Nothing;
        }
        let is_empty = stamp.is_none_or(|stamp| stamp.length == 0);
        let complete_at = self.since + if is_empty { SETTLE_TIME_IF_EMPTY } else { SETTLE_TIME };
        if at < complete_at {
            return FileAction::CheckAgain(complete_at);
        }
        self.reported = self.now;
        FileAction::Report
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_reported_once_when_the_file_is_complete() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        let stamp = |text: &str| {
            std::fs::write(&path, text).unwrap();
            Stamp::of(&path)
        };
        let start = Instant::now();
        let at = |milliseconds| start + Duration::from_millis(milliseconds);
        let mut file = FileState::new(None, true, start);
        assert_eq!(file.update(None, at(1000)), FileAction::Nothing);
        // Created, then written in two parts with 30 ms between them.
        assert_eq!(file.update(stamp(""), at(1000)), FileAction::CheckAgain(at(1200)));
        assert_eq!(file.update(stamp("1"), at(1010)), FileAction::CheckAgain(at(1060)));
        let complete = stamp("12");
        assert_eq!(file.update(complete, at(1040)), FileAction::CheckAgain(at(1090)));
        assert_eq!(file.update(complete, at(1060)), FileAction::CheckAgain(at(1090)));
        assert_eq!(file.update(complete, at(1090)), FileAction::Report);
        assert_eq!(file.update(complete, at(1200)), FileAction::Nothing);
        // Deleted and restored unchanged: no report. Deleted for good: reported.
        assert_eq!(file.update(None, at(1300)), FileAction::CheckAgain(at(1500)));
        assert_eq!(file.update(complete, at(1310)), FileAction::Nothing);
        assert_eq!(file.update(None, at(1400)), FileAction::CheckAgain(at(1600)));
        assert_eq!(file.update(None, at(1600)), FileAction::Report);
        // An unread file is reported as it is.
        let mut file = FileState::new(complete, false, start);
        assert_eq!(file.update(complete, at(0)), FileAction::CheckAgain(at(50)));
        assert_eq!(file.update(complete, at(50)), FileAction::Report);
    }
}
