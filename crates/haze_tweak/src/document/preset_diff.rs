//! Differences between two presets: names of undo steps, marks of changed fields, and copies of fields.

use std::collections::{HashMap, HashSet};

use haze_core::settings::{FieldValue, field_path, field_values, for_each_field};
use haze_preset::{Preset, PresetSystem, Track};

use super::display_names::{display_name, sentence_case};
use super::keyframes::track;
use super::light_defaults::light_name;

/// Returns the paths of the fields that differ, or whose tracks do, such as `systems[0].settings.boost`. A list whose length
/// differs counts as one field, such as `lights`.
pub fn changed_fields(before: &Preset, after: &Preset) -> Vec<String> {
    let pairs = lists(before).into_iter().zip(lists(after));
    let lists: Vec<_> = pairs.filter(|(before, after)| before != after).map(|((list, _), _)| list).collect();
    let is_whole = |path: &str| !lists.iter().any(|list| is_below(path, list));
    let fields = |preset| field_values(preset).into_iter().filter(|(path, _)| is_whole(path)).collect::<Vec<_>>();
    let pairs = fields(before).into_iter().zip(fields(after));
    let mut changed: Vec<_> = pairs.filter(|(before, after)| before != after).map(|((path, _), _)| path).collect();
    changed.extend(lists.iter().map(|&list| list.to_owned()));
    let tracks = before.animation.iter().chain(&after.animation);
    for path in tracks.map(|track| &track.setting).filter(|path| is_whole(path)) {
        if track(before, path) != track(after, path) && !changed.contains(path) {
            changed.push(path.clone());
        }
    }
    changed
}

/// Returns the lists of a preset and their lengths.
fn lists(preset: &Preset) -> [(&'static str, usize); 2] {
    [("lights", preset.lights.len()), ("systems", preset.systems.len())]
}

/// Returns true if a path is `above` or lies below it.
fn is_below(path: &str, above: &str) -> bool {
    path.strip_prefix(above).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
}

/// Copies the values and the tracks at a path: a field, a group, an item of a list, or a whole list. Fields that only one
/// preset has are skipped.
pub fn copy_field(from: &Preset, to: &mut Preset, path: &str) {
    copy_values(from, to, path);
    copy_tracks(from, to, path);
}

fn copy_tracks(from: &Preset, to: &mut Preset, path: &str) {
    let has_field: HashSet<_> = field_values(to).into_iter().map(|(path, _)| path).collect();
    let at_path = |track: &&Track| is_below(&track.setting, path) && has_field.contains(&track.setting);
    to.animation.retain(|track| !is_below(&track.setting, path));
    to.animation.extend(from.animation.iter().filter(at_path).cloned());
    // With the same tracks, their order is the same too.
    let is_same = from.animation.iter().all(|its| track(to, &its.setting) == Some(its));
    if is_same && from.animation.len() == to.animation.len() {
        to.animation.clone_from(&from.animation);
    }
}

fn copy_values(from: &Preset, to: &mut Preset, path: &str) {
    match path {
        "lights" => to.lights.clone_from(&from.lights),
        "systems" => to.systems.clone_from(&from.systems),
        _ => {
            let values = field_values(from).into_iter().filter(|(field, _)| is_below(field, path));
            let values: HashMap<String, FieldValue> = values.collect();
            for_each_field(to, &mut |path, leaf| {
                if let Some(value) = values.get(&field_path(path)) {
                    leaf.set(value);
                }
            });
        }
    }
}

/// Fields that a camera move changes.
const MOVES: [&str; 2] = ["camera.position", "camera.target"];

/// Returns a name for the step between two presets: "Boost of smoke", "Color of Sun 2", "Camera", "3 settings of smoke",
/// "Light added".
pub fn step_name(before: &Preset, after: &Preset) -> String {
    let mut changed = changed_fields(before, after);
    if after.lights.len() < before.lights.len() {
        // The lamp goes with the light that it holds.
        changed.retain(|path| path != "environment.lamp");
    }
    let Some(first) = changed.first() else { return "Change".into() };
    let owner = owner_of(first);
    let of = of_owner(after, first);
    let length = |preset| lists(preset).into_iter().find(|(list, _)| list == first).map(|(_, length)| length);
    match changed.as_slice() {
        [list] if length(before) < length(after) => format!("{} added", sentence_case(singular(list))),
        [list] if length(before) > length(after) => format!("{} removed", sentence_case(singular(list))),
        fields if fields.iter().all(|field| MOVES.contains(&field.as_str())) => "Camera".into(),
        fields if is_move(fields, before, after) => "System moved".into(),
        fields if moves_sun(fields) => "Sun and sky".into(),
        [field] => format!("{}{of}", display_name(field.rsplit('.').next().unwrap_or(field))),
        fields if fields.iter().all(|field| owner_of(field) == owner) => format!("{} settings{of}", fields.len()),
        fields => format!("{} settings", fields.len()),
    }
}

/// True if fields are those of systems that have only changed their positions.
fn is_move(fields: &[String], before: &Preset, after: &Preset) -> bool {
    let before = &before.systems;
    let after = &after.systems;
    if before == after || !fields.iter().all(|field| field.starts_with("systems[")) {
        return false;
    }
    let count = |list: &[PresetSystem], system| list.iter().filter(|other| *other == system).count();
    before.len() == after.len() && before.iter().all(|system| count(before, system) == count(after, system))
}

/// True if fields are those of a time of day.
fn moves_sun(fields: &[String]) -> bool {
    let has = |ending: &str| fields.iter().any(|field| field.ends_with(ending));
    has("environment.horizon") && has(".direction")
}

/// Returns the name of a setting with that of its light or system: "Boost of smoke", "Shadow: Strength of smoke".
pub fn setting_title(preset: &Preset, path: &str) -> String {
    let mut names = path.rsplit('.');
    let name = names.next().unwrap_or(path);
    let group = names.next().unwrap_or_default();
    let is_plain = group.contains('[') || ["", "settings", "emitter", "camera"].contains(&group);
    let group = if is_plain { String::new() } else { format!("{}: ", display_name(group)) };
    format!("{group}{}{}", display_name(name), of_owner(preset, path))
}

/// Returns " of " and the name of the light or system that a field belongs to.
fn of_owner(preset: &Preset, path: &str) -> String {
    let of = owner_of(path).map(|(list, index)| match (list, preset.systems.get(index), preset.lights.get(index)) {
        ("systems", Some(system), _) if !system.name.is_empty() => format!(" of {}", system.name),
        ("lights", _, Some(light)) => format!(" of {}", light_name(index, light)),
        _ => format!(" of {} {}", singular(list), index + 1),
    });
    of.unwrap_or_default()
}

/// Returns the list and the index that a field belongs to: `systems[1].name` gives `systems` and 1.
fn owner_of(path: &str) -> Option<(&str, usize)> {
    let (list, rest) = path.split_once('[')?;
    let (index, _) = rest.split_once(']')?;
    Some((list, index.parse().ok()?))
}

fn singular(list: &str) -> &str {
    list.trim_end_matches('s')
}

#[cfg(test)]
mod tests {
    use haze::{Light, Settings};

    use super::*;
    use crate::document::keyframes::add_key;

    fn changed_by(change: impl Fn(&mut Preset)) -> (Vec<String>, String) {
        let before = Preset::load("column").unwrap();
        let mut after = before.clone();
        change(&mut after);
        let name = step_name(&before, &after);
        let changed = changed_fields(&before, &after);
        // Copied one by one, all fields become equal.
        let mut copied = before.clone();
        changed.iter().for_each(|path| copy_field(&after, &mut copied, path));
        assert_eq!(changed_fields(&copied, &after), [""; 0]);
        let mut back = after.clone();
        changed.iter().for_each(|path| copy_field(&before, &mut back, path));
        assert_eq!(back, before);
        (changed, name)
    }

    #[test]
    fn changes_are_named() {
        let said = |change: fn(&mut Preset)| {
            let (changed, name) = changed_by(change);
            (changed.join(" "), name)
        };
        let expect = |said: (String, String), fields: &str, name: &str| assert_eq!(said, (fields.into(), name.into()));
        expect(said(|_| {}), "", "Change");
        expect(said(|preset| preset.systems[0].settings.boost = 2.0), "systems[0].settings.boost", "Boost of smoke");
        expect(said(|preset| preset.lights[1].color.x = 0.0), "lights[1].color", "Color of Fill (Sun 2)");
        expect(said(|preset| preset.camera.exposure = 2.0), "camera.exposure", "Exposure");
        expect(said(|preset| preset.camera.target.x += 1.0), "camera.target", "Camera");
        expect(said(|preset| preset.lights.push(Light::default())), "lights", "Light added");
        let dusk = |preset: &mut Preset| (preset.environment.horizon.x, preset.lights[1].direction.y) = (0.5, 0.5);
        expect(said(dusk), "environment.horizon lights[1].direction", "Sun and sky");
        expect(said(|preset| preset.lights.truncate(2)), "lights", "Light removed");
        expect(said(|preset| preset.systems.push(PresetSystem::default())), "systems", "System added");
        let two = |swaps: bool| {
            let mut preset = Preset::load("campfire").unwrap();
            if swaps {
                preset.systems.reverse();
            }
            preset
        };
        assert_eq!(step_name(&two(false), &two(true)), "System moved");
        expect(
            said(|preset| (preset.lights[1].color.x, preset.lights[1].intensity) = (0.0, 0.0)),
            "lights[1].color lights[1].intensity",
            "2 settings of Fill (Sun 2)",
        );
        expect(said(|preset| (preset.time, preset.camera.fov) = (0.0, 20.0)), "time camera.fov", "2 settings");
        // A NaN counts as a change once, and not in every frame.
        let nan = |preset: &mut Preset| preset.systems[0].settings.boost = f32::NAN;
        let mut preset = Preset::load("column").unwrap();
        assert_eq!(
            changed_fields(&Preset::load("column").unwrap(), &{
                nan(&mut preset);
                preset.clone()
            })
            .len(),
            1
        );
        assert_eq!(changed_fields(&preset, &preset), [""; 0]);
    }

    #[test]
    fn a_change_of_keyframes_is_a_change_of_their_setting() {
        let change = |preset: &mut Preset| {
            add_key(preset, "lights[1].color", 1.0);
            add_key(preset, "camera.exposure", 1.0);
        };
        let (mut changed, name) = changed_by(change);
        changed.sort_unstable();
        assert_eq!((changed.join(" ").as_str(), name.as_str()), ("camera.exposure lights[1].color", "2 settings"));
        let (_, name) = changed_by(|preset| add_key(preset, "lights[1].color", 1.0));
        assert_eq!(name, "Color of Fill (Sun 2)");
        let preset = Preset::load("column").unwrap();
        assert_eq!(setting_title(&preset, "systems[0].settings.shadow.strength"), "Shadow: Strength of smoke");
        assert_eq!(setting_title(&preset, "camera.exposure"), "Exposure");
    }

    #[test]
    fn copying_a_group_or_item_changes_nothing_else() {
        let from = Preset::load("backlit_fog").unwrap();
        let before = Preset::load("column").unwrap();
        let mut to = before.clone();
        copy_field(&from, &mut to, "systems[0].settings");
        assert_eq!(to.systems[0].settings, from.systems[0].settings);
        to.systems[0].settings = before.systems[0].settings;
        assert_eq!(to, before);
        copy_field(&from, &mut to, "lights[1]");
        assert_eq!(to.lights[1], from.lights[1]);
        to.lights[1] = before.lights[1];
        // Only one of the presets has it, or none.
        copy_field(&from, &mut to, "lights[3].color");
        copy_field(&from, &mut to, "systems[0].settings.boos");
        assert_eq!(to, before);
        assert_ne!(from.systems[0].settings, Settings::default());
    }
}
