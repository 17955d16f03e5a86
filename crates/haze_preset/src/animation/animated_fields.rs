//! Tracks with the fields that they change, found once so that no frame compares names.

use std::collections::HashMap;
use std::ops::RangeInclusive;

use haze_core::glam::Vec3;
use haze_core::settings::{BackdropKind, Choice, Curve, FieldVisitor, Fields, ImageRole, PathStep, write_field_path};

use super::interpolation::Kind;
use super::keyframe::KeyValue;
use super::track::Track;

/// Field that a track can change, or any other.
pub(super) enum AnimatedField<'a> {
    Number(&'a mut f32, RangeInclusive<f32>),
    Whole(&'a mut u32, RangeInclusive<u32>),
    Vector(&'a mut Vec3, RangeInclusive<f32>),
    Direction(&'a mut Vec3, RangeInclusive<f32>),
    Color(&'a mut Vec3, RangeInclusive<f32>),
    Flag(&'a mut bool),
    Choice(&'a mut dyn Choice),
    /// Texts, images, curves and seeds have no tracks.
    Other,
}

impl AnimatedField<'_> {
    pub(super) fn kind(&self) -> Option<Kind> {
        match self {
            Self::Number(..) | Self::Whole(..) | Self::Vector(..) | Self::Color(..) => Some(Kind::Linear),
            Self::Direction(..) => Some(Kind::Direction),
            Self::Flag(_) | Self::Choice(_) => Some(Kind::Step),
            Self::Other => None,
        }
    }

    /// True for fields that flicker: those whose half and double make sense.
    pub(super) fn flickers(&self) -> bool {
        matches!(self, Self::Number(..) | Self::Color(..))
    }

    /// True for a value of this field's type.
    pub(super) fn accepts(&self, value: &KeyValue) -> bool {
        match self {
            Self::Number(..) | Self::Whole(..) => matches!(value, KeyValue::Number(_)),
            Self::Vector(..) | Self::Direction(..) | Self::Color(..) => matches!(value, KeyValue::Vector(_)),
            Self::Flag(_) => matches!(value, KeyValue::Flag(_)),
            Self::Choice(choice) => matches!(value, KeyValue::Choice(name) if choice.names().contains(&name.as_str())),
            Self::Other => false,
        }
    }

    /// Description of the values that the field accepts.
    pub(super) fn expected(&self) -> String {
        match self {
            Self::Number(..) | Self::Whole(..) => "a number".into(),
            Self::Vector(..) | Self::Direction(..) | Self::Color(..) => "a list of 3 numbers".into(),
            Self::Flag(_) => "true or false".into(),
            Self::Choice(choice) => format!("one of {}", choice.names().join(", ")),
            Self::Other => "no value".into(),
        }
    }

    /// Sets the value, multiplied by the factor of a flicker. `is_clamped`: brings it into the range. A value of another
    /// type changes nothing.
    pub(super) fn set(self, value: &KeyValue, factor: f32, is_clamped: bool) {
        let within = |value: f32, range: &RangeInclusive<f32>| {
            if is_clamped { value.max(*range.start()).min(*range.end()) } else { value }
        };
        match (self, value) {
            (Self::Number(field, range), KeyValue::Number(number)) => *field = within(number * factor, &range),
            (Self::Whole(field, range), KeyValue::Number(number)) => {
                // `as` brings numbers outside of u32 to its ends.
                let whole = number.round() as u32;
                *field = if is_clamped { whole.max(*range.start()).min(*range.end()) } else { whole };
            }
            (
                Self::Vector(field, range) | Self::Direction(field, range) | Self::Color(field, range),
                KeyValue::Vector(vector),
            ) => *field = vector.to_array().map(|axis| within(axis * factor, &range)).into(),
            (Self::Flag(field), KeyValue::Flag(flag)) => *field = *flag,
            (Self::Choice(choice), KeyValue::Choice(name)) => {
                if let Some(index) = choice.names().iter().position(|other| other == name) {
                    choice.set_index(index);
                }
            }
            _ => {}
        }
    }

    fn value(&self) -> Option<KeyValue> {
        Some(match self {
            Self::Number(number, _) => KeyValue::Number(**number),
            Self::Color(vector, _) => KeyValue::Vector(**vector),
            _ => return None,
        })
    }
}

/// Calls `at` for every field in the order of the struct, with the steps that lead to it.
pub(super) fn for_each_animated_field(
    fields: &mut dyn Fields,
    at: &mut dyn FnMut(&[PathStep<'static>], AnimatedField<'_>),
) {
    fields.visit(&mut Traversal { path: [("", None); MAX_DEPTH], depth: 0, at });
}

/// Tracks, each with the field that it changes.
#[derive(Clone, Debug)]
pub(crate) struct AnimatedFields {
    /// In the order of the fields.
    tracks: Vec<FoundTrack>,
}

#[derive(Clone, Debug)]
struct FoundTrack {
    /// Number of fields before the track's.
    field: usize,
    track: Track,
    kind: Kind,
    flickers: bool,
    /// The setting's own value, which flickers if there are no keyframes.
    own: Option<KeyValue>,
}

impl FoundTrack {
    /// Value at a time without flicker.
    fn value(&self, time: f64) -> Option<KeyValue> {
        self.track.value(time, self.kind).or_else(|| self.own.clone())
    }

    fn flicker(&self, time: f64, has_flicker: bool) -> f32 {
        if has_flicker && self.flickers { self.track.flicker_factor(time) } else { 1.0 }
    }
}

impl AnimatedFields {
    /// Finds the fields of the tracks. Tracks of unknown fields are left out.
    pub(crate) fn new(tracks: &[Track], fields: &mut dyn Fields) -> Self {
        if tracks.is_empty() {
            return Self { tracks: Vec::new() };
        }
        let by_setting: HashMap<&str, &Track> = tracks.iter().map(|track| (track.setting.as_str(), track)).collect();
        let mut found = Vec::new();
        let mut index = 0;
        let mut name = String::new();
        for_each_animated_field(fields, &mut |path, field| {
            write_field_path(path, &mut name);
            if let Some((track, kind)) = by_setting.get(name.as_str()).copied().zip(field.kind()) {
                let flickers = field.flickers();
                let own = field.value();
                found.push(FoundTrack { field: index, track: track.clone(), kind, flickers, own });
            }
            index += 1;
        });
        Self { tracks: found }
    }

    /// Sets the fields to their values at a time. Their ranges are kept. Needs no memory of the heap, except for choices.
    pub(crate) fn write(&self, time: f64, has_flicker: bool, fields: &mut dyn Fields) {
        self.write_values(time, Writing { has_flicker, is_clamped: true }, None, fields);
    }

    /// Sets the fields to their values at a time, outside of their ranges too, but one field to the value of a keyframe.
    pub(super) fn write_keyframe(&self, setting: &str, time: f32, value: &KeyValue, fields: &mut dyn Fields) {
        let writing = Writing { has_flicker: false, is_clamped: false };
        self.write_values(f64::from(time), writing, Some((setting, value)), fields);
    }

    /// True if the setting of the first track can flicker.
    pub(crate) fn flickers(&self) -> bool {
        self.tracks.first().is_some_and(|found| found.flickers)
    }

    /// Values of the first track at some times, of any range.
    pub(crate) fn values(&self, has_flicker: bool, times: &[f32]) -> Vec<KeyValue> {
        let value = |found: &FoundTrack, time| {
            let factor = found.flicker(time, has_flicker);
            Some(match found.value(time)? {
                KeyValue::Number(number) => KeyValue::Number(number * factor),
                KeyValue::Vector(vector) => KeyValue::Vector(vector * factor),
                value => value,
            })
        };
        let found = self.tracks.first();
        times.iter().filter_map(|&time| value(found?, f64::from(time))).collect()
    }

    fn write_values(
        &self,
        time: f64,
        Writing { has_flicker, is_clamped }: Writing,
        instead: Option<(&str, &KeyValue)>,
        fields: &mut dyn Fields,
    ) {
        if self.tracks.is_empty() {
            return;
        }
        let mut rest = self.tracks.iter().peekable();
        let mut index = 0;
        for_each_animated_field(fields, &mut |_, field| {
            if let Some(found) = rest.next_if(|found| found.field == index) {
                let given = instead.filter(|(setting, _)| *setting == found.track.setting);
                let value = given.map(|(_, value)| value.clone()).or_else(|| found.value(time));
                if let Some(value) = value {
                    field.set(&value, found.flicker(time, has_flicker), is_clamped);
                }
            }
            index += 1;
        });
    }
}

/// Way in which values are written.
#[derive(Clone, Copy)]
struct Writing {
    /// Adds the flicker of tracks.
    has_flicker: bool,
    /// Keeps the ranges of the fields.
    is_clamped: bool,
}

/// Maximum nesting depth. No preset comes near it.
const MAX_DEPTH: usize = 8;

struct Traversal<'a> {
    path: [PathStep<'static>; MAX_DEPTH],
    depth: usize,
    at: &'a mut dyn FnMut(&[PathStep<'static>], AnimatedField<'_>),
}

impl Traversal<'_> {
    fn field(&mut self, name: &'static str, field: AnimatedField<'_>) {
        if self.depth < MAX_DEPTH {
            self.path[self.depth] = (name, None);
            (self.at)(&self.path[..=self.depth], field);
        }
    }

    fn enter(&mut self, step: PathStep<'static>, fields: &mut dyn Fields) {
        if self.depth < MAX_DEPTH {
            self.path[self.depth] = step;
            self.depth += 1;
            fields.visit(self);
            self.depth -= 1;
        }
    }

    /// True for the time and the version of the preset, which are no settings of the look.
    fn is_fixed(&self, name: &str) -> bool {
        self.depth == 0 && matches!(name, "time" | "version")
    }
}

impl FieldVisitor for Traversal<'_> {
    fn number(&mut self, name: &'static str, value: &mut f32, range: RangeInclusive<f32>, _: &'static str) {
        let field = if self.is_fixed(name) { AnimatedField::Other } else { AnimatedField::Number(value, range) };
        self.field(name, field);
    }

    fn integer(&mut self, name: &'static str, value: &mut u32, range: RangeInclusive<u32>, _: &'static str) {
        let field = if self.is_fixed(name) { AnimatedField::Other } else { AnimatedField::Whole(value, range) };
        self.field(name, field);
    }

    /// A vector without unit is a direction.
    fn vector(&mut self, name: &'static str, value: &mut Vec3, range: RangeInclusive<f32>, unit: &'static str) {
        let field =
            if unit.is_empty() { AnimatedField::Direction(value, range) } else { AnimatedField::Vector(value, range) };
        self.field(name, field);
    }

    fn color(&mut self, name: &'static str, value: &mut Vec3, range: RangeInclusive<f32>) {
        self.field(name, AnimatedField::Color(value, range));
    }

    fn flag(&mut self, name: &'static str, value: &mut bool) {
        self.field(name, AnimatedField::Flag(value));
    }

    fn choice(&mut self, name: &'static str, value: &mut dyn Choice) {
        self.field(name, AnimatedField::Choice(value));
    }

    fn curve(&mut self, name: &'static str, _: &mut Curve, _: RangeInclusive<f32>) {
        self.field(name, AnimatedField::Other);
    }

    fn text(&mut self, name: &'static str, _: &mut String) {
        self.field(name, AnimatedField::Other);
    }

    fn image(&mut self, name: &'static str, _: &mut String, _: ImageRole) {
        self.field(name, AnimatedField::Other);
    }

    fn particles(&mut self, name: &'static str, _: &mut String) {
        self.field(name, AnimatedField::Other);
    }

    fn backdrop(&mut self, name: &'static str, _: &mut String, _: BackdropKind) {
        self.field(name, AnimatedField::Other);
    }

    fn seed(&mut self, name: &'static str, _: &mut u32) {
        self.field(name, AnimatedField::Other);
    }

    fn group(&mut self, name: &'static str, fields: &mut dyn Fields) {
        self.enter((name, None), fields);
    }

    fn item(&mut self, name: &'static str, index: usize, fields: &mut dyn Fields) {
        self.enter((name, Some(index)), fields);
    }
}
