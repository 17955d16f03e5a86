//! Keyframe of a track: a time, a value, and the way to the next one.

use std::fmt;

use haze_core::glam::Vec3;
use serde::de::{Deserialize, Deserializer, SeqAccess, Visitor};

use haze_core::settings::{FieldValue, choice};

choice! {
    /// Course of a value from one keyframe to the next.
    Ease {
        /// Smooth through the keyframes, without overshoot. Rests at the first, at the last, and where the value turns back.
        #[default]
        Smooth = "smooth",
        /// At a constant rate.
        Linear = "linear",
        /// Slow at first.
        EaseIn = "ease_in",
        /// Slow at the end.
        EaseOut = "ease_out",
        /// Stays until the next keyframe, then jumps.
        Hold = "hold",
    }
}

/// Value of a keyframe. In JSON: `2.5`, `[1, 0.5, 0.2]`, `true` or `"raster"`.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(untagged)]
pub enum KeyValue {
    /// Number. Whole numbers are rounded.
    Number(f32),
    /// Position, direction, size, or linear RGB.
    Vector(#[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))] Vec3),
    /// Switch.
    Flag(bool),
    /// Name of a choice.
    Choice(String),
}

impl KeyValue {
    /// Value of a field; `None` for texts and curves, which have no keyframes.
    pub fn from_field(value: &FieldValue) -> Option<Self> {
        Some(match value {
            FieldValue::Number(number) => Self::Number(*number),
            FieldValue::Whole(number) => Self::Number(*number as f32),
            FieldValue::Vector(vector) => Self::Vector(*vector),
            FieldValue::Flag(flag) => Self::Flag(*flag),
            FieldValue::Choice(name) => Self::Choice((*name).into()),
            FieldValue::Curve(_) | FieldValue::Text(_) => return None,
        })
    }

    pub(super) fn is_finite(&self) -> bool {
        match self {
            Self::Number(number) => number.is_finite(),
            Self::Vector(vector) => vector.is_finite(),
            Self::Flag(_) | Self::Choice(_) => true,
        }
    }
}

impl<'de> Deserialize<'de> for KeyValue {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(KeyValueVisitor)
    }
}

struct KeyValueVisitor;

impl<'de> Visitor<'de> for KeyValueVisitor {
    type Value = KeyValue;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number, a list of 3 numbers, true, false, or the name of a choice")
    }

    fn visit_f64<E>(self, number: f64) -> Result<KeyValue, E> {
        Ok(KeyValue::Number(number as f32))
    }

    fn visit_u64<E>(self, number: u64) -> Result<KeyValue, E> {
        Ok(KeyValue::Number(number as f32))
    }

    fn visit_i64<E>(self, number: i64) -> Result<KeyValue, E> {
        Ok(KeyValue::Number(number as f32))
    }

    fn visit_bool<E>(self, flag: bool) -> Result<KeyValue, E> {
        Ok(KeyValue::Flag(flag))
    }

    fn visit_str<E>(self, name: &str) -> Result<KeyValue, E> {
        Ok(KeyValue::Choice(name.into()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<KeyValue, A::Error> {
        let mut axes = [0.0; 3];
        for (index, axis) in axes.iter_mut().enumerate() {
            let next = list.next_element()?;
            *axis = next.ok_or_else(|| serde::de::Error::invalid_length(index, &"a list of 3 numbers"))?;
        }
        Ok(KeyValue::Vector(axes.into()))
    }
}

/// Largest time of a preset and of a keyframe, before or after the start, and longest period, seconds.
pub const MAX_TIME: f32 = 1.0e5;

/// A value at a time.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Keyframe {
    /// Time, seconds since the start of emission. Later than the keyframe before it.
    #[cfg_attr(feature = "schema", schemars(range(min = -MAX_TIME, max = MAX_TIME)))]
    pub time: f32,
    /// Value at this time, of the setting's type and in its range.
    pub value: KeyValue,
    /// Course of the value from here to the next keyframe. Switches and choices always hold.
    #[serde(default, skip_serializing_if = "is_default")]
    pub ease: Ease,
}

pub(super) fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}
