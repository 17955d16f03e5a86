//! One table per settings struct: name, kind, valid range and unit of every field, visited by a visitor.
//!
//! The same traversal validates presets and builds the panels of user interfaces, so that a range is written once. The
//! name passed to the visitor is the Rust field, the preset key and the label. The field's doc comment is its tooltip
//! (`Tooltips` returns it at run time).

use std::fmt::Write as _;
use std::ops::RangeInclusive;

use glam::Vec3;

use super::choice::Choice;
use super::curve::Curve;
use crate::error::FieldError;

/// Settings struct whose fields can be visited.
pub trait Fields {
    /// Passes every field to `visitor`, in the order of the struct.
    fn visit(&mut self, visitor: &mut dyn FieldVisitor);

    /// Every field in the order of the struct, with the heading above it if there is one, for user interfaces. Empty
    /// for a struct without a table.
    fn headings(&self) -> &'static [FieldHeading] {
        &[]
    }
}

/// Name of a field, and the heading above it if a group of fields starts there.
pub type FieldHeading = (&'static str, Option<&'static str>);

/// Use of an image that a field names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImageRole {
    /// Flipbook of normal maps.
    Sprite,
    /// Depth and motion of a flipbook.
    Detail,
    /// Flipbook lit from six sides.
    SixWay,
    /// Gradient, or a stack of gradients.
    Ramp,
    /// Painted image of a lit sphere.
    Motif,
    /// Slices of a tiling noise.
    Noise,
}

/// Kind of a file that is shown around the smoke.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BackdropKind {
    /// Objects around the smoke.
    Scene,
    /// Panorama of the sky.
    Sky,
}

impl BackdropKind {
    /// Every kind.
    pub const ALL: [Self; 2] = [Self::Scene, Self::Sky];
}

/// Visitor of the fields of a settings struct. Fields that are not numbers are ignored by default.
pub trait FieldVisitor {
    /// Real number. `unit` is "" for a ratio.
    fn number(&mut self, name: &'static str, value: &mut f32, range: RangeInclusive<f32>, unit: &'static str);

    /// Time, which f32 is too coarse for after hours. Visitors see it as f32, and change it only if they give another number.
    fn time(&mut self, name: &'static str, value: &mut f64, range: RangeInclusive<f32>, unit: &'static str) {
        let shown = *value as f32;
        let mut given = shown;
        self.number(name, &mut given, range, unit);
        if given.to_bits() != shown.to_bits() {
            // Digit by digit: 2.1 of f32 is 2.0999999 in f64.
            *value = given.to_string().parse().unwrap_or_else(|_| f64::from(given));
        }
    }

    /// Whole number.
    fn integer(&mut self, name: &'static str, value: &mut u32, range: RangeInclusive<u32>, unit: &'static str);

    /// Position, direction or size: three numbers that share a range.
    fn vector(&mut self, name: &'static str, value: &mut Vec3, range: RangeInclusive<f32>, unit: &'static str);

    /// Linear RGB.
    fn color(&mut self, name: &'static str, value: &mut Vec3, range: RangeInclusive<f32>) {
        self.vector(name, value, range, "");
    }

    /// sRGB color with 8 bits a channel.
    fn srgb(&mut self, _name: &'static str, _value: &mut [u8; 3]) {}

    /// Curve over the life of a particle, with values in `range`.
    fn curve(&mut self, _name: &'static str, _value: &mut Curve, _range: RangeInclusive<f32>) {}

    /// Boolean.
    fn flag(&mut self, _name: &'static str, _value: &mut bool) {}

    /// Enum.
    fn choice(&mut self, _name: &'static str, _value: &mut dyn Choice) {}

    /// Free text.
    fn text(&mut self, _name: &'static str, _value: &mut String) {}

    /// Name of an image: a built-in one, or a file.
    fn image(&mut self, _name: &'static str, _value: &mut String, _role: ImageRole) {}

    /// Name of a particle file, or of one file per frame; empty for none.
    fn particles(&mut self, _name: &'static str, _value: &mut String) {}

    /// Name of a file around the smoke; empty for none.
    fn backdrop(&mut self, _name: &'static str, _value: &mut String, _kind: BackdropKind) {}

    /// Random seed. Every whole number is valid.
    fn seed(&mut self, _name: &'static str, _value: &mut u32) {}

    /// Nested struct.
    fn group(&mut self, name: &'static str, fields: &mut dyn Fields);

    /// Entry of a list.
    fn item(&mut self, name: &'static str, index: usize, fields: &mut dyn Fields);
}

/// Checks every number of `settings` against its range. `path` is the path of the struct and precedes the field's name
/// in the message: `systems[0].settings` gives `systems[0].settings.soft_fade.fade_scale`.
///
/// # Errors
/// The first field that is NaN or outside its range.
pub fn validate<T: Fields + Clone>(settings: &T, path: impl FnOnce() -> String) -> Result<(), FieldError> {
    let mut validator = Validator { path: [PathStep::default(); MAX_DEPTH], depth: 0, error: None };
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

/// Maximum nesting depth. No settings struct comes near it.
const MAX_DEPTH: usize = 8;

/// Struct on the path to a field: its name, and its index if it is in a list.
type PathStep = (&'static str, Option<usize>);

/// Stores the path without allocation, because every frame validates its settings and must not allocate if they are
/// valid.
struct Validator {
    path: [PathStep; MAX_DEPTH],
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
        // `contains` is false for NaN, as intended.
        if self.error.is_some() || range.contains(&value) {
            return;
        }
        let mut field = String::new();
        for (name, index) in &self.path[..self.depth] {
            let _ = match index {
                Some(index) => write!(field, "{name}[{index}]."),
                None => write!(field, "{name}."),
            };
        }
        field.push_str(name);
        let space = if unit.is_empty() { "" } else { " " };
        let low = range.start().to_string();
        let high = range.end().to_string();
        let expected = if high == "inf" {
            format!("at least {low}{space}{unit}")
        } else {
            format!("{low} to {high}{space}{unit}")
        };
        self.error = Some(FieldError::new(field, value, expected));
    }

    fn enter(&mut self, step: PathStep, fields: &mut dyn Fields) {
        if self.depth < MAX_DEPTH {
            self.path[self.depth] = step;
            self.depth += 1;
            fields.visit(self);
            self.depth -= 1;
        }
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

    fn curve(&mut self, name: &'static str, value: &mut Curve, range: RangeInclusive<f32>) {
        for point in value.points() {
            self.check(name, point.y, &range, "");
        }
    }

    fn group(&mut self, name: &'static str, fields: &mut dyn Fields) {
        self.enter((name, None), fields);
    }

    fn item(&mut self, name: &'static str, index: usize, fields: &mut dyn Fields) {
        self.enter((name, Some(index)), fields);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::settings_macro::settings;

    settings! {
        #[derive(Clone)]
        pub struct Inner {
            contrast_power: f32 = 2.0, number(0.1..=16.0, "");
            "ends":
            steepest: f32 = 16.0, number(|this| this.contrast_power..=16.0, "");
        }
    }
    #[derive(Clone)]
    struct Outer {
        scale: u32,
        soft_fade: Inner,
        systems: Vec<Inner>,
    }
    impl Fields for Outer {
        fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
            visitor.integer("scale", &mut self.scale, 1..=16, "pixels");
            visitor.group("soft_fade", &mut self.soft_fade);
            for (index, system) in self.systems.iter_mut().enumerate() {
                visitor.item("systems", index, system);
            }
        }
    }

    fn outer(scale: u32, contrast_power: f32) -> Outer {
        Outer { scale, soft_fade: Inner { contrast_power, ..Inner::default() }, systems: vec![Inner::default(); 2] }
    }

    #[test]
    fn a_value_in_range_passes() {
        assert!(validate(&outer(4, 2.0), || unreachable!("no error, no path")).is_ok());
    }

    #[test]
    fn headings_belong_to_the_row_that_follows() {
        assert_eq!(Inner::default().headings(), [("contrast_power", None), ("steepest", Some("ends"))]);
        assert_eq!(outer(1, 2.0).headings(), []);
    }

    #[test]
    fn the_message_names_the_field_the_value_and_the_range() {
        let error = validate(&outer(17, 2.0), || "systems[1]".into()).unwrap_err();
        assert_eq!(error.to_string(), "systems[1].scale: 17 is not valid; expected 1 to 16 pixels");
        let error = validate(&outer(1, f32::NAN), String::new).unwrap_err();
        assert_eq!(error.to_string(), "soft_fade.contrast_power: NaN is not valid; expected 0.1 to 16");
        let mut outer = outer(1, 2.0);
        outer.systems[1].contrast_power = 7.0;
        outer.systems[1].steepest = 3.0;
        let error = validate(&outer, String::new).unwrap_err();
        assert_eq!(error.to_string(), "systems[1].steepest: 3 is not valid; expected 7 to 16");
    }
}
