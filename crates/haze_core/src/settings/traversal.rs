//! Traversal of every field of a settings struct, with the path that leads to it.

use std::fmt::Write as _;
use std::ops::RangeInclusive;

use glam::Vec3;

use super::choice::Choice;
use super::curve::Curve;
use super::fields::{BackdropKind, FieldVisitor, Fields, ImageRole};

/// Name on the path to a field, and its index if it is in a list.
pub type PathStep<'a> = (&'a str, Option<usize>);

/// Reference to a field.
pub enum FieldRef<'a> {
    /// Real number.
    Number(&'a mut f32),
    /// Whole number, or a seed.
    Whole(&'a mut u32),
    /// Three numbers, or linear RGB.
    Vector(&'a mut Vec3),
    /// Curve over the life of a particle, or over an emission.
    Curve(&'a mut Curve),
    /// Boolean.
    Flag(&'a mut bool),
    /// Enum.
    Choice(&'a mut dyn Choice),
    /// Text, or the name of a file.
    Text(&'a mut String),
}

/// Value of a field. NaN equals NaN here.
#[derive(Clone, Debug, serde::Serialize)]
#[serde(untagged)]
pub enum FieldValue {
    /// Value of a [`FieldRef::Number`].
    Number(f32),
    /// Value of a [`FieldRef::Whole`].
    Whole(u32),
    /// Value of a [`FieldRef::Vector`].
    Vector(Vec3),
    /// Value of a [`FieldRef::Curve`].
    Curve(Curve),
    /// Value of a [`FieldRef::Flag`].
    Flag(bool),
    /// Name of the choice of a [`FieldRef::Choice`].
    Choice(&'static str),
    /// Value of a [`FieldRef::Text`].
    Text(String),
}

impl PartialEq for FieldValue {
    fn eq(&self, other: &Self) -> bool {
        let same =
            |a: f32, b: f32| a.partial_cmp(&b).is_some_and(std::cmp::Ordering::is_eq) || a.is_nan() && b.is_nan();
        match (self, other) {
            (Self::Number(a), Self::Number(b)) => same(*a, *b),
            (Self::Vector(a), Self::Vector(b)) => (0..3).all(|axis| same(a[axis], b[axis])),
            (Self::Whole(a), Self::Whole(b)) => a == b,
            (Self::Curve(a), Self::Curve(b)) => a == b,
            (Self::Flag(a), Self::Flag(b)) => a == b,
            (Self::Choice(a), Self::Choice(b)) => a == b,
            (Self::Text(a), Self::Text(b)) => a == b,
            _ => false,
        }
    }
}

impl FieldRef<'_> {
    /// Returns the current value.
    pub fn value(&self) -> FieldValue {
        match self {
            Self::Number(value) => FieldValue::Number(**value),
            Self::Whole(value) => FieldValue::Whole(**value),
            Self::Vector(value) => FieldValue::Vector(**value),
            Self::Curve(value) => FieldValue::Curve(**value),
            Self::Flag(value) => FieldValue::Flag(**value),
            Self::Choice(value) => FieldValue::Choice(value.names().get(value.index()).copied().unwrap_or_default()),
            Self::Text(value) => FieldValue::Text((*value).clone()),
        }
    }

    /// Sets the value. A value of another kind, or an unknown name, changes nothing.
    pub fn set(self, value: &FieldValue) {
        match (self, value) {
            (Self::Number(field), FieldValue::Number(value)) => *field = *value,
            (Self::Whole(field), FieldValue::Whole(value)) => *field = *value,
            (Self::Vector(field), FieldValue::Vector(value)) => *field = *value,
            (Self::Curve(field), FieldValue::Curve(value)) => *field = *value,
            (Self::Flag(field), FieldValue::Flag(value)) => *field = *value,
            (Self::Text(field), FieldValue::Text(value)) => field.clone_from(value),
            (Self::Choice(field), FieldValue::Choice(name)) => {
                if let Some(index) = field.names().iter().position(|choice| choice == name) {
                    field.set_index(index);
                }
            }
            _ => {}
        }
    }
}

/// Calls `at` for every field in the order of the struct, with the steps that lead to it; the last is the field's own
/// name. [`FieldVisitor::srgb`] fields are skipped, because presets have none.
pub fn for_each_field(settings: &mut dyn Fields, at: &mut dyn FnMut(&[PathStep<'static>], FieldRef<'_>)) {
    settings.visit(&mut FieldTraversal { path: Vec::new(), at });
}

/// Path, as [`field_path`] formats it, and value of every field.
pub fn field_values<T: Fields + Clone>(settings: &T) -> Vec<(String, FieldValue)> {
    let mut values = Vec::new();
    for_each_field(&mut settings.clone(), &mut |path, leaf| values.push((field_path(path), leaf.value())));
    values
}

/// Formats a path: `systems[0].settings.boost`.
pub fn field_path(path: &[PathStep<'_>]) -> String {
    let mut text = String::new();
    write_field_path(path, &mut text);
    text
}

/// Formats a path into a text, which it replaces: for traversals that need many, without memory for each.
pub fn write_field_path(path: &[PathStep<'_>], text: &mut String) {
    text.clear();
    for (name, index) in path {
        if !text.is_empty() {
            text.push('.');
        }
        text.push_str(name);
        if let Some(index) = index {
            // Strings take every text.
            let _ = write!(text, "[{index}]");
        }
    }
}

struct FieldTraversal<'a> {
    path: Vec<PathStep<'static>>,
    at: &'a mut dyn FnMut(&[PathStep<'static>], FieldRef<'_>),
}

impl FieldTraversal<'_> {
    fn leaf(&mut self, name: &'static str, leaf: FieldRef<'_>) {
        self.path.push((name, None));
        (self.at)(&self.path, leaf);
        self.path.pop();
    }

    fn enter(&mut self, step: PathStep<'static>, fields: &mut dyn Fields) {
        self.path.push(step);
        fields.visit(self);
        self.path.pop();
    }
}

impl FieldVisitor for FieldTraversal<'_> {
    fn number(&mut self, name: &'static str, value: &mut f32, _: RangeInclusive<f32>, _: &'static str) {
        self.leaf(name, FieldRef::Number(value));
    }

    fn integer(&mut self, name: &'static str, value: &mut u32, _: RangeInclusive<u32>, _: &'static str) {
        self.leaf(name, FieldRef::Whole(value));
    }

    fn vector(&mut self, name: &'static str, value: &mut Vec3, _: RangeInclusive<f32>, _: &'static str) {
        self.leaf(name, FieldRef::Vector(value));
    }

    fn curve(&mut self, name: &'static str, value: &mut Curve, _: RangeInclusive<f32>) {
        self.leaf(name, FieldRef::Curve(value));
    }

    fn flag(&mut self, name: &'static str, value: &mut bool) {
        self.leaf(name, FieldRef::Flag(value));
    }

    fn choice(&mut self, name: &'static str, value: &mut dyn Choice) {
        self.leaf(name, FieldRef::Choice(value));
    }

    fn text(&mut self, name: &'static str, value: &mut String) {
        self.leaf(name, FieldRef::Text(value));
    }

    fn image(&mut self, name: &'static str, value: &mut String, _: ImageRole) {
        self.leaf(name, FieldRef::Text(value));
    }

    fn particles(&mut self, name: &'static str, value: &mut String) {
        self.leaf(name, FieldRef::Text(value));
    }

    fn backdrop(&mut self, name: &'static str, value: &mut String, _: BackdropKind) {
        self.leaf(name, FieldRef::Text(value));
    }

    fn seed(&mut self, name: &'static str, value: &mut u32) {
        self.leaf(name, FieldRef::Whole(value));
    }

    fn group(&mut self, name: &'static str, fields: &mut dyn Fields) {
        self.enter((name, None), fields);
    }

    fn item(&mut self, name: &'static str, index: usize, fields: &mut dyn Fields) {
        self.enter((name, Some(index)), fields);
    }
}
