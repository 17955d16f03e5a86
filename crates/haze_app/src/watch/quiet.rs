//! Decides that a file is complete: it has not changed for a while.

use std::time::{Duration, Instant};

use super::stamp::Stamp;

/// Time without a change after which a file is complete. Programs that write a file in parts pause for less.
pub const QUIET: Duration = Duration::from_millis(50);

/// The same for a file that is empty or gone, which a program may be about to write anew.
pub const SETTLE_TIME_IF_EMPTY: Duration = Duration::from_millis(200);

/// A file as it was last reported, and as it was last seen.
pub struct Seen {
    told: Option<Stamp>,
    now: Option<Stamp>,
    since: Instant,
}

/// Action to take for a file.
#[derive(Debug, PartialEq, Eq)]
pub enum Todo {
    /// It is as it was reported.
    Nothing,
    /// It has changed and is complete.
    Tell,
    /// It has changed; check it again at this time.
    LookAgain(Instant),
}

impl Seen {
    /// `is_told`: the caller knows the current state of the file.
    pub fn new(stamp: Option<Stamp>, is_told: bool, at: Instant) -> Self {
        Self { told: stamp.filter(|_| is_told), now: stamp, since: at }
    }

    pub fn look(&mut self, stamp: Option<Stamp>, at: Instant) -> Todo {
        if stamp != self.now {
            (self.now, self.since) = (stamp, at);
        }
        if self.now == self.told {
            return Todo::Nothing;
        }
        let is_hollow = stamp.is_none_or(|stamp| stamp.length == 0);
        let whole = self.since + if is_hollow { SETTLE_TIME_IF_EMPTY } else { QUIET };
        if at < whole {
            return Todo::LookAgain(whole);
        }
        self.told = self.now;
        Todo::Tell
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
        let mut seen = Seen::new(None, true, start);
        assert_eq!(seen.look(None, at(1000)), Todo::Nothing);
        // Created, then written in two parts with 30 ms between them.
        assert_eq!(seen.look(stamp(""), at(1000)), Todo::LookAgain(at(1200)));
        assert_eq!(seen.look(stamp("1"), at(1010)), Todo::LookAgain(at(1060)));
        let whole = stamp("12");
        assert_eq!(seen.look(whole, at(1040)), Todo::LookAgain(at(1090)));
        assert_eq!(seen.look(whole, at(1060)), Todo::LookAgain(at(1090)));
        assert_eq!(seen.look(whole, at(1090)), Todo::Tell);
        assert_eq!(seen.look(whole, at(1200)), Todo::Nothing);
        // Deleted and restored unchanged: no report. Deleted for good: reported.
        assert_eq!(seen.look(None, at(1300)), Todo::LookAgain(at(1500)));
        assert_eq!(seen.look(whole, at(1310)), Todo::Nothing);
        assert_eq!(seen.look(None, at(1400)), Todo::LookAgain(at(1600)));
        assert_eq!(seen.look(None, at(1600)), Todo::Tell);
        // An unread file is reported as it is.
        let mut seen = Seen::new(whole, false, start);
        assert_eq!(seen.look(whole, at(0)), Todo::LookAgain(at(50)));
        assert_eq!(seen.look(whole, at(50)), Todo::Tell);
    }
}
