//! Doc comments of fields and choices, at run time.

use serde_json::Value;

/// Doc comments of a settings struct, by the dotted paths of [`FieldVisitor`](haze_core::settings::FieldVisitor), such as
/// `soft_fade.fade_scale`. Fields in lists have no index: `lights.range`.
#[derive(Clone, Debug)]
pub struct Tooltips {
    schema: Value,
}

impl Tooltips {
    /// Doc comments of `T` and everything in it.
    pub fn of<T: schemars::JsonSchema>() -> Self {
        Self { schema: schemars::schema_for!(T).to_value() }
    }

    /// Doc comment of a field.
    pub fn field(&self, path: &str) -> Option<&str> {
        self.property(path)?["description"].as_str()
    }

    /// Doc comment of one choice of a field. `name` is the one that presets use; `path` is "" if `T` itself is an enum.
    pub fn choice(&self, path: &str, name: &str) -> Option<&str> {
        let choices = self.resolve(self.property(path)?)["oneOf"].as_array()?;
        let choice = choices.iter().find(|choice| choice["const"] == name)?;
        choice["description"].as_str()
    }

    fn property(&self, path: &str) -> Option<&Value> {
        let mut at = &self.schema;
        for name in path.split('.').filter(|name| !name.is_empty()) {
            at = self.resolve(at).get("properties")?.get(name)?;
        }
        Some(at)
    }

    /// Struct or enum that a field holds, or holds a list of.
    fn resolve<'a>(&'a self, value: &'a Value) -> &'a Value {
        let value = value.get("items").unwrap_or(value);
        let pointer = value.get("$ref").and_then(Value::as_str).and_then(|reference| reference.strip_prefix('#'));
        pointer.and_then(|pointer| self.schema.pointer(pointer)).unwrap_or(value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use haze_core::settings::{BackdropKind, Choice, FieldVisitor, Fields, ImageRole};
    use haze_preset::{Preset, PresetSystem};
    use std::ops::RangeInclusive;

    /// Visits a preset as a user interface would, and asks for every tooltip.
    struct Panel<'a> {
        tooltips: &'a Tooltips,
        path: Vec<&'static str>,
        rows: usize,
    }

    impl Panel<'_> {
        fn row(&mut self, name: &'static str) -> String {
            let path = [&self.path[..], &[name]].concat().join(".");
            let tooltip = self.tooltips.field(&path);
            assert!(tooltip.is_some_and(|text| text.len() > 4), "{path} has no tooltip");
            self.rows += 1;
            path
        }

        fn nested(&mut self, name: &'static str, fields: &mut dyn Fields) {
            self.row(name);
            self.path.push(name);
            fields.visit(self);
            self.path.pop();
        }
    }

    impl FieldVisitor for Panel<'_> {
        fn number(&mut self, name: &'static str, _: &mut f32, _: RangeInclusive<f32>, _: &'static str) {
            self.row(name);
        }
        fn integer(&mut self, name: &'static str, _: &mut u32, _: RangeInclusive<u32>, _: &'static str) {
            self.row(name);
        }
        fn vector(&mut self, name: &'static str, _: &mut Vec3, _: RangeInclusive<f32>, _: &'static str) {
            self.row(name);
        }
        fn flag(&mut self, name: &'static str, _: &mut bool) {
            self.row(name);
        }
        fn choice(&mut self, name: &'static str, value: &mut dyn Choice) {
            let path = self.row(name);
            for choice in value.names() {
                assert!(self.tooltips.choice(&path, choice).is_some(), "{path}: {choice} has no tooltip");
            }
        }
        fn text(&mut self, name: &'static str, _: &mut String) {
            self.row(name);
        }
        fn image(&mut self, name: &'static str, _: &mut String, _: ImageRole) {
            self.row(name);
        }
        fn particles(&mut self, name: &'static str, _: &mut String) {
            self.row(name);
        }
        fn backdrop(&mut self, name: &'static str, _: &mut String, _: BackdropKind) {
            self.row(name);
        }
        fn seed(&mut self, name: &'static str, _: &mut u32) {
            self.row(name);
        }
        fn group(&mut self, name: &'static str, fields: &mut dyn Fields) {
            self.nested(name, fields);
        }
        fn item(&mut self, name: &'static str, _: usize, fields: &mut dyn Fields) {
            self.nested(name, fields);
        }
    }

    #[test]
    fn every_field_and_choice_of_a_preset_has_its_tooltip() {
        let tooltips = Tooltips::of::<Preset>();
        let mut preset = Preset {
            lights: vec![haze_core::frame::Light::default()],
            systems: vec![PresetSystem::default()],
            ..Preset::default()
        };
        let mut panel = Panel { tooltips: &tooltips, path: Vec::new(), rows: 0 };
        preset.visit(&mut panel);
        assert!(panel.rows > 100, "{} rows", panel.rows);
        assert_eq!(
            tooltips.field("systems.settings.boost"),
            Some("Multiplies the accumulated amount into coverage. Higher: smoke hides the scene sooner. OTEE uses 3.")
        );
        assert_eq!(tooltips.field("systems.settings.boots"), None);
        assert_eq!(tooltips.choice("lights.kind", "laser"), None);
        let stages = Tooltips::of::<haze_core::settings::DebugView>();
        assert_eq!(
            stages.choice("", "amount"),
            Some("Accumulated amount of all systems, as white smoke: gray over black.")
        );
    }
}
