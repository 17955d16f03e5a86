//! Edits of keyframes: values that become keyframes, and tracks of lights that move in their list.

use std::collections::HashMap;

use haze_core::settings::{FieldValue, field_path, field_values, for_each_field};
use haze_preset::{Ease, KeyValue, Keyframe, Preset, Track};

use super::light_roles::light_of;

/// Time within which a keyframe counts as that of a time, seconds: half a frame of 30 per second.
const REACH: f32 = 1.0 / 60.0;

/// Preset whose settings have the values of their keyframes, for panels to change.
pub struct KeyframeEdit {
    time: f32,
    before: Preset,
    shown: Preset,
}

impl KeyframeEdit {
    /// Gives the settings of a preset the values of their keyframes at a time. `None` without keyframes.
    pub fn begin(preset: &mut Preset, time: f32) -> Option<Self> {
        preset.animation.iter().find(|track| !track.keys.is_empty())?;
        let shown = preset.with_keyframes_at(f64::from(time));
        Some(Self { time, before: std::mem::replace(preset, shown.clone()), shown })
    }

    /// Turns changed values of settings with keyframes into keyframes at the time, and gives these settings their own values
    /// back. Returns the time of the keyframes, which may be that of near ones, if there are any.
    pub fn end(self, preset: &mut Preset) -> Option<f32> {
        if *preset == self.shown {
            *preset = self.before;
            return None;
        }
        let lists = |preset: &Preset| (preset.lights.len(), preset.systems.len());
        // Keyframes replace the values that new lights and systems bring with them.
        let has_other_lists = lists(preset) != lists(&self.shown);
        let is_in_list = |setting: &str| setting.starts_with("lights[") || setting.starts_with("systems[");
        let keyed: Vec<String> = preset
            .animation
            .iter()
            .filter(|track| !track.keys.is_empty())
            .filter(|track| !has_other_lists || !is_in_list(&track.setting))
            .map(|track| track.setting.clone())
            .collect();
        let of = |preset: &Preset| -> HashMap<String, FieldValue> {
            field_values(preset).into_iter().filter(|(path, _)| keyed.contains(path)).collect()
        };
        // Canceling a drag brings the keyframes from before it back; they are not written again.
        let is_restored = !has_other_lists && preset.animation != self.shown.animation;
        let own = of(&self.before);
        let shown = of(&self.shown);
        let edited = of(preset);
        for_each_field(preset, &mut |path, field| {
            if let Some(value) = own.get(&field_path(path)) {
                field.set(value);
            }
        });
        let mut written = None;
        let is_changed = |(setting, value): &(&String, &FieldValue)| shown.get(*setting) != Some(value);
        for (setting, value) in edited.iter().filter(|_| !is_restored).filter(is_changed) {
            if let Some(value) = KeyValue::from_field(value) {
                written = Some(set_key(preset, setting, self.time, value));
            }
        }
        written
    }
}

/// Returns the track of a setting.
pub fn track<'a>(preset: &'a Preset, setting: &str) -> Option<&'a Track> {
    preset.animation.iter().find(|track| track.setting == setting)
}

pub fn track_mut<'a>(preset: &'a mut Preset, setting: &str) -> Option<&'a mut Track> {
    preset.animation.iter_mut().find(|track| track.setting == setting)
}

/// Returns the track of a setting, which may be a new one.
pub fn track_or_new<'a>(preset: &'a mut Preset, setting: &str) -> &'a mut Track {
    let tracks = &mut preset.animation;
    let index = tracks.iter().position(|track| track.setting == setting).unwrap_or_else(|| {
        tracks.push(Track { setting: setting.into(), ..Track::default() });
        tracks.len() - 1
    });
    &mut tracks[index]
}

/// Returns the index of a track's keyframe at a time.
pub fn key_at(track: &Track, time: f32) -> Option<usize> {
    track.find(track.wrapped(f64::from(time)), REACH).ok()
}

/// Sets the keyframe at a time, or adds one, with the ease of the one before it. Returns its time.
pub fn set_key(preset: &mut Preset, setting: &str, time: f32, value: KeyValue) -> f32 {
    let track = track_or_new(preset, setting);
    let wrapped = track.wrapped(f64::from(time));
    match track.find(wrapped, REACH) {
        Ok(index) => {
            track.keys[index].value = value;
            time + track.keys[index].time - wrapped
        }
        Err(index) => {
            let ease = track.keys[..index].last().or(track.keys.first()).map_or(Ease::default(), |key| key.ease);
            track.keys.insert(index, Keyframe { time: wrapped, value, ease });
            time
        }
    }
}

/// Adds a keyframe with the value that a setting has at a time. Settings that cannot have keyframes stay as they are.
pub fn add_key(preset: &mut Preset, setting: &str, time: f32) {
    let values = field_values(&preset.with_keyframes_at(f64::from(time)));
    let value = values.into_iter().find(|(path, _)| path == setting);
    if let Some(value) = value.and_then(|(_, value)| KeyValue::from_field(&value)) {
        set_key(preset, setting, time, value);
    }
}

/// Removes a keyframe. The value of the last one becomes the setting's own.
pub fn remove_key(preset: &mut Preset, setting: &str, index: usize) {
    let Some(track) = track_mut(preset, setting).filter(|track| index < track.keys.len()) else { return };
    if track.keys.len() > 1 {
        track.keys.remove(index);
    } else if track.flicker.amount <= 0.0 {
        remove_track(preset, setting, 0.0);
    } else {
        let last = Track { keys: std::mem::take(&mut track.keys), ..track.clone() };
        keep_value(preset, last, 0.0);
    }
}

/// Removes the track of a setting, whose value at a time becomes its own.
pub fn remove_track(preset: &mut Preset, setting: &str, time: f32) {
    if let Some(index) = preset.animation.iter().position(|track| track.setting == setting) {
        let removed = preset.animation.remove(index);
        keep_value(preset, removed, time);
    }
}

/// Gives a setting the value that a track of it has at a time, without flicker.
fn keep_value(preset: &mut Preset, track: Track, time: f32) {
    let others = std::mem::replace(&mut preset.animation, vec![track]);
    *preset = preset.with_keyframes_at(f64::from(time));
    preset.animation = others;
}

/// Moves a keyframe in time, between its neighbors.
pub fn move_key(track: &mut Track, index: usize, time: f32) {
    let near = |other: Option<&Keyframe>, gap: f32| other.map(|key| key.time + gap);
    let period = Some(track.period).filter(|period| *period > 0.0);
    let least = near(index.checked_sub(1).and_then(|before| track.keys.get(before)), REACH).or(period.map(|_| 0.0));
    let most = near(track.keys.get(index + 1), -REACH).or(period);
    // Keyframes of a file may be nearer to each other.
    if least.zip(most).is_some_and(|(least, most)| least > most) {
        return;
    }
    if let Some(key) = track.keys.get_mut(index) {
        // A hundredth of a second is finer than a frame, and short in a file.
        let time = (time * 100.0).round() / 100.0;
        let time = most.map_or(time, |most| time.min(most));
        key.time = least.map_or(time, |least| time.max(least));
    }
}

/// Returns a value within the range of a setting. A value of another type becomes the setting's own.
pub fn clamped(preset: &Preset, setting: &str, value: KeyValue) -> KeyValue {
    let key = Keyframe { time: 0.0, value: value.clone(), ease: Ease::default() };
    let only = Track { setting: setting.into(), keys: vec![key], ..Track::default() };
    let values = field_values(&Preset { animation: vec![only], ..preset.clone() }.with_keyframes_at(0.0));
    let found = values.into_iter().find(|(path, _)| path == setting);
    found.and_then(|(_, value)| KeyValue::from_field(&value)).unwrap_or(value)
}

/// Adds copied keyframes so that the first is at a time. Keyframes at the same times are replaced.
pub fn paste_keys(preset: &mut Preset, setting: &str, time: f32, copied: &[Keyframe]) {
    let Some(first) = copied.first().map(|key| key.time) else { return };
    for key in copied {
        let value = clamped(preset, setting, key.value.clone());
        let at = set_key(preset, setting, time + key.time - first, value);
        if let Some(track) = track_mut(preset, setting)
            && let Some(index) = key_at(track, at)
        {
            track.keys[index].ease = key.ease;
        }
    }
}

/// Gives the tracks of lights the new positions of their lights; those of a light without a position are removed.
pub fn renumber_lights(tracks: &mut Vec<Track>, position: impl Fn(usize) -> Option<usize>) {
    tracks.retain_mut(|track| {
        let Some(index) = light_of(&track.setting) else { return true };
        let Some(position) = position(index) else { return false };
        track.setting = with_light(&track.setting, position);
        true
    });
}

/// Copies the tracks of a light to those of another.
pub fn copy_light_tracks(tracks: &mut Vec<Track>, from: usize, to: usize) {
    let of_light = tracks.iter().filter(|track| light_of(&track.setting) == Some(from));
    let copies: Vec<_> =
        of_light.map(|track| Track { setting: with_light(&track.setting, to), ..track.clone() }).collect();
    tracks.extend(copies);
}

fn with_light(setting: &str, index: usize) -> String {
    let field = setting.split_once(']').map_or("", |(_, field)| field);
    format!("lights[{index}]{field}")
}

#[cfg(test)]
mod tests {
    use haze_preset::Flicker;

    use super::*;

    fn preset() -> Preset {
        let mut preset = Preset::load("column").unwrap();
        for (time, value) in [(0.0, 2.0), (4.0, 6.0)] {
            set_key(&mut preset, "lights[0].intensity", time, KeyValue::Number(value));
        }
        preset.animation[0].keys[0].ease = Ease::Linear;
        preset
    }

    fn edit(preset: &mut Preset, time: f32, change: impl Fn(&mut Preset)) -> Option<f32> {
        let edit = KeyframeEdit::begin(preset, time).unwrap();
        change(preset);
        let at = edit.end(preset);
        preset.validate().unwrap();
        at
    }

    #[test]
    fn a_change_of_a_setting_with_keyframes_is_a_keyframe_and_any_other_is_not() {
        let mut changed = preset();
        let before = preset();
        assert_eq!(edit(&mut changed, 1.0, |_| {}), None);
        assert_eq!(changed, before, "to look changes nothing");
        assert_eq!(edit(&mut changed, 1.0, |preset| preset.lights[1].intensity = 9.0), None);
        let mut expected = before.clone();
        expected.lights[1].intensity = 9.0;
        assert_eq!(changed, expected);
        let at = edit(&mut changed, 1.0, |preset| {
            assert!((preset.lights[0].intensity - 3.0).abs() < 1e-5);
            preset.lights[0].intensity = 5.0;
        });
        assert_eq!(at, Some(1.0));
        assert_eq!(changed.animation[0].keys.len(), 3);
        assert_eq!(
            changed.animation[0].keys[1],
            Keyframe { time: 1.0, value: KeyValue::Number(5.0), ease: Ease::Linear }
        );
        assert_eq!(changed.lights[0], before.lights[0], "its own value stays");
        // Near a keyframe, that one changes.
        assert_eq!(edit(&mut changed, 1.01, |preset| preset.lights[0].intensity = 1.0), Some(1.0));
        assert_eq!(changed.animation[0].keys.len(), 3);
        // No keyframes, no edit.
        assert!(KeyframeEdit::begin(&mut Preset::load("column").unwrap(), 1.0).is_none());
    }

    #[test]
    fn the_last_keyframe_leaves_its_value_and_flicker_keeps_the_track() {
        let mut changed = preset();
        remove_key(&mut changed, "lights[0].intensity", 0);
        assert_eq!(changed.animation[0].keys.len(), 1);
        changed.animation[0].flicker = Flicker { amount: 0.5, ..Flicker::default() };
        remove_key(&mut changed, "lights[0].intensity", 0);
        assert!((changed.lights[0].intensity - 6.0).abs() < 1e-6 && changed.animation[0].keys.is_empty());
        changed.validate().unwrap();
        let mut steady = preset();
        (0..2).for_each(|_| remove_key(&mut steady, "lights[0].intensity", 0));
        assert!(steady.animation.is_empty());
        let mut removed = preset();
        remove_track(&mut removed, "lights[0].intensity", 1.0);
        assert!((removed.lights[0].intensity - 3.0).abs() < 1e-5 && removed.animation.is_empty());
    }

    #[test]
    fn a_moved_keyframe_stays_between_its_neighbors_and_in_the_loop() {
        let mut changed = preset();
        add_key(&mut changed, "lights[0].intensity", 2.0);
        let track = &mut changed.animation[0];
        let moved = |track: &mut Track, index, time| {
            move_key(track, index, time);
            track.keys[index].time
        };
        assert!((moved(track, 1, 3.004) - 3.0).abs() < 1e-6);
        assert!(moved(track, 1, 9.0) < 4.0 && moved(track, 1, -9.0) > 0.0);
        assert!((moved(track, 2, 90.0) - 90.0).abs() < 1e-6);
        track.period = 100.0;
        assert!((moved(track, 2, 900.0) - 100.0).abs() < 1e-6 && moved(track, 0, -3.0).abs() < 1e-6);
        changed.validate().unwrap();
    }

    #[test]
    fn copied_keyframes_keep_their_distances_and_eases() {
        let mut changed = preset();
        let copied = changed.animation[0].keys.clone();
        paste_keys(&mut changed, "lights[1].intensity", 2.0, &copied);
        let times: Vec<_> = changed.animation[1].keys.iter().map(|key| key.time).collect();
        assert_eq!(times, [2.0, 6.0]);
        assert_eq!(changed.animation[1].keys[0].ease, Ease::Linear);
        changed.validate().unwrap();
    }
}
