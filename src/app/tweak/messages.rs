//! What the window has to say: one line at a time, and each thing once.

/// A line at the bottom of the window.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    pub text: String,
    pub is_error: bool,
    /// What it is about: a message about the same thing takes its place, and can be taken back.
    about: &'static str,
}

/// The messages that still hold, the latest last.
#[derive(Default)]
pub struct Messages(Vec<Message>);

/// Most that are kept.
const MOST: usize = 20;

impl Messages {
    pub fn say(&mut self, about: &'static str, text: impl ToString) {
        self.push(Message { text: text.to_string(), is_error: false, about });
    }

    pub fn complain(&mut self, about: &'static str, text: impl ToString) {
        self.push(Message { text: text.to_string(), is_error: true, about });
    }

    /// What was wrong is mended.
    pub fn withdraw(&mut self, about: &'static str) {
        self.0.retain(|message| message.about != about);
    }

    pub fn latest(&self) -> Option<&Message> {
        self.0.last()
    }

    fn push(&mut self, message: Message) {
        if self.0.contains(&message) {
            return;
        }
        self.withdraw(message.about);
        self.0.push(message);
        let surplus = self.0.len().saturating_sub(MOST);
        self.0.drain(..surplus);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thing_is_said_once_and_taken_back() {
        let mut messages = Messages::default();
        for _ in 0..3 {
            messages.complain("ramp", "broken");
        }
        messages.say("file", "saved");
        assert_eq!(messages.0.len(), 2);
        messages.complain("ramp", "broken elsewhere");
        assert_eq!(messages.latest().map(|message| message.text.as_str()), Some("broken elsewhere"));
        messages.withdraw("ramp");
        assert_eq!(messages.latest().map(|message| message.is_error), Some(false));
    }
}
