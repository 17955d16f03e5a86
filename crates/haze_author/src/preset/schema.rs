//! JSON schema of preset files: the structs as serde reads them, with the ranges that `Fields` checks.

use std::ops::RangeInclusive;

use glam::Vec3;
use serde_json::{Value, json};

use haze_core::frame::Light;
use haze_core::settings::{Curve, FieldVisitor, Fields, MAX_CURVE_POINTS};
use haze_preset::{Camera, Flicker, Preset, PresetSystem};

/// Returns the JSON schema of preset files.
pub fn schema() -> String {
    let mut schema = schemars::schema_for!(Preset).to_value();
    let mut preset = preset_with_widest_ranges();
    preset.visit(&mut RangeWriter { schema: &mut schema, definition: String::new() });
    // Tracks are no settings of the preset, and are not visited with them.
    Flicker::default().visit(&mut RangeWriter { schema: &mut schema, definition: "/$defs/Flicker".into() });
    write_floats_as_f32(&mut schema);
    serde_json::to_string_pretty(&schema).unwrap_or_default()
}

/// Preset with one of each part, whose ranges are listed. If a range starts at another field's value, that value makes
/// it the widest.
pub(super) fn preset_with_widest_ranges() -> Preset {
    Preset {
        camera: Camera { near: 0.001, ..Camera::default() },
        lights: vec![Light { inner_angle: 0.0, ..Light::default() }],
        systems: vec![PresetSystem::default()],
        ..Preset::default()
    }
}

/// Writes defaults as f32, not as the nearest f64.
fn write_floats_as_f32(value: &mut Value) {
    match value {
        Value::Array(items) => items.iter_mut().for_each(write_floats_as_f32),
        Value::Object(entries) => entries.values_mut().for_each(write_floats_as_f32),
        Value::Number(number) if number.is_f64() => *value = decimal(number.as_f64().unwrap_or_default() as f32),
        _ => {}
    }
}

/// Writes the range of every visited number into the definition of its struct.
struct RangeWriter<'a> {
    schema: &'a mut Value,
    /// JSON pointer to the struct being visited; "" is the preset itself.
    definition: String,
}

impl RangeWriter<'_> {
    fn property(&mut self, name: &str) -> Option<&mut Value> {
        self.schema.pointer_mut(&format!("{}/properties/{name}", self.definition))
    }

    /// Visits a struct that a field refers to.
    fn enter(&mut self, name: &str, fields: &mut dyn Fields) {
        let reference = self.property(name).and_then(|property| property["$ref"].as_str());
        if let Some(definition) = reference.and_then(|path| path.strip_prefix('#')).map(str::to_owned) {
            fields.visit(&mut RangeWriter { schema: self.schema, definition });
        }
    }

    fn limit(&mut self, name: &str, item: &str, minimum: Value, maximum: Value) {
        if let Some(property) = self.property(&format!("{name}{item}")) {
            property["minimum"] = minimum;
            // JSON has no infinity.
            if !maximum.is_null() {
                property["maximum"] = maximum;
            }
        }
    }
}

/// Shortest decimal that reads back as the same f32.
fn decimal(number: f32) -> Value {
    number.to_string().parse::<f64>().map_or(Value::Null, |number| json!(number))
}

impl FieldVisitor for RangeWriter<'_> {
    fn number(&mut self, name: &'static str, _: &mut f32, range: RangeInclusive<f32>, _: &'static str) {
        self.limit(name, "", decimal(*range.start()), decimal(*range.end()));
    }

    fn integer(&mut self, name: &'static str, _: &mut u32, range: RangeInclusive<u32>, _: &'static str) {
        self.limit(name, "", json!(range.start()), json!(range.end()));
    }

    fn vector(&mut self, name: &'static str, _: &mut Vec3, range: RangeInclusive<f32>, _: &'static str) {
        self.limit(name, "/items", decimal(*range.start()), decimal(*range.end()));
    }

    fn curve(&mut self, name: &'static str, _: &mut Curve, range: RangeInclusive<f32>) {
        if let Some(property) = self.property(name) {
            property["minItems"] = json!(1);
            property["maxItems"] = json!(MAX_CURVE_POINTS);
            let x = json!({ "type": "number", "minimum": 0, "maximum": 1 });
            let value = json!({ "type": "number", "minimum": range.start(), "maximum": range.end() });
            property["items"]["prefixItems"] = json!([x, value]);
        }
    }

    fn group(&mut self, name: &'static str, fields: &mut dyn Fields) {
        self.enter(name, fields);
    }

    fn item(&mut self, name: &'static str, _: usize, fields: &mut dyn Fields) {
        self.enter(&format!("{name}/items"), fields);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_reach_nested_structs() {
        let schema: Value = serde_json::from_str(&schema()).unwrap();
        let property = |path: &str| schema.pointer(&format!("/$defs/{path}")).unwrap_or_else(|| panic!("{path}"));
        assert_eq!(property("SoftFade/properties/fade_scale")["minimum"], 0.001);
        assert_eq!(property("Accumulate/properties/downscale")["maximum"], 16);
        assert_eq!(property("Light/properties/color/items")["maximum"], 100.0);
        assert_eq!(property("Light/properties/outer_angle")["minimum"], 0.0);
        assert_eq!(property("Flicker/properties/rate")["maximum"], 60.0);
        assert_eq!(property("Track/properties/period")["maximum"], 1.0e5);
        assert_eq!(property("KeyValue")["anyOf"].as_array().map(Vec::len), Some(4));
        assert!(property("Upsample").to_string().contains("nearest_depth"));
    }
}
