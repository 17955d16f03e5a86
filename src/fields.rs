//! One table per settings struct: every number's name, valid range and unit, walked by a visitor.
//!
//! The walk is what checks a preset, and what a user interface builds its sliders from, so that a range is
//! written once. The name given to the visitor is the Rust field, the preset key and the slider's label.

use std::fmt::Write as _;
use std::ops::RangeInclusive;

use glam::Vec3;

use crate::error::FieldError;

/// A settings struct whose numbers can be walked.
pub trait Fields {
    /// Hands every number to `visitor`, in the order of the struct.
    fn visit(&mut self, visitor: &mut dyn FieldVisitor);
}

/// What walks the numbers of a settings struct.
pub trait FieldVisitor {
    /// A real number. `unit` is "" for a ratio.
    fn number(&mut self, name: &'static str, value: &mut f32, range: RangeInclusive<f32>, unit: &'static str);

    /// A whole number.
    fn integer(&mut self, name: &'static str, value: &mut u32, range: RangeInclusive<u32>, unit: &'static str);

    /// Three numbers that share a range: a colour (linear RGB), a position or a direction.
    fn vector(&mut self, name: &'static str, value: &mut Vec3, range: RangeInclusive<f32>, unit: &'static str);

    /// A nested struct.
    fn group(&mut self, name: &'static str, fields: &mut dyn Fields);
}

/// Checks every number of `settings` against its range. `path` leads to the struct and is put before the
/// field's name in the message: `systems[0].settings` gives `systems[0].settings.soft_fade.fade_scale`.
///
/// # Errors
/// The first field that is not a finite number inside its range.
pub fn validate<T: Fields + Clone>(settings: &T, path: impl FnOnce() -> String) -> Result<(), FieldError> {
    let mut validator = Validator { groups: [""; MAX_DEPTH], depth: 0, error: None };
    settings.clone().visit(&mut validator);
    match validator.error {
        None => Ok(()),
        Some(mut error) => {
            let prefix = path();
            if !prefix.is_empty() {
                error.field = format!("{prefix}.{}", error.field);
            }
            Err(error)
        }
    }
}

/// Deepest nesting of groups; no settings struct comes near it.
const MAX_DEPTH: usize = 8;

/// Fixed storage: a frame validates its settings and must not allocate while all is well.
struct Validator {
    groups: [&'static str; MAX_DEPTH],
    depth: usize,
    error: Option<FieldError>,
}

impl Validator {
    fn check<T: Copy + PartialOrd + std::fmt::Display>(
        &mut self,
        name: &str,
        value: T,
        range: &RangeInclusive<T>,
        unit: &str,
    ) {
        // `contains` is false for NaN, which is what we want.
        if self.error.is_some() || range.contains(&value) {
            return;
        }
        let mut field = String::new();
        for group in &self.groups[..self.depth] {
            let _ = write!(field, "{group}.");
        }
        field.push_str(name);
        let space = if unit.is_empty() { "" } else { " " };
        self.error = Some(FieldError {
            field,
            value: value.to_string(),
            expected: format!("{} to {}{space}{unit}", range.start(), range.end()),
        });
    }
}

impl FieldVisitor for Validator {
    fn number(&mut self, name: &'static str, value: &mut f32, range: RangeInclusive<f32>, unit: &'static str) {
        self.check(name, *value, &range, unit);
    }

    fn integer(&mut self, name: &'static str, value: &mut u32, range: RangeInclusive<u32>, unit: &'static str) {
        self.check(name, *value, &range, unit);
    }

    fn vector(&mut self, name: &'static str, value: &mut Vec3, range: RangeInclusive<f32>, unit: &'static str) {
        for component in value.to_array() {
            self.check(name, component, &range, unit);
        }
    }

    fn group(&mut self, name: &'static str, fields: &mut dyn Fields) {
        if self.depth < MAX_DEPTH {
            self.groups[self.depth] = name;
            self.depth += 1;
            fields.visit(self);
            self.depth -= 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Clone)]
    struct Inner {
        contrast_power: f32,
    }
    #[derive(Clone)]
    struct Outer {
        scale: u32,
        soft_fade: Inner,
    }
    impl Fields for Inner {
        fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
            visitor.number("contrast_power", &mut self.contrast_power, 0.1..=16.0, "");
        }
    }
    impl Fields for Outer {
        fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
            visitor.integer("scale", &mut self.scale, 1..=16, "pixels");
            visitor.group("soft_fade", &mut self.soft_fade);
        }
    }

    fn outer(scale: u32, contrast_power: f32) -> Outer {
        Outer { scale, soft_fade: Inner { contrast_power } }
    }

    #[test]
    fn a_value_in_range_passes() {
        assert!(validate(&outer(4, 2.0), || unreachable!("no error, no path")).is_ok());
    }

    #[test]
    fn the_message_names_the_field_the_value_and_the_range() {
        let error = validate(&outer(17, 2.0), || "systems[1]".into()).unwrap_err();
        assert_eq!(error.to_string(), "systems[1].scale: 17 is not valid; expected 1 to 16 pixels");
        let error = validate(&outer(1, f32::NAN), String::new).unwrap_err();
        assert_eq!(error.to_string(), "soft_fade.contrast_power: NaN is not valid; expected 0.1 to 16");
    }
}
