//! Edits of a preset's list of systems. Tracks of their settings follow.

use haze_core::error::FieldError;

use super::animation::Track;
use super::preset_file::{MAX_SYSTEMS, Preset, PresetSystem};

/// Adds a system at the end. Its name is changed if another system has it.
///
/// # Errors
/// If the preset has [`MAX_SYSTEMS`] systems, or is not valid with one more. The preset then stays as it was.
pub(super) fn add(preset: &mut Preset, system: PresetSystem) -> Result<(), FieldError> {
    insert(preset, preset.systems.len(), system)
}

/// Inserts a copy of a system after it, with copies of its tracks.
///
/// # Errors
/// If the preset has [`MAX_SYSTEMS`] systems, or is not valid with one more. The preset then stays as it was.
pub fn duplicate(preset: &mut Preset, index: usize) -> Result<(), FieldError> {
    let Some(system) = preset.systems.get(index).cloned() else { return Ok(()) };
    let mut changed = preset.clone();
    insert(&mut changed, index + 1, system)?;
    let copies = changed.animation.iter().filter(|track| system_of(&track.setting) == Some(index));
    let copies: Vec<_> = copies.map(|track| with_system(track, index + 1)).collect();
    changed.animation.extend(copies);
    changed.validate()?;
    *preset = changed;
    Ok(())
}

/// Removes a system and its tracks.
pub fn remove(preset: &mut Preset, index: usize) {
    if index < preset.systems.len() {
        preset.systems.remove(index);
        renumber(&mut preset.animation, |position| {
            (position != index).then(|| position - usize::from(position > index))
        });
    }
}

/// Moves a system to another index.
pub fn move_to(preset: &mut Preset, from: usize, to: usize) {
    let count = preset.systems.len();
    if from < count && to < count {
        let system = preset.systems.remove(from);
        preset.systems.insert(to, system);
        let mut positions: Vec<_> = (0..count).collect();
        let moved = positions.remove(from);
        positions.insert(to, moved);
        renumber(&mut preset.animation, |index| positions.iter().position(|position| *position == index));
    }
}

/// Removes all systems but one.
pub fn keep_only(preset: &mut Preset, index: usize) {
    for other in (0..preset.systems.len()).rev().filter(|other| *other != index) {
        remove(preset, other);
    }
}

/// Finds a system by its name, or by its number, counted from 0. `option`: the argument that has the name, for the error.
///
/// # Errors
/// [`FieldError`] with the names that exist.
pub fn find(preset: &Preset, option: &str, name: &str) -> Result<usize, FieldError> {
    let by_name = preset.systems.iter().position(|system| system.name == name);
    let by_number = || name.parse().ok().filter(|index| *index < preset.systems.len());
    by_name.or_else(by_number).ok_or_else(|| {
        let names: Vec<_> = preset.systems.iter().map(|system| format!("{:?}", system.name)).collect();
        let one_of = format!("one of {}", names.join(", "));
        let expected = if names.is_empty() { "a preset with systems".into() } else { one_of };
        FieldError::new(option, format!("{name:?}"), expected)
    })
}

/// Index of the system that a setting belongs to: 1 for `systems[1].settings.boost`.
pub fn system_of(setting: &str) -> Option<usize> {
    setting.strip_prefix("systems[")?.split_once(']')?.0.parse().ok()
}

fn insert(preset: &mut Preset, index: usize, mut system: PresetSystem) -> Result<(), FieldError> {
    if preset.systems.len() >= MAX_SYSTEMS {
        let problem = format!("the preset has {MAX_SYSTEMS} systems");
        return Err(FieldError::from_problem("systems", problem, format!("at most {MAX_SYSTEMS}")));
    }
    system.name = free_name(preset, &system.name);
    let mut changed = preset.clone();
    renumber(&mut changed.animation, |position| Some(position + usize::from(position >= index)));
    changed.systems.insert(index, system);
    changed.validate()?;
    *preset = changed;
    Ok(())
}

/// Returns a name that no system has: "sparks", "sparks 2".
fn free_name(preset: &Preset, name: &str) -> String {
    let is_taken = |name: &str| preset.systems.iter().any(|system| system.name == name);
    if !is_taken(name) {
        return name.into();
    }
    let numbered = name.rsplit_once(' ').filter(|(_, number)| number.parse::<u32>().is_ok());
    let stem = numbered.map_or(name, |(stem, _)| stem);
    // One more than there can be systems, so one is free.
    let mut names = (2..MAX_SYSTEMS + 3).map(|number| format!("{stem} {number}"));
    names.find(|name| !is_taken(name)).unwrap_or_else(|| name.into())
}

/// Gives the tracks of systems the new positions of their systems; those of a system without a position are removed.
fn renumber(tracks: &mut Vec<Track>, position: impl Fn(usize) -> Option<usize>) {
    tracks.retain_mut(|track| {
        let Some(index) = system_of(&track.setting) else { return true };
        let Some(position) = position(index) else { return false };
        *track = with_system(track, position);
        true
    });
}

/// Returns the track for the same setting of another system.
fn with_system(track: &Track, index: usize) -> Track {
    let field = track.setting.split_once(']').map_or("", |(_, field)| field);
    Track { setting: format!("systems[{index}]{field}"), ..track.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{KeyValue, Keyframe, layers};

    /// Three systems with a track each, and a track of the camera.
    fn preset() -> Preset {
        let mut preset = Preset::load("campfire").unwrap();
        layers::find_layer("LAYER", "smoke").unwrap().add_at(&mut preset, haze_core::glam::Vec3::X).unwrap();
        let track = |setting: &str, value: f32| {
            let keys = vec![Keyframe { time: 0.0, value: KeyValue::Number(value), ease: Default::default() }];
            Track { setting: setting.into(), keys, ..Track::default() }
        };
        preset.animation.push(track("camera.exposure", 1.0));
        for (index, boost) in [1.0, 2.0, 3.0].into_iter().enumerate() {
            preset.animation.push(track(&format!("systems[{index}].settings.boost"), boost));
        }
        preset.validate().unwrap();
        preset
    }

    /// Name and animated boost of each system.
    fn systems(preset: &Preset) -> Vec<(String, f32)> {
        preset.validate().unwrap();
        let now = preset.evaluate(0.0);
        now.systems.into_iter().map(|system| (system.name, system.settings.boost)).collect()
    }

    fn expect(preset: &Preset, expected: &[(&str, f32)]) {
        let expected: Vec<_> = expected.iter().map(|(name, boost)| ((*name).to_owned(), *boost)).collect();
        assert_eq!(systems(preset), expected);
    }

    #[test]
    fn tracks_stay_with_their_systems() {
        let mut changed = preset();
        expect(&changed, &[("fire", 1.0), ("sparks", 2.0), ("smoke", 3.0)]);
        move_to(&mut changed, 0, 2);
        expect(&changed, &[("sparks", 2.0), ("smoke", 3.0), ("fire", 1.0)]);
        duplicate(&mut changed, 0).unwrap();
        expect(&changed, &[("sparks", 2.0), ("sparks 2", 2.0), ("smoke", 3.0), ("fire", 1.0)]);
        duplicate(&mut changed, 1).unwrap();
        assert_eq!(changed.systems[2].name, "sparks 3");
        remove(&mut changed, 0);
        expect(&changed, &[("sparks 2", 2.0), ("sparks 3", 2.0), ("smoke", 3.0), ("fire", 1.0)]);
        keep_only(&mut changed, 2);
        expect(&changed, &[("smoke", 3.0)]);
        assert_eq!(changed.animation.len(), 2, "those of the camera and of the smoke");
        // Indices of no system change nothing.
        let before = changed.clone();
        remove(&mut changed, 1);
        move_to(&mut changed, 0, 1);
        duplicate(&mut changed, 1).unwrap();
        assert_eq!(changed, before);
        move_to(&mut changed, 0, 0);
        assert_eq!(changed, before);
    }

    #[test]
    fn no_more_systems_or_particles_are_added_than_a_preset_takes() {
        let mut full = preset();
        let sparks = full.systems[1].clone();
        while full.systems.len() < MAX_SYSTEMS {
            add(&mut full, sparks.clone()).unwrap();
        }
        let before = full.clone();
        let said = duplicate(&mut full, 0).unwrap_err().to_string();
        assert_eq!(said, "systems: the preset has 32 systems; expected at most 32");
        assert!(add(&mut full, sparks).is_err() && full == before);
        let mut crowded = Preset::load("column").unwrap();
        crowded.systems[0].emitter.rate = 90_000.0;
        crowded.systems[0].emitter.lifetime = 9.0;
        let before = crowded.clone();
        let said = duplicate(&mut crowded, 0).unwrap_err().to_string();
        assert!(said.contains("particles of all systems are alive at once") && crowded == before, "{said}");
    }

    #[test]
    fn systems_are_found_by_name_or_number() {
        let preset = preset();
        assert_eq!((find(&preset, "--solo", "sparks"), find(&preset, "--solo", "2")), (Ok(1), Ok(2)));
        let said = |name: &str| find(&preset, "--solo", name).unwrap_err().to_string();
        let names = r#"is not valid; expected one of "fire", "sparks", "smoke""#;
        assert_eq!(
            (said("3"), said("spraks")),
            (format!("--solo: \"3\" {names}"), format!("--solo: \"spraks\" {names}"))
        );
        let said = find(&Preset::default(), "--solo", "0").unwrap_err().to_string();
        assert_eq!(said, "--solo: \"0\" is not valid; expected a preset with systems");
    }
}
