//! Undo and redo of a value that panels change directly.

use std::collections::VecDeque;

/// Most steps that can be undone.
pub const MOST_STEPS: usize = 500;

/// The steps that led to a value, and those that were undone. A step is the whole value: a preset is a few kilobytes.
pub struct History<T> {
    /// The value after the last step.
    settled: T,
    /// Before each step, oldest first.
    past: VecDeque<Step<T>>,
    /// After each undone step, the last undone one last.
    future: Vec<Step<T>>,
    /// The name of the step that is being made, while a control is held.
    open: Option<String>,
}

struct Step<T> {
    name: String,
    value: T,
}

impl<T: Clone + PartialEq> History<T> {
    pub fn new(value: T) -> Self {
        Self { settled: value, past: VecDeque::new(), future: Vec::new(), open: None }
    }

    /// To be called once a frame, after the panels. While `is_held` (a pointer is down on a control, a text field has the
    /// keyboard) changes gather in one step, which is named and closed by the first frame after.
    ///
    /// A value that does not equal itself, as one with a NaN in it, is no step.
    pub fn track(&mut self, current: &T, is_held: bool, name: impl FnOnce(&T, &T) -> String) {
        if !self.is_changed(current) {
            self.open = None;
        } else if !is_held {
            self.close(current.clone(), name(&self.settled, current));
        } else if self.open.is_none() {
            self.open = Some(name(&self.settled, current));
        }
    }

    /// Takes back the last step, or the one that is being made, and gives its name.
    pub fn undo(&mut self, current: &mut T) -> Option<&str> {
        if self.is_changed(current) {
            let name = self.open.take().unwrap_or_else(|| "change".into());
            self.close(current.clone(), name);
        }
        let Step { name, value } = self.past.pop_back()?;
        let undone = std::mem::replace(&mut self.settled, value);
        self.future.push(Step { name, value: undone });
        current.clone_from(&self.settled);
        self.redo_name()
    }

    /// Does the last undone step again, and gives its name. What has been changed since is a step and leaves nothing to redo.
    pub fn redo(&mut self, current: &mut T) -> Option<&str> {
        if self.is_changed(current) {
            return None;
        }
        let Step { name, value } = self.future.pop()?;
        let before = std::mem::replace(&mut self.settled, value);
        self.past.push_back(Step { name, value: before });
        current.clone_from(&self.settled);
        self.undo_name()
    }

    /// What [`History::undo`] would take back.
    pub fn undo_name(&self) -> Option<&str> {
        self.open.as_deref().or_else(|| self.past.back().map(|step| step.name.as_str()))
    }

    /// What [`History::redo`] would do again.
    pub fn redo_name(&self) -> Option<&str> {
        self.future.last().filter(|_| self.open.is_none()).map(|step| step.name.as_str())
    }

    #[allow(clippy::eq_op, reason = "a NaN does not equal itself")]
    fn is_changed(&self, current: &T) -> bool {
        *current != self.settled && *current == *current
    }

    fn close(&mut self, value: T, name: String) {
        self.open = None;
        self.future.clear();
        if self.past.len() == MOST_STEPS {
            self.past.pop_front();
        }
        let before = std::mem::replace(&mut self.settled, value);
        self.past.push_back(Step { name, value: before });
    }
}
