//! Undo and redo of a value that panels change directly.

use std::collections::VecDeque;

/// Largest number of steps that can be undone.
pub const MAX_STEPS: usize = 500;

/// Steps that led to a value, and steps that were undone. Each step stores the whole value: a preset has a few
/// kilobytes.
pub struct History<T> {
    /// Value after the last step.
    settled: T,
    /// Value before each step, the oldest first.
    past: VecDeque<UndoStep<T>>,
    /// Value after each undone step; the last undone step is last.
    future: Vec<UndoStep<T>>,
    /// Name of the step in progress, while a control is held.
    open: Option<String>,
}

struct UndoStep<T> {
    name: String,
    value: T,
}

impl<T: Clone + PartialEq> History<T> {
    pub fn new(value: T) -> Self {
        Self { settled: value, past: VecDeque::new(), future: Vec::new(), open: None }
    }

    /// Returns the value after the last step.
    pub fn settled(&self) -> &T {
        &self.settled
    }

    /// Like [`History::track`] with an unchanged value.
    pub fn rest(&mut self) {
        self.open = None;
    }

    /// Records changes of a value. Call once a frame, after the panels. While `is_held` (a pointer is down on a
    /// control, or a text field has the keyboard focus), changes are merged into one step, which the first frame
    /// afterwards names and closes.
    ///
    /// A value that does not equal itself, because it contains a NaN, is no step.
    pub fn track(&mut self, current: &T, is_held: bool, name: impl FnOnce(&T, &T) -> String) {
        if !self.is_changed(current) {
            self.rest();
        } else if !is_held {
            self.close(current.clone(), name(&self.settled, current));
        } else if self.open.is_none() {
            self.open = Some(name(&self.settled, current));
        }
    }

    /// Undoes the last step, or the one in progress, and returns its name.
    pub fn undo(&mut self, current: &mut T) -> Option<&str> {
        if self.is_changed(current) {
            let name = self.open.take().unwrap_or_else(|| "Change".into());
            self.close(current.clone(), name);
        }
        let UndoStep { name, value } = self.past.pop_back()?;
        let undone = std::mem::replace(&mut self.settled, value);
        self.future.push(UndoStep { name, value: undone });
        current.clone_from(&self.settled);
        self.redo_name()
    }

    /// Redoes the last undone step and returns its name. A change made since then is a step of its own, and leaves
    /// nothing to redo.
    pub fn redo(&mut self, current: &mut T) -> Option<&str> {
        if self.is_changed(current) {
            return None;
        }
        let UndoStep { name, value } = self.future.pop()?;
        let before = std::mem::replace(&mut self.settled, value);
        self.past.push_back(UndoStep { name, value: before });
        current.clone_from(&self.settled);
        self.undo_name()
    }

    /// Returns the name of the step that [`History::undo`] would undo.
    pub fn undo_name(&self) -> Option<&str> {
        self.open.as_deref().or_else(|| self.past.back().map(|step| step.name.as_str()))
    }

    /// Returns the name of the step that [`History::redo`] would redo.
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
        if self.past.len() == MAX_STEPS {
            self.past.pop_front();
        }
        let before = std::mem::replace(&mut self.settled, value);
        self.past.push_back(UndoStep { name, value: before });
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn name<T: std::fmt::Display>(before: &T, after: &T) -> String {
        format!("{before} to {after}")
    }

    #[test]
    fn a_drag_is_one_step() {
        let mut history = History::new(0);
        for value in [1, 2, 3] {
            history.track(&value, true, name);
            assert_eq!(history.undo_name(), Some("0 to 1"));
        }
        history.track(&3, false, name);
        assert_eq!(history.undo_name(), Some("0 to 3"));
        // A change that is reverted before the release is no step.
        history.track(&4, true, name);
        history.track(&3, true, name);
        history.track(&3, false, name);
        let mut value = 3;
        assert_eq!(history.undo(&mut value), Some("0 to 3"));
        assert_eq!((value, history.undo_name(), history.redo_name()), (0, None, Some("0 to 3")));
        assert_eq!(history.undo(&mut value), None);
    }

    #[test]
    fn undo_during_a_drag_reverts_the_drag() {
        let mut history = History::new(0);
        let mut value = 1;
        history.track(&value, true, name);
        assert_eq!(history.undo(&mut value), Some("0 to 1"));
        assert_eq!(value, 0);
        history.track(&value, true, name);
        assert_eq!(history.redo(&mut value), Some("0 to 1"));
        assert_eq!(value, 1);
        // The same before a frame has seen the change.
        value = 2;
        assert_eq!(history.redo(&mut value), None);
        assert_eq!(history.undo(&mut value), Some("Change"));
        assert_eq!(value, 1);
    }

    #[test]
    fn a_nan_is_no_step_and_undo_removes_it() {
        let mut history = History::new(0.0);
        history.track(&1.0, false, name);
        for _ in 0..3 {
            history.track(&f32::NAN, false, name);
        }
        let mut value = f32::NAN;
        assert_eq!(history.undo(&mut value), Some("0 to 1"));
        assert_eq!((value.to_bits(), history.undo_name()), (0, None));
    }

    #[test]
    fn the_number_of_steps_is_limited() {
        let mut history = History::new(0);
        (1..=3000u32).for_each(|value| history.track(&value, false, name));
        let mut value = 3000;
        let mut steps = 0;
        while history.undo(&mut value).is_some() {
            steps += 1;
        }
        assert_eq!((steps, value), (MAX_STEPS, 2500));
    }

    proptest! {
        /// Compares with a simple model: a list of values and a position in it.
        #[test]
        fn steps_are_undone_and_redone_in_order(does in prop::collection::vec((0u8..5, 0u8..4), 1..60)) {
            let mut history = History::new(0);
            let mut model = vec![0];
            let mut at = 0;
            let mut value = 0;
            for (what, to) in does {
                match what {
                    0 => {
                        if at > 0 {
                            let expected = name(&model[at - 1], &model[at]);
                            prop_assert_eq!(history.undo(&mut value), Some(expected.as_str()));
                            at -= 1;
                        } else {
                            prop_assert_eq!(history.undo(&mut value), None);
                        }
                    }
                    1 => {
                        if at + 1 < model.len() {
                            let expected = name(&model[at], &model[at + 1]);
                            prop_assert_eq!(history.redo(&mut value), Some(expected.as_str()));
                            at += 1;
                        } else {
                            prop_assert_eq!(history.redo(&mut value), None);
                        }
                    }
                    _ => {
                        // A drag over some values, or a click.
                        (0..what - 2).for_each(|held| history.track(&held, true, name));
                        value = to;
                        history.track(&value, false, name);
                        if value != model[at] {
                            model.truncate(at + 1);
                            model.push(value);
                            at += 1;
                        }
                    }
                }
                prop_assert_eq!(value, model[at]);
                prop_assert_eq!(history.undo_name().is_some(), at > 0);
                prop_assert_eq!(history.redo_name().is_some(), at + 1 < model.len());
            }
            let last = value;
            let undone = at;
            (0..undone).for_each(|_| assert!(history.undo(&mut value).is_some()));
            prop_assert_eq!(value, 0);
            (0..undone).for_each(|_| assert!(history.redo(&mut value).is_some()));
            prop_assert_eq!(value, last);
        }
    }
}
