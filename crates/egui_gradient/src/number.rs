//! Number fields that also accept changes such as `+0.1` and `*2`.

use std::cell::Cell;

use egui::{DragValue, Response, Ui};

/// Input to a field of non-negative numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NumberInput {
    /// A number.
    Set(f32),
    /// `+0.1`, `-0.1`: an amount to add.
    Add(f32),
    /// `*2`, `/2`: a factor.
    Multiply(f32),
}

impl NumberInput {
    fn parse(text: &str) -> Option<Self> {
        let text: String = text.chars().filter(|c| !c.is_whitespace()).collect();
        let number = |text: &str| text.parse().ok().filter(|number: &f32| number.is_finite());
        let mut rest = text.chars();
        match rest.next()? {
            '+' => number(rest.as_str()).map(Self::Add),
            '-' | '−' => number(rest.as_str()).map(|number| Self::Add(-number)),
            '*' | '×' => number(rest.as_str()).map(Self::Multiply),
            '/' => number(rest.as_str()).filter(|number| *number != 0.0).map(|number| Self::Multiply(1.0 / number)),
            _ => number(&text).map(Self::Set),
        }
    }

    pub fn apply_to(self, number: f32) -> f32 {
        match self {
            Self::Set(to) => to,
            Self::Add(by) => number + by,
            Self::Multiply(times) => number * times,
        }
    }
}

/// Shows a number in a field that `style` lays out. Returns the change to apply to it, and to the same number of other
/// selected stops.
pub fn field(
    ui: &mut Ui,
    number: f32,
    style: impl for<'a> FnOnce(&mut Ui, DragValue<'a>) -> Response,
) -> (Response, Option<NumberInput>) {
    let typed = Cell::new(false);
    let way = Cell::new(None);
    let mut shown = number;
    let parse = |text: &str| match NumberInput::parse(text)? {
        NumberInput::Set(to) => {
            typed.set(true);
            Some(f64::from(to))
        }
        // The caller applies the change. If the field applied it, it would parse the text and apply it again in the
        // next frame.
        by_or_times => {
            way.set(Some(by_or_times));
            None
        }
    };
    let response = style(ui, DragValue::new(&mut shown).custom_parser(parse).update_while_editing(false));
    // A typed number is used as clamped to the range. A drag is a relative change, so that other selected stops follow.
    let changed = || if typed.get() { NumberInput::Set(shown) } else { NumberInput::Add(shown - number) };
    let done = way.get().or_else(|| response.changed().then(changed));
    (response, done)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn typed_text_is_a_number_or_a_relative_change() {
        for (text, expected) in [
            ("0.25", NumberInput::Set(0.25)),
            (" .5 ", NumberInput::Set(0.5)),
            ("+0.25", NumberInput::Add(0.25)),
            ("-0.25", NumberInput::Add(-0.25)),
            ("− 0.25", NumberInput::Add(-0.25)),
            ("*2", NumberInput::Multiply(2.0)),
            ("/ 4", NumberInput::Multiply(0.25)),
        ] {
            assert_eq!(NumberInput::parse(text), Some(expected), "{text}");
        }
        for text in ["", "+", "*", "/0", "a", "*nan", "1 + 1", "+inf"] {
            assert_eq!(NumberInput::parse(text), None, "{text}");
        }
    }
}
