//! Names that fields and groups had before. Files, keyframes and links that have them still open.

use serde_json::{Map, Value};

/// Field that has another name now.
struct RenamedField {
    /// Struct of the field.
    owner: &'static str,
    /// Name before it in a path.
    group: &'static str,
    old: &'static str,
    new: &'static str,
}

const RENAMED_FIELDS: [RenamedField; 2] = [
    RenamedField { owner: "Accumulate", group: "accumulate", old: "scale", new: "downscale" },
    RenamedField { owner: "Emitter", group: "emitter", old: "small_share", new: "small_fraction" },
];

/// Group that has another name now.
struct RenamedGroup {
    /// Struct of the group. `PresetSystem`, which serde reads, has an alias too.
    owner: &'static str,
    old: &'static str,
    new: &'static str,
}

/// No field has the old name of a group, unless the field comes last in its path.
const RENAMED_GROUPS: [RenamedGroup; 2] = [
    RenamedGroup { owner: "Settings", old: "density", new: "exponential" },
    RenamedGroup { owner: "PresetSystem", old: "cache", new: "particle_files" },
];

/// Field that is in another group of the same struct now. No other field has its old name.
pub(super) struct MovedField {
    /// Struct of the group that had it.
    old_owner: &'static str,
    /// Name of the group that had it.
    old_group: &'static str,
    pub(super) old: &'static str,
    /// Group that has it now.
    pub(super) group: &'static str,
    pub(super) new: &'static str,
}

impl MovedField {
    const fn from_sprite_to_debug(old: &'static str, new: &'static str) -> Self {
        Self { old_owner: "SpriteSettings", old_group: "sprite", old, group: "debug", new }
    }
}

const MOVED_FIELDS: [MovedField; 3] = [
    MovedField::from_sprite_to_debug("debug_sprite", "checkerboard"),
    MovedField::from_sprite_to_debug("debug_loop", "draw_count"),
    MovedField::from_sprite_to_debug("freeze_animation", "freeze_animation"),
];

/// Returns today's name of a field or a group of the struct `owner`.
pub(super) fn current_name<'a>(owner: &str, name: &'a str) -> &'a str {
    let field = RENAMED_FIELDS.iter().find(|field| field.owner == owner && field.old == name);
    let group = RENAMED_GROUPS.iter().find(|group| group.owner == owner && group.old == name);
    field.map(|field| field.new).or(group.map(|group| group.new)).unwrap_or(name)
}

/// Finds a field that has left the struct `owner`.
pub(super) fn find_moved_field(owner: &str, name: &str) -> Option<&'static MovedField> {
    MOVED_FIELDS.iter().find(|field| field.old_owner == owner && field.old == name)
}

/// Returns the path of a field with today's names.
pub fn current_path(path: &str) -> String {
    let mut steps: Vec<_> = path.split('.').collect();
    let last = steps.pop().unwrap_or_default();
    let group = steps.last().copied();
    let moved =
        MOVED_FIELDS.iter().find(|field| field.old == last && group.is_none_or(|group| group == field.old_group));
    if let Some(field) = moved {
        steps.pop();
        steps.extend([field.group, field.new]);
    } else {
        let renamed = RENAMED_FIELDS.iter().find(|field| Some(field.group) == group && field.old == last);
        for step in &mut steps {
            if let Some(group) = RENAMED_GROUPS.iter().find(|group| group.old == *step) {
                *step = group.new;
            }
        }
        steps.push(renamed.map_or(last, |field| field.new));
    }
    steps.join(".")
}

/// Gives all fields and groups in a JSON value their names of today.
pub fn rename_old_keys(value: &mut Value) {
    match value {
        Value::Object(fields) => {
            rename_groups(fields);
            move_fields(fields);
            for (group, value) in fields {
                if let Value::Object(fields) = value {
                    for renamed in RENAMED_FIELDS.iter().filter(|renamed| renamed.group == group) {
                        if let Some(value) = fields.remove(renamed.old) {
                            fields.insert(renamed.new.into(), value);
                        }
                    }
                }
                rename_old_keys(value);
            }
        }
        Value::Array(items) => items.iter_mut().for_each(rename_old_keys),
        _ => {}
    }
}

fn rename_groups(fields: &mut Map<String, Value>) {
    for group in &RENAMED_GROUPS {
        if fields.get(group.old).is_some_and(Value::is_object) {
            let value = fields.remove(group.old).unwrap_or_default();
            fields.insert(group.new.into(), value);
        }
    }
}

fn move_fields(fields: &mut Map<String, Value>) {
    for moved in &MOVED_FIELDS {
        let old_group = fields.get_mut(moved.old_group).and_then(Value::as_object_mut);
        let Some(value) = old_group.and_then(|group| group.remove(moved.old)) else { continue };
        let group = fields.entry(moved.group).or_insert_with(|| Value::Object(Map::new()));
        if let Value::Object(group) = group {
            group.insert(moved.new.into(), value);
        }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::settings::{Exponential, Settings, SpriteSettings, set_field};

    fn read(text: &str) -> Result<Settings, String> {
        serde_json::from_str(text).map_err(|error| error.to_string())
    }

    #[test]
    fn old_names_are_read_in_files() {
        assert_eq!(read(r#"{"accumulate": {"scale": 4}}"#).unwrap().accumulate.downscale, 4);
        let error = read(r#"{"accumulate": {"scale": 4, "downscale": 2}}"#).unwrap_err();
        assert!(error.contains("duplicate field `downscale`"), "{error}");
        assert!(read(r#"{"sprite": {"scale": 4}}"#).is_err());
        let read_density = read(r#"{"density": {"density": 4}}"#).unwrap().exponential;
        assert_eq!(read_density, Exponential { density: 4.0 });
        let error = read(r#"{"density": {"density": 4}, "exponential": {}}"#).unwrap_err();
        assert!(error.contains("duplicate field `exponential`"), "{error}");
    }

    #[test]
    fn fields_that_moved_are_read_in_the_group_that_had_them() {
        let old =
            r#"{"sprite": {"debug_loop": 3, "size": 2, "debug_sprite": true, "freeze_animation": true}, "boost": 4}"#;
        let now = r#"{"sprite": {"size": 2}, "debug": {"checkerboard": true, "draw_count": 3, "freeze_animation": true}, "boost": 4}"#;
        let settings = read(old).unwrap();
        assert_eq!(settings, read(now).unwrap());
        assert_eq!((settings.debug.draw_count, settings.sprite.size, settings.boost), (3, 2.0, 4.0));
        for (text, problem) in [
            (r#"{"sprite": {"debug_loop": 3}, "debug": {}}"#, "duplicate field `debug`"),
            (r#"{"debug": {}, "sprite": {"debug_loop": 3}}"#, "duplicate field `debug`"),
            (r#"{"sprite": {"debug_loop": 3, "debug_loop": 4}}"#, "duplicate field `debug_loop`"),
            (r#"{"sprite": {"debug_loop": true}}"#, "debug: invalid type: boolean `true`, expected u32"),
            (r#"{"grain": {"debug_loop": 3}}"#, "unknown field `debug_loop`"),
            (r#"{"debug": {"debug_loop": 3}}"#, "unknown field `debug_loop`"),
        ] {
            let error = read(text).unwrap_err();
            assert!(error.contains(problem), "{text}: {error}");
        }
        assert!(serde_json::from_str::<SpriteSettings>(r#"{"debug_loop": 3}"#).is_err());
    }

    #[test]
    fn old_names_are_read_in_paths() {
        let mut settings = Settings::default();
        let mut set = |path, value| set_field(&mut settings, path, value).unwrap();
        assert_eq!(set("accumulate.scale", "8"), "accumulate.downscale");
        assert_eq!(set("density.density", "5"), "exponential.density");
        assert_eq!(set("sprite.debug_loop", "6"), "debug.draw_count");
        assert_eq!(set("debug_sprite", "true"), "debug.checkerboard");
        assert_eq!(settings.accumulate.downscale, 8);
        assert_eq!(settings.exponential, Exponential { density: 5.0 });
        assert_eq!(settings.debug.draw_count, 6);
        assert!(settings.debug.checkerboard);
        for (old, now) in [
            ("systems[0].settings.accumulate.scale", "systems[0].settings.accumulate.downscale"),
            ("systems[1].settings.density.density", "systems[1].settings.exponential.density"),
            ("systems.settings.sprite.freeze_animation", "systems.settings.debug.freeze_animation"),
            ("systems[0].cache.flipbook_rate", "systems[0].particle_files.flipbook_rate"),
            ("cache.up", "particle_files.up"),
            ("environment.scale", "environment.scale"),
            ("shadow.density", "shadow.density"),
            ("density", "density"),
            ("grain.debug_loop", "grain.debug_loop"),
        ] {
            assert_eq!(current_path(old), now);
            assert_eq!(current_path(now), now);
        }
    }

    #[test]
    fn old_names_are_read_in_values() {
        let accumulate = json!({ "scale": 2, "scale_mode": "auto" });
        let sprite = json!({ "size": 2, "debug_sprite": true, "debug_loop": 3 });
        let settings = json!({ "accumulate": accumulate, "density": { "density": 4 }, "sprite": sprite });
        let mut value = json!({ "systems": [{ "cache": { "up": "z" }, "settings": settings }] });
        rename_old_keys(&mut value);
        let settings = json!({
            "accumulate": { "downscale": 2, "scale_mode": "auto" },
            "exponential": { "density": 4 },
            "sprite": { "size": 2 },
            "debug": { "checkerboard": true, "draw_count": 3 },
        });
        let now = json!({ "systems": [{ "particle_files": { "up": "z" }, "settings": settings }] });
        assert_eq!(value, now);
        rename_old_keys(&mut value);
        assert_eq!(value, now);
    }
}
