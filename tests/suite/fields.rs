//! Completeness of field traversals: they visit every field that a preset or recipe file may hold.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::collections::BTreeSet;
use std::ops::RangeInclusive;

use haze::glam::Vec3;
use haze::{Light, Settings};
use haze_author::noise_recipe::NoiseRecipe;
use haze_author::ramp::RampRecipe;
use haze_author::ramp::motif::MotifRecipe;
use haze_author::sprite::bake::SpriteRecipe;
use haze_core::settings::{BackdropKind, Choice, Curve, FieldVisitor, Fields, ImageRole};
use haze_preset::{Preset, PresetSystem};
use serde_json::Value;

/// Paths of all fields that a traversal visits.
#[derive(Default)]
struct VisitedFields {
    path: Vec<String>,
    fields: BTreeSet<String>,
}

impl VisitedFields {
    fn field(&mut self, name: &str) {
        let path = [&self.path[..], &[name.to_owned()]].concat().join(".");
        assert!(self.fields.insert(path.clone()), "{path} is visited twice");
    }

    fn nested(&mut self, step: String, fields: &mut dyn Fields) {
        self.path.push(step);
        fields.visit(self);
        self.path.pop();
    }
}

impl FieldVisitor for VisitedFields {
    fn number(&mut self, name: &'static str, value: &mut f32, range: RangeInclusive<f32>, _: &'static str) {
        assert!(range.contains(value), "{name}: the default is out of its range");
        self.field(name);
    }
    fn integer(&mut self, name: &'static str, value: &mut u32, range: RangeInclusive<u32>, _: &'static str) {
        assert!(range.contains(value), "{name}: the default is out of its range");
        self.field(name);
    }
    fn vector(&mut self, name: &'static str, _: &mut Vec3, _: RangeInclusive<f32>, _: &'static str) {
        self.field(name);
    }
    fn curve(&mut self, name: &'static str, _: &mut Curve, _: RangeInclusive<f32>) {
        self.field(name);
    }
    fn srgb(&mut self, name: &'static str, _: &mut [u8; 3]) {
        self.field(name);
    }
    fn flag(&mut self, name: &'static str, _: &mut bool) {
        self.field(name);
    }
    fn choice(&mut self, name: &'static str, value: &mut dyn Choice) {
        let was = value.index();
        for index in 0..value.names().len() {
            value.set_index(index);
            assert_eq!(value.index(), index, "{name}");
        }
        value.set_index(usize::MAX);
        assert_eq!(value.index(), value.names().len() - 1, "{name}: an index beyond the last gives the last choice");
        value.set_index(was);
        self.field(name);
    }
    fn text(&mut self, name: &'static str, _: &mut String) {
        self.field(name);
    }
    fn image(&mut self, name: &'static str, _: &mut String, _: ImageRole) {
        self.field(name);
    }
    fn particles(&mut self, name: &'static str, _: &mut String) {
        self.field(name);
    }
    fn backdrop(&mut self, name: &'static str, _: &mut String, _: BackdropKind) {
        self.field(name);
    }
    fn seed(&mut self, name: &'static str, _: &mut u32) {
        self.field(name);
    }
    fn group(&mut self, name: &'static str, fields: &mut dyn Fields) {
        self.nested(name.to_owned(), fields);
    }
    fn item(&mut self, name: &'static str, index: usize, fields: &mut dyn Fields) {
        self.nested(format!("{name}.{index}"), fields);
    }
}

/// Collects the paths of all fields in a file. A list of numbers, or of points, is one field.
fn written(value: &Value, path: &str, fields: &mut BTreeSet<String>) {
    let join = |name: &str| if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") };
    match value {
        Value::Object(entries) => entries.iter().for_each(|(name, value)| written(value, &join(name), fields)),
        Value::Array(items) if !items.iter().all(|item| item.is_number() || item.is_array()) || items.is_empty() => {
            items.iter().enumerate().for_each(|(index, value)| written(value, &join(&index.to_string()), fields));
        }
        _ => {
            fields.insert(path.to_owned());
        }
    }
}

/// Returns the fields that are only visited, and the fields that are only written.
fn missing_fields(value: &mut (impl Fields + serde::Serialize)) -> (Vec<String>, Vec<String>) {
    let json = serde_json::to_value(&*value).unwrap();
    let mut visited = VisitedFields::default();
    let mut file = BTreeSet::new();
    value.visit(&mut visited);
    written(&json, "", &mut file);
    assert!(file.len() > 2);
    assert_eq!(json, serde_json::to_value(&*value).unwrap(), "the traversal changes the values");
    (visited.fields.difference(&file).cloned().collect(), file.difference(&visited.fields).cloned().collect())
}

#[test]
fn every_field_of_every_file_is_visited() {
    let none = (Vec::new(), Vec::new());
    let mut preset = Preset {
        lights: vec![Light::default(), Light::default()],
        systems: vec![PresetSystem::default()],
        ..Preset::default()
    };
    assert_eq!(missing_fields(&mut preset), none);
    let file = |name: &str| std::fs::read_to_string(format!("{}/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap();
    let recipe = |name| file(name);
    let puff: SpriteRecipe = serde_json::from_str(&recipe("sprites/puff.sprite.json")).unwrap();
    // Unused fields are not written, so this recipe uses all fields.
    let mut used = SpriteRecipe { length: 0.1, upright: 0.1, lumps: 0.1, travel: 0.1, tolerance: 1, ..puff };
    assert_eq!(missing_fields(&mut used), none);
    assert_eq!(
        missing_fields(&mut serde_json::from_str::<NoiseRecipe>(&recipe("sprites/fbm.noise.json")).unwrap()),
        none
    );
    assert_eq!(
        missing_fields(&mut serde_json::from_str::<RampRecipe>(&recipe("tests/corpus/ramp/good_rich")).unwrap()),
        none
    );
    assert_eq!(
        missing_fields(&mut serde_json::from_str::<MotifRecipe>(&recipe("ramps/motif_studio.motif.json")).unwrap()),
        none
    );
}

#[test]
fn a_forgotten_field_is_detected() {
    /// A traversal that leaves out all fields of `Settings` but `boost`.
    #[derive(serde::Serialize)]
    struct Forgetful(Settings);
    impl Fields for Forgetful {
        fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
            visitor.number("boost", &mut self.0.boost, 0.0..=16.0, "");
            visitor.number("bost", &mut self.0.boost, 0.0..=16.0, "");
        }
    }
    let (invented, left_out) = missing_fields(&mut Forgetful(Settings::default()));
    assert_eq!(invented, ["bost"]);
    assert!(left_out.contains(&"soft_fade.fade_scale".to_owned()) && left_out.len() > 30, "{left_out:?}");
}
