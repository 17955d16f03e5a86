//! Presets as text: only what differs from the defaults, in the order of the documentation, so that moving one slider
//! changes one line.

use std::collections::HashMap;

use haze_core::frame::Light;
use haze_core::settings::{FieldValue, PathStep, for_each_field};
use serde::{Serialize, Serializer};

use super::animation::Track;
use super::preset_file::{Preset, PresetSystem};

/// Fields that are always written, because they say what the file is.
const ALWAYS: &[&str] = &["version", "name", "kind"];

impl Preset {
    /// Formats this preset, which must be valid, as JSON that [`Preset::parse`] reads back, ending with a line break.
    /// Fields at their defaults are left out, unless they are in `old`, the text to be replaced, or "".
    ///
    /// JSON has no infinity: the largest number replaces it.
    pub fn to_json(&self, old: &str) -> String {
        let old = serde_json::from_str(old).unwrap_or_default();
        let lists = (vec![Light::default()], vec![PresetSystem::default()]);
        let mut default_preset = Self { lights: lists.0, systems: lists.1, ..Self::default() };
        let mut defaults = HashMap::new();
        for_each_field(&mut default_preset, &mut |path, leaf| {
            defaults.insert(names_without_indices(path), leaf.value());
        });
        let mut root = Vec::new();
        for_each_field(&mut self.clone(), &mut |path, leaf| {
            let value = leaf.value();
            let is_always = path.last().is_some_and(|(name, _)| ALWAYS.contains(name));
            if is_always || is_present_in(&old, path) || defaults.get(&names_without_indices(path)) != Some(&value) {
                insert(&mut root, path, finite(value));
            }
        });
        if !self.animation.is_empty() {
            root.push(("animation", Node::Tracks(self.animation.clone())));
        }
        // A tree of numbers and texts with texts as names: serialisation cannot fail.
        serde_json::to_string_pretty(&Node::Object(root)).unwrap_or_default() + "\n"
    }
}

/// Names without list indices, because every light has the same defaults.
fn names_without_indices(path: &[PathStep<'static>]) -> Vec<&'static str> {
    path.iter().map(|step| step.0).collect()
}

fn is_present_in(old: &serde_json::Value, path: &[PathStep<'static>]) -> bool {
    let mut at = Some(old);
    for (name, index) in path {
        at = at.and_then(|old| old.get(name));
        if let Some(index) = index {
            at = at.and_then(|old| old.get(index));
        }
    }
    at.is_some()
}

fn finite(value: FieldValue) -> FieldValue {
    match value {
        FieldValue::Number(number) => FieldValue::Number(number.clamp(f32::MIN, f32::MAX)),
        value => value,
    }
}

/// JSON that keeps the order of its fields.
enum Node {
    FieldValue(FieldValue),
    Object(Vec<(&'static str, Node)>),
    List(Vec<Node>),
    Tracks(Vec<Track>),
}

impl Serialize for Node {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::FieldValue(value) => value.serialize(serializer),
            Self::Object(fields) => serializer.collect_map(fields.iter().map(|(name, node)| (name, node))),
            Self::List(nodes) => serializer.collect_seq(nodes),
            Self::Tracks(tracks) => tracks.serialize(serializer),
        }
    }
}

fn insert(fields: &mut Vec<(&'static str, Node)>, path: &[PathStep<'static>], value: FieldValue) {
    let [(name, index), rest @ ..] = path else { return };
    if rest.is_empty() {
        fields.push((name, Node::FieldValue(value)));
        return;
    }
    // Fields come in order, so a name that is not the last one is new.
    if fields.last().is_none_or(|(last, _)| last != name) {
        let new = if index.is_some() { Node::List(Vec::new()) } else { Node::Object(Vec::new()) };
        fields.push((name, new));
    }
    let item = match fields.last_mut() {
        Some((_, Node::List(items))) => {
            let index = index.unwrap_or_default();
            items.resize_with(items.len().max(index + 1), || Node::Object(Vec::new()));
            items.get_mut(index)
        }
        last => last.map(|(_, node)| node),
    };
    if let Some(Node::Object(fields)) = item {
        insert(fields, rest, value);
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use proptest::prelude::*;

    use super::*;
    use crate::builtin;
    use haze_core::assets::json;
    use haze_core::settings::FieldRef;

    #[test]
    fn shipped_presets_are_formatted_as_they_are_written() {
        for shipped in builtin::PRESETS {
            let (preset, text) = Preset::load_with_source(shipped.name).unwrap();
            let written = preset.to_json(&text);
            for (at, (written, shipped_line)) in (1..).zip(written.lines().zip(text.lines())) {
                assert_eq!(written, shipped_line, "{}:{at}", shipped.name);
            }
            assert_eq!(written, text);
            assert_eq!(Preset::parse(Path::new("a.json"), &preset.to_json("")).unwrap(), preset);
        }
    }

    #[test]
    fn every_field_is_written_and_read_back() {
        let mut default_preset = Preset::load("column").unwrap();
        default_preset.lights.push(Light::default());
        default_preset.systems.push(PresetSystem::default());
        let mut count = 0;
        for_each_field(&mut default_preset.clone(), &mut |_, _| count += 1);
        for moved in 0..count {
            let mut preset = default_preset.clone();
            let mut at = 0;
            for_each_field(&mut preset, &mut |path, leaf| {
                if at == moved && path[0].0 != "version" {
                    match leaf {
                        FieldRef::Number(value) => *value = 0.1234567,
                        FieldRef::Whole(value) => *value = u32::MAX,
                        FieldRef::Vector(value) => value.z = -1.0e-7,
                        FieldRef::Curve(value) => *value = "0.1:0.3".parse().unwrap(),
                        FieldRef::Flag(value) => *value = !*value,
                        FieldRef::Choice(value) => value.set_index((value.index() + 1) % value.names().len()),
                        FieldRef::Text(value) => value.push_str("\"\\\n\u{1}ü"),
                    }
                }
                at += 1;
            });
            let text = preset.to_json("");
            let read: Preset = json::parse(Path::new("a.json"), &text).unwrap();
            assert_eq!(read, preset, "field {moved}");
            // Fields of the old text stay, even if they are at their default again.
            let kept = default_preset.to_json(&text);
            assert!(kept.lines().count() >= text.lines().count(), "field {moved}: {kept}");
            assert_eq!(Preset::parse(Path::new("a.json"), &kept).unwrap(), default_preset);
        }
        assert!(count > 100, "{count}");
    }

    #[test]
    fn infinity_is_written_as_the_largest_number() {
        let preset = Preset { lights: vec![Light { range: f32::INFINITY, ..Light::default() }], ..Preset::default() };
        let read = Preset::parse(Path::new("a.json"), &preset.to_json("")).unwrap();
        assert_eq!(read.lights[0].range.to_bits(), f32::MAX.to_bits());
    }

    proptest! {
        /// Except for the sign of a zero, which is written like any other default: not at all.
        #[test]
        fn numbers_round_trip_to_the_last_bit(bits: u32) {
            let number = f32::from_bits(bits);
            prop_assume!(number.is_finite());
            let lights = vec![Light { intensity: number, ..Light::default() }];
            let preset = Preset { lights, ..Preset::default() };
            let read: Preset = json::parse(Path::new("a.json"), &preset.to_json("")).unwrap();
            prop_assert_eq!((read.lights[0].intensity + 0.0).to_bits(), (number + 0.0).to_bits());
        }
    }
}
