//! What differs between two presets: names for the steps of undo, marks, and copying across.

use haze::preset::Preset;
use haze::settings::{Value, path_of, values, walk};

/// The paths of the fields that differ, `systems[0].settings.boost`. Where lists are not as long as each other the list is one
/// field, `lights`.
pub fn changed_fields(before: &Preset, after: &Preset) -> Vec<String> {
    let lengths = [before, after].map(|preset| [preset.lights.len(), preset.systems.len()]);
    let lists: Vec<_> = (0..2).filter(|&list| lengths[0][list] != lengths[1][list]).map(|list| LISTS[list]).collect();
    let in_list = |path: &str| lists.iter().any(|list| is_below(path, list));
    let alone = |preset| -> Vec<_> { values(preset).into_iter().filter(|(path, _)| !in_list(path)).collect() };
    let pairs = alone(before).into_iter().zip(alone(after));
    let changed = pairs.filter(|(before, after)| before != after).map(|((path, _), _)| path);
    changed.chain(lists.iter().map(|&list| list.to_owned())).collect()
}

/// The lists of a preset.
const LISTS: [&str; 2] = ["lights", "systems"];

/// Whether a field is `above`, or in it.
fn is_below(path: &str, above: &str) -> bool {
    path.strip_prefix(above).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
}

/// Gives `to` what `from` has at a path: a field, a group, an item of a list, or a whole list. What only one of them has is left.
pub fn copy_field(from: &Preset, to: &mut Preset, path: &str) {
    match path {
        "lights" => to.lights.clone_from(&from.lights),
        "systems" => to.systems.clone_from(&from.systems),
        _ => {
            let values = values(from).into_iter().filter(|(field, _)| is_below(field, path));
            let values: std::collections::HashMap<String, Value> = values.collect();
            walk(to, &mut |path, leaf| {
                if let Some(value) = values.get(&path_of(path)) {
                    leaf.set(value);
                }
            });
        }
    }
}

/// A name for a step between two presets: "boost of smoke", "colour of light 2", "3 fields of smoke", "light added".
pub fn step_name(before: &Preset, after: &Preset) -> String {
    let changed = changed_fields(before, after);
    let Some(first) = changed.first() else { return "change".into() };
    let owner = owner_of(first);
    let of = match owner.as_ref().map(|(list, index)| (*list, after.systems.get(*index), index + 1)) {
        Some(("systems", Some(system), _)) if !system.name.is_empty() => format!(" of {}", system.name),
        Some((list, _, number)) => format!(" of {} {number}", singular(list)),
        None => String::new(),
    };
    let lengths =
        |preset: &Preset, list: &str| if list == LISTS[0] { preset.lights.len() } else { preset.systems.len() };
    match changed.as_slice() {
        [list] if LISTS.contains(&list.as_str()) => {
            let is_more = lengths(after, list) > lengths(before, list);
            format!("{} {}", singular(list), if is_more { "added" } else { "removed" })
        }
        [field] => format!("{}{of}", field.rsplit('.').next().unwrap_or(field)),
        fields if fields.iter().all(|field| owner_of(field) == owner) => format!("{} fields{of}", fields.len()),
        fields => format!("{} fields", fields.len()),
    }
}

/// The list and place that a field is in: `systems[1].name` gives `systems` and 1.
fn owner_of(path: &str) -> Option<(&str, usize)> {
    let (list, rest) = path.split_once('[')?;
    let (index, _) = rest.split_once(']')?;
    Some((list, index.parse().ok()?))
}

fn singular(list: &str) -> &str {
    list.trim_end_matches('s')
}
