//! Traversal of every field of a settings struct, with the path that leads to it.

use std::fmt::Write as _;
use std::ops::RangeInclusive;

use glam::Vec3;

use super::choice::Choice;
use super::fields::{FieldVisitor, Fields, ImageRole};

/// Name on the path to a field, and its index if it is in a list.
pub type Step<'a> = (&'a str, Option<usize>);

/// Reference to a field.
pub enum Leaf<'a> {
    /// Real number.
    Number(&'a mut f32),
    /// Whole number, or a seed.
    Whole(&'a mut u32),
    /// Three numbers, or linear RGB.
    Vector(&'a mut Vec3),
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
pub enum Value {
    /// Value of a [`Leaf::Number`].
    Number(f32),
    /// Value of a [`Leaf::Whole`].
    Whole(u32),
    /// Value of a [`Leaf::Vector`].
    Vector(Vec3),
    /// Value of a [`Leaf::Flag`].
    Flag(bool),
    /// Name of the choice of a [`Leaf::Choice`].
    Choice(&'static str),
    /// Value of a [`Leaf::Text`].
    Text(String),
}

impl PartialEq for Value {
    fn eq(&self, other: &Self) -> bool {
        let same =
            |a: f32, b: f32| a.partial_cmp(&b).is_some_and(std::cmp::Ordering::is_eq) || a.is_nan() && b.is_nan();
        match (self, other) {
            (Self::Number(a), Self::Number(b)) => same(*a, *b),
            (Self::Vector(a), Self::Vector(b)) => (0..3).all(|axis| same(a[axis], b[axis])),
            (Self::Whole(a), Self::Whole(b)) => a == b,
            (Self::Flag(a), Self::Flag(b)) => a == b,
            (Self::Choice(a), Self::Choice(b)) => a == b,
            (Self::Text(a), Self::Text(b)) => a == b,
            _ => false,
        }
    }
}

impl Leaf<'_> {
    /// Returns the current value.
    pub fn value(&self) -> Value {
        match self {
            Self::Number(value) => Value::Number(**value),
            Self::Whole(value) => Value::Whole(**value),
            Self::Vector(value) => Value::Vector(**value),
            Self::Flag(value) => Value::Flag(**value),
            Self::Choice(value) => Value::Choice(value.names().get(value.index()).copied().unwrap_or_default()),
            Self::Text(value) => Value::Text((*value).clone()),
        }
    }

    /// Sets the value. A value of another kind, or an unknown name, changes nothing.
    pub fn set(self, value: &Value) {
        match (self, value) {
            (Self::Number(field), Value::Number(value)) => *field = *value,
            (Self::Whole(field), Value::Whole(value)) => *field = *value,
            (Self::Vector(field), Value::Vector(value)) => *field = *value,
            (Self::Flag(field), Value::Flag(value)) => *field = *value,
            (Self::Text(field), Value::Text(value)) => field.clone_from(value),
            (Self::Choice(field), Value::Choice(name)) => {
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
pub fn for_each_field(settings: &mut dyn Fields, at: &mut dyn FnMut(&[Step<'static>], Leaf<'_>)) {
    settings.visit(&mut FieldTraversal { path: Vec::new(), at });
}

/// Path, as [`field_path`] formats it, and value of every field.
pub fn values<T: Fields + Clone>(settings: &T) -> Vec<(String, Value)> {
    let mut values = Vec::new();
    for_each_field(&mut settings.clone(), &mut |path, leaf| values.push((field_path(path), leaf.value())));
    values
}

/// Formats a path: `systems[0].settings.boost`.
pub fn field_path(path: &[Step<'_>]) -> String {
    let mut text = String::new();
    for (name, index) in path {
        let dot = if text.is_empty() { "" } else { "." };
        let _ = match index {
            Some(index) => write!(text, "{dot}{name}[{index}]"),
            None => write!(text, "{dot}{name}"),
        };
    }
    text
}

struct FieldTraversal<'a> {
    path: Vec<Step<'static>>,
    at: &'a mut dyn FnMut(&[Step<'static>], Leaf<'_>),
}

impl FieldTraversal<'_> {
    fn leaf(&mut self, name: &'static str, leaf: Leaf<'_>) {
        self.path.push((name, None));
        (self.at)(&self.path, leaf);
        self.path.pop();
    }

    fn enter(&mut self, step: Step<'static>, fields: &mut dyn Fields) {
        self.path.push(step);
        fields.visit(self);
        self.path.pop();
    }
}

impl FieldVisitor for FieldTraversal<'_> {
    fn number(&mut self, name: &'static str, value: &mut f32, _: RangeInclusive<f32>, _: &'static str) {
        self.leaf(name, Leaf::Number(value));
    }

    fn integer(&mut self, name: &'static str, value: &mut u32, _: RangeInclusive<u32>, _: &'static str) {
        self.leaf(name, Leaf::Whole(value));
    }

    fn vector(&mut self, name: &'static str, value: &mut Vec3, _: RangeInclusive<f32>, _: &'static str) {
        self.leaf(name, Leaf::Vector(value));
    }

    fn flag(&mut self, name: &'static str, value: &mut bool) {
        self.leaf(name, Leaf::Flag(value));
    }

    fn choice(&mut self, name: &'static str, value: &mut dyn Choice) {
        self.leaf(name, Leaf::Choice(value));
    }

    fn text(&mut self, name: &'static str, value: &mut String) {
        self.leaf(name, Leaf::Text(value));
    }

    fn picture(&mut self, name: &'static str, value: &mut String, _: ImageRole) {
        self.leaf(name, Leaf::Text(value));
    }

    fn particles(&mut self, name: &'static str, value: &mut String) {
        self.leaf(name, Leaf::Text(value));
    }

    fn seed(&mut self, name: &'static str, value: &mut u32) {
        self.leaf(name, Leaf::Whole(value));
    }

    fn group(&mut self, name: &'static str, fields: &mut dyn Fields) {
        self.enter((name, None), fields);
    }

    fn item(&mut self, name: &'static str, index: usize, fields: &mut dyn Fields) {
        self.enter((name, Some(index)), fields);
    }
}
