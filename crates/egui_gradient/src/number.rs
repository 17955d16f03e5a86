//! Fields of numbers that take `+0.1` and `*2` as well.

use std::cell::Cell;

use egui::{DragValue, Response, Ui};

/// What is typed into a field of numbers that are not negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Typed {
    /// The number itself.
    To(f32),
    /// `+0.1`, `-0.1`: so much more or less.
    By(f32),
    /// `*2`, `/2`: so many times.
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

/// Shows a number, in a field that `style` makes; gives what is to be done to it, and to others like it.
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
        // Not the field's to apply: it reads what is typed again in the next frame, unless the number is another by then.
        by_or_times => {
            way.set(Some(by_or_times));
            None
        }
    };
    let response = style(ui, DragValue::new(&mut shown).custom_parser(parse).update_while_editing(false));
    // As it was kept to the range; by a drag the others go along.
    let changed = || if typed.get() { Typed::To(shown) } else { Typed::By(shown - number) };
    let done = way.get().or_else(|| response.changed().then(changed));
    (response, done)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_typed_is_a_number_or_a_way_to_one() {
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
