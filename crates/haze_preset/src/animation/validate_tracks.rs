//! Checks of tracks: their settings, the times and values of their keyframes.

use std::collections::HashSet;

use haze_core::error::FieldError;
use haze_core::settings::{Fields, validate, write_field_path};

use super::animated_fields::{AnimatedField, AnimatedFields, for_each_animated_field};
use super::keyframe::MAX_TIME;
use super::setting_names;
use super::track::{MAX_KEYFRAMES, Track};

/// Checks the tracks of a preset. `check` checks the preset without tracks, here with the values of each keyframe.
///
/// # Errors
/// The first track that is not valid.
pub(crate) fn validate_tracks<T: Fields + Clone>(
    tracks: &[Track],
    fields: &T,
    check: impl Fn(&T) -> Result<(), FieldError>,
) -> Result<(), FieldError> {
    let count: usize = tracks.iter().map(|track| track.keys.len()).sum();
    if count > MAX_KEYFRAMES {
        let problem = format!("{count} keyframes are too many");
        return Err(FieldError::from_problem("animation", problem, format!("at most {MAX_KEYFRAMES}")));
    }
    let mut copy = fields.clone();
    let mut seen = HashSet::new();
    for (index, track) in tracks.iter().enumerate() {
        let at = format!("animation[{index}]");
        if !seen.insert(track.setting.as_str()) {
            let problem = format!("{:?} has a second track", track.setting);
            return Err(FieldError::from_problem(format!("{at}.setting"), problem, "one track for each setting"));
        }
        validate(&track.flicker, || format!("{at}.flicker"))?;
        check_times(track, &at)?;
        check_types(track, &at, &mut copy)?;
    }
    let animated = AnimatedFields::new(tracks, &mut copy);
    for (index, track) in tracks.iter().enumerate() {
        for (number, key) in track.keys.iter().enumerate() {
            animated.write_keyframe(&track.setting, key.time, &key.value, &mut copy);
            check(&copy).map_err(|error| with_keyframe(error, &track.setting, key.time, index, number))?;
        }
    }
    Ok(())
}

/// Names the keyframe in the error of a value. The error of another setting names the time.
fn with_keyframe(mut error: FieldError, setting: &str, time: f32, track: usize, key: usize) -> FieldError {
    if error.field == setting {
        error.field = format!("animation[{track}].keys[{key}].value");
        error.expected = format!("{} for {setting}", error.expected);
    } else {
        error.problem = format!("{} at {time} s", error.problem);
    }
    error
}

fn check_times(track: &Track, at: &str) -> Result<(), FieldError> {
    let within = |field: String, time: f32, (least, most): (f32, f32)| {
        if (least..=most).contains(&time) {
            return Ok(());
        }
        Err(FieldError::new(field, time, format!("{least} to {most} s")))
    };
    within(format!("{at}.period"), track.period, (0.0, MAX_TIME))?;
    let span = if track.period > 0.0 { (0.0, track.period) } else { (-MAX_TIME, MAX_TIME) };
    let mut before = None;
    for (number, key) in track.keys.iter().enumerate() {
        let field = format!("{at}.keys[{number}]");
        within(format!("{field}.time"), key.time, span)?;
        if let Some(before) = before.filter(|before| *before >= key.time) {
            let problem = format!("{} s does not come after {before} s", key.time);
            return Err(FieldError::from_problem(
                format!("{field}.time"),
                problem,
                "keyframes in the order of their times",
            ));
        }
        before = Some(key.time);
        if !key.value.is_finite() {
            let field = format!("{field}.value");
            return Err(FieldError::from_problem(field, "a number is not finite", "finite numbers"));
        }
    }
    Ok(())
}

/// Checks that the setting exists, and that the values are of its type.
fn check_types(track: &Track, at: &str, fields: &mut dyn Fields) -> Result<(), FieldError> {
    let mut found = None;
    let mut name = String::new();
    for_each_animated_field(fields, &mut |path, field| {
        write_field_path(path, &mut name);
        if found.is_none() && name == track.setting {
            found = Some(check_field(track, at, &field));
        }
    });
    found.unwrap_or_else(|| {
        let nearest = setting_names::nearest(&track.setting, fields);
        let nearest = nearest.map(|name| format!("; the nearest name is {name:?}")).unwrap_or_default();
        let expected = format!("the full name of a setting, such as camera.exposure{nearest}");
        Err(FieldError::new(format!("{at}.setting"), format!("{:?}", track.setting), expected))
    })
}

fn check_field(track: &Track, at: &str, field: &AnimatedField<'_>) -> Result<(), FieldError> {
    if field.kind().is_none() {
        let problem = format!("{:?} cannot have keyframes", track.setting);
        let expected = "a number, vector, color, switch or choice of the look";
        return Err(FieldError::from_problem(format!("{at}.setting"), problem, expected));
    }
    if track.flicker.amount > 0.0 && !field.flickers() {
        let expected = format!("0 for {}: only numbers and colors flicker", track.setting);
        return Err(FieldError::new(format!("{at}.flicker.amount"), track.flicker.amount, expected));
    }
    if track.keys.is_empty() && track.flicker.amount <= 0.0 {
        let problem = format!("{} neither changes nor flickers", track.setting);
        return Err(FieldError::from_problem(at, problem, "a keyframe in keys, or a flicker.amount above 0"));
    }
    match track.keys.iter().position(|key| !field.accepts(&key.value)) {
        Some(number) => {
            let value = serde_json::to_string(&track.keys[number].value).unwrap_or_default();
            let expected = format!("{} for {}", field.expected(), track.setting);
            Err(FieldError::new(format!("{at}.keys[{number}].value"), value, expected))
        }
        None => Ok(()),
    }
}
