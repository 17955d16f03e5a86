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

/// Most characters of a message.
const LONGEST: usize = 600;

/// A text from outside on one line of at most so many characters: what is too much goes from its middle, for paths and reasons
/// end with what matters.
pub fn short(text: &str, most: usize) -> String {
    let mut line: Vec<_> = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    if line.len() > most {
        let (head, tail) = (most * 2 / 3, most / 3);
        line.splice(head..line.len() - tail, ['…']);
    }
    line.into_iter().collect()
}

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

    fn push(&mut self, mut message: Message) {
        // Names may have anything in them.
        message.text = short(&message.text, LONGEST);
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
    fn what_is_said_is_one_line_and_not_endless() {
        let mut messages = Messages::default();
        messages.say("file", format!("a\nb{}: it is full", "c".repeat(4000)));
        let text = messages.latest().unwrap().text.clone();
        assert!(text.starts_with("a bcc") && text.contains("c…c") && text.ends_with("c: it is full"), "{text}");
        assert_eq!((text.chars().count(), short("abcdef", 6)), (LONGEST + 1, "abcdef".into()));
    }

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
