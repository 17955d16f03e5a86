//! Number fields that also accept changes such as `+0.1` and `*2`.

use std::cell::Cell;

use egui::{DragValue, Response, Ui};

/// Input to a field of non-negative numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Typed {
    /// A number.
    To(f32),
    /// `+0.1`, `-0.1`: an amount to add.
    By(f32),
    /// `*2`, `/2`: a factor.
    Times(f32),
}

impl Typed {
    fn parse(text: &str) -> Option<Self> {
        let text: String = text.chars().filter(|c| !c.is_whitespace()).collect();
        let number = |text: &str| text.parse().ok().filter(|number: &f32| number.is_finite());
        let mut rest = text.chars();
        match rest.next()? {
            '+' => number(rest.as_str()).map(Self::By),
            '-' | '−' => number(rest.as_str()).map(|number| Self::By(-number)),
            '*' | '×' => number(rest.as_str()).map(Self::Times),
            '/' => number(rest.as_str()).filter(|number| *number != 0.0).map(|number| Self::Times(1.0 / number)),
            _ => number(&text).map(Self::To),
        }
    }

    pub fn of(self, number: f32) -> f32 {
        match self {
            Self::To(to) => to,
            Self::By(by) => number + by,
            Self::Times(times) => number * times,
        }
    }
}

/// Shows a number in a field that `style` lays out. Returns the change to apply to it, and to the same number of other
/// selected stops.
pub fn field(
    ui: &mut Ui,
    number: f32,
    style: impl for<'a> FnOnce(&mut Ui, DragValue<'a>) -> Response,
) -> (Response, Option<Typed>) {
    let (typed, way) = (Cell::new(false), Cell::new(None));
    let mut shown = number;
    let parse = |text: &str| match Typed::parse(text)? {
        Typed::To(to) => {
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
    let changed = || if typed.get() { Typed::To(shown) } else { Typed::By(shown - number) };
    let done = way.get().or_else(|| response.changed().then(changed));
    (response, done)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn typed_text_is_a_number_or_a_relative_change() {
        for (text, expected) in [
            ("0.25", Typed::To(0.25)),
            (" .5 ", Typed::To(0.5)),
            ("+0.25", Typed::By(0.25)),
            ("-0.25", Typed::By(-0.25)),
            ("− 0.25", Typed::By(-0.25)),
            ("*2", Typed::Times(2.0)),
            ("/ 4", Typed::Times(0.25)),
        ] {
            assert_eq!(Typed::parse(text), Some(expected), "{text}");
        }
        for text in ["", "+", "*", "/0", "a", "*nan", "1 + 1", "+inf"] {
            assert_eq!(Typed::parse(text), None, "{text}");
        }
    }
}
