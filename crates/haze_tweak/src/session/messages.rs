//! Messages at the bottom of the window: one line each, and no duplicates.

use crate::platform::clock::{self, Duration, Instant};

/// Message of one line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    pub text: String,
    /// An error stays until its cause is gone. Other messages time out.
    pub is_error: bool,
    /// Subject. A new message replaces the one about the same subject, and [`Messages::clear`] removes it.
    about: &'static str,
    since: Instant,
}

/// Current messages, the latest last.
#[derive(Default)]
pub struct Messages(Vec<Message>);

/// Longest and shortest time for which a message that is no error is shown; user activity ends it in between.
const MAX_SHOWN: Duration = Duration::from_secs(8);
const MIN_SHOWN: Duration = Duration::from_secs(1);

/// Longest message, characters.
const MAX_CHARACTERS: usize = 600;

/// Returns a text as one line of at most `most` characters. The middle is cut out, because paths and reasons end with
/// the important part.
pub fn truncate_middle(text: &str, most: usize) -> String {
    let mut line: Vec<_> = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    if line.len() > most {
        let head = most * 2 / 3;
        let tail = most / 3;
        line.splice(head..line.len() - tail, ['…']);
    }
    line.into_iter().collect()
}

/// Largest number of messages that are kept.
const MAX_MESSAGES: usize = 20;

impl Messages {
    pub fn info(&mut self, about: &'static str, text: impl ToString) {
        self.push(&text.to_string(), false, about);
    }

    pub fn error(&mut self, about: &'static str, text: impl ToString) {
        self.push(&text.to_string(), true, about);
    }

    /// Removes the message about a subject whose cause is gone.
    pub fn clear(&mut self, about: &'static str) {
        self.0.retain(|message| message.about != about);
    }

    /// Removes the latest message.
    pub fn dismiss_latest(&mut self) {
        self.0.pop();
    }

    pub fn latest(&self) -> Option<&Message> {
        self.0.last()
    }

    /// Removes messages that have timed out. Call once a frame. `acts`: the user is doing something. Returns the time
    /// until the next message times out.
    pub fn advance(&mut self, now: Instant, acts: bool) -> Option<Duration> {
        let age = |message: &Message| now.saturating_duration_since(message.since);
        let most = if acts { MIN_SHOWN } else { MAX_SHOWN };
        self.0.retain(|message| message.is_error || age(message) < most);
        let left =
            self.0.iter().filter(|message| !message.is_error).map(|message| MAX_SHOWN.saturating_sub(age(message)));
        left.min()
    }

    fn push(&mut self, text: &str, is_error: bool, about: &'static str) {
        // Names in the text may contain control characters and have any length.
        let message = Message { text: truncate_middle(text, MAX_CHARACTERS), is_error, about, since: clock::now() };
        let is_same = |other: &Message| (&other.text, other.is_error, other.about) == (&message.text, is_error, about);
        if is_error && self.0.iter().any(is_same) {
            return;
        }
        self.clear(about);
        self.0.push(message);
        let surplus = self.0.len().saturating_sub(MAX_MESSAGES);
        self.0.drain(..surplus);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_is_one_line_of_limited_length() {
        let mut messages = Messages::default();
        messages.info("file", format!("a\nb{}: it is full", "c".repeat(4000)));
        let text = messages.latest().unwrap().text.clone();
        assert!(text.starts_with("a bcc") && text.contains("c…c") && text.ends_with("c: it is full"), "{text}");
        assert_eq!((text.chars().count(), truncate_middle("abcdef", 6)), (MAX_CHARACTERS + 1, "abcdef".into()));
    }

    #[test]
    fn a_message_is_shown_once_and_can_be_withdrawn() {
        let mut messages = Messages::default();
        for _ in 0..3 {
            messages.error("ramp", "broken");
        }
        messages.info("file", "saved");
        assert_eq!(messages.0.len(), 2);
        messages.error("ramp", "broken elsewhere");
        assert_eq!(messages.latest().map(|message| message.text.as_str()), Some("broken elsewhere"));
        messages.clear("ramp");
        assert_eq!(messages.latest().map(|message| message.is_error), Some(false));
    }

    #[test]
    fn information_times_out_or_ends_with_activity_and_errors_stay() {
        let mut messages = Messages::default();
        messages.error("ramp", "broken");
        messages.info("file", "saved");
        let begin = Instant::now();
        let latest = |messages: &Messages| messages.latest().unwrap().text.clone();
        assert!(messages.advance(begin, true).is_some_and(|left| left <= MAX_SHOWN));
        assert_eq!(latest(&messages), "saved", "no one has read it");
        messages.advance(begin + MIN_SHOWN, false);
        assert_eq!(latest(&messages), "saved");
        assert_eq!(messages.advance(begin + MIN_SHOWN, true), None);
        assert_eq!(latest(&messages), "broken");
        messages.info("file", "saved");
        assert_eq!((messages.advance(Instant::now() + MAX_SHOWN, false), latest(&messages)), (None, "broken".into()));
    }
}
