//! A preset at a time: the values of its tracks.

use std::slice;

use haze_core::error::FieldError;
use haze_core::settings::{is_field_named, set_field};

use super::animation::{AnimatedFields, KeyValue, Track};
use super::preset_file::Preset;

/// A preset that is evaluated at any times, in any order. Settings are looked up by name once, not in each frame.
///
/// ```
/// use haze_preset::{AnimatedPreset, Preset};
///
/// let mut animated = AnimatedPreset::new(&Preset::load("column")?);
/// for frame in 0..3 {
///     let preset = animated.evaluate(f64::from(frame) / 60.0);
///     let (lights, settings) = (&preset.lights, &preset.systems[0].settings);
/// }
/// # Ok::<(), haze_core::error::AssetError>(())
/// ```
#[derive(Clone, Debug)]
pub struct AnimatedPreset {
    shown: Preset,
    fields: AnimatedFields,
}

impl AnimatedPreset {
    /// Prepares a preset, which should be valid: tracks of unknown settings and keyframes of a wrong type do nothing.
    pub fn new(preset: &Preset) -> Self {
        let mut shown = preset.clone();
        let fields = AnimatedFields::new(&std::mem::take(&mut shown.animation), &mut shown);
        Self { shown, fields }
    }

    /// The preset at a time, seconds: its settings have the values of their tracks, each within its range, and it has no
    /// tracks of its own.
    pub fn evaluate(&mut self, time: f64) -> &Preset {
        self.shown.time = time;
        self.fields.write(time, true, &mut self.shown);
        &self.shown
    }
}

impl Preset {
    /// The preset at a time, seconds: its settings have the values of their tracks, and it has no tracks of its own. Any
    /// time can be asked for in any order. [`AnimatedPreset`] does the same frame by frame, without copies.
    #[must_use]
    pub fn evaluate(&self, time: f64) -> Self {
        let mut animated = AnimatedPreset::new(self);
        animated.evaluate(time);
        animated.shown
    }

    /// The preset with the values that its keyframes have at a time, without flicker, and with its tracks: for editors.
    #[must_use]
    pub fn with_keyframes_at(&self, time: f64) -> Self {
        let mut preset = self.clone();
        AnimatedFields::new(&self.animation, &mut preset).write(time, false, &mut preset);
        preset
    }

    /// The values of one of the preset's settings at some times, with a track of it: for curves of editors. Empty for unknown
    /// settings.
    #[must_use]
    pub fn track_values(&self, track: &Track, has_flicker: bool, times: &[f32]) -> Vec<KeyValue> {
        AnimatedFields::new(slice::from_ref(track), &mut self.clone()).values(has_flicker, times)
    }

    /// True for settings that can flicker: numbers and colors.
    #[must_use]
    pub fn can_flicker(&self, setting: &str) -> bool {
        let track = Track { setting: setting.into(), ..Track::default() };
        AnimatedFields::new(slice::from_ref(&track), &mut self.clone()).flickers()
    }

    /// Sets the fields that `path` names, as [`set_field`], and removes their tracks, which would replace the value.
    ///
    /// # Errors
    /// As [`set_field`].
    pub fn set_field(&mut self, path: &str, value: &str) -> Result<String, FieldError> {
        let name = set_field(self, path, value)?;
        self.animation.retain(|track| !is_field_named(&track.setting, path, &name));
        Ok(name)
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use haze_core::glam::Vec3;

    use super::*;
    use crate::{Ease, Flicker, KeyValue, Keyframe, MAX_KEYFRAMES, Track};
    use haze_core::settings::{RenderPath, field_values};

    fn parse(animation: &str) -> Result<Preset, String> {
        let mut preset = Preset::load("column").map_err(|error| error.to_string())?;
        preset.description = String::new();
        let text = preset.to_json("");
        let text = format!("{}, \"animation\": [{animation}]}}", text.trim_end().trim_end_matches('}'));
        Preset::parse(Path::new("my.json"), &text).map_err(|error| error.to_string())
    }

    #[test]
    fn every_kind_of_setting_changes_and_any_time_can_be_asked_for() {
        let preset = parse(
            r#"{"setting": "camera.exposure", "keys": [{"time": 1, "value": 0, "ease": "linear"}, {"time": 3, "value": 2}]},
            {"setting": "lights[1].color", "keys": [{"time": 0, "value": [1, 1, 1], "ease": "linear"}, {"time": 2, "value": [1, 0.5, 0]}]},
            {"setting": "lights[1].direction", "keys": [{"time": 0, "value": [0, -1, 0], "ease": "linear"}, {"time": 2, "value": [-1, 0, 0]}]},
            {"setting": "systems[0].settings.accumulate.downscale", "keys": [{"time": 0, "value": 1, "ease": "linear"}, {"time": 2, "value": 4}]},
            {"setting": "systems[0].settings.path", "keys": [{"time": 0, "value": "raster"}, {"time": 2, "value": "tiled"}]},
            {"setting": "environment.lamp", "keys": [{"time": 2, "value": true}, {"time": 4, "value": false}]},
            {"setting": "lights[2].intensity", "flicker": {"amount": 0.5, "rate": 8}}"#,
        )
        .unwrap();
        let mut animated = AnimatedPreset::new(&preset);
        let mut middle = None;
        for time in [2.0, 9.0, -3.0, 2.0, 1.0, 2.0] {
            let at = animated.evaluate(time).clone();
            assert_eq!(at, preset.evaluate(time), "{time}");
            assert!(at.animation.is_empty() && at.time.to_bits() == time.to_bits());
            at.validate().unwrap();
            if time.to_bits() == 2.0_f64.to_bits() {
                assert_eq!(*middle.get_or_insert_with(|| at.clone()), at, "the way to a time does not matter");
            }
        }
        let middle = middle.unwrap();
        assert!((middle.camera.exposure - 1.0).abs() < 1e-6);
        assert_eq!(middle.systems[0].settings.path, RenderPath::Tiled);
        assert!(middle.environment.lamp && !preset.evaluate(4.5).environment.lamp);
        let early = preset.evaluate(1.0);
        assert!(early.lights[1].color.distance(Vec3::new(1.0, 0.75, 0.5)) < 1e-6, "linear light");
        assert!(early.lights[1].direction.distance(Vec3::new(-1.0, -1.0, 0.0).normalize()) < 1e-5);
        assert_eq!(early.systems[0].settings.accumulate.downscale, 3, "2.5 is rounded");
        let fraction = |time: f64| preset.evaluate(time).lights[2].intensity / preset.lights[2].intensity;
        assert!((0..50).any(|step| (fraction(f64::from(step) * 0.1) - 1.0).abs() > 0.2));
        assert!((0..50).all(|step| (fraction(f64::from(step) * 0.1) - 1.0).abs() <= 0.5 + 1e-6));
        // An editor sees the steady value.
        let edited = preset.with_keyframes_at(2.0);
        assert_eq!((edited.lights[2].intensity, edited.camera), (preset.lights[2].intensity, middle.camera));
        assert_eq!(edited.animation, preset.animation);
    }

    #[test]
    fn values_between_keyframes_stay_within_ranges_that_depend_on_each_other() {
        let preset = parse(
            r#"{"setting": "lights[0].inner_angle", "keys": [{"time": 0, "value": 5}, {"time": 4, "value": 30}]},
            {"setting": "lights[0].outer_angle", "keys": [{"time": 0, "value": 10, "ease": "hold"}, {"time": 4, "value": 40}]}"#,
        )
        .unwrap();
        for step in 0..40 {
            preset.evaluate(f64::from(step) * 0.125).validate().unwrap();
        }
    }

    #[test]
    fn errors_name_the_track_and_the_expected_value() {
        let key = r#""keys": [{"time": 0, "value": 1}]"#;
        for (animation, expected) in [
            (
                format!(r#"{{"setting": "lights[0].intensty", {key}}}"#),
                "my.json: animation[0].setting: \"lights[0].intensty\" is not valid; expected the full name of a setting, such as \
                 camera.exposure; the nearest name is \"lights[0].intensity\"",
            ),
            (
                format!(r#"{{"setting": "boost", {key}}}"#),
                "my.json: animation[0].setting: \"boost\" is not valid; expected the full name of a setting, such as \
                 camera.exposure; the nearest name is \"systems[0].settings.boost\"",
            ),
            (
                format!(r#"{{"setting": "systems[0].material.sprite", {key}}}"#),
                "my.json: animation[0].setting: \"systems[0].material.sprite\" cannot have keyframes; expected a number, vector, \
                 color, switch or choice of the look",
            ),
            (
                format!(r#"{{"setting": "camera.fov", {key}}}, {{"setting": "camera.fov", {key}}}"#),
                "my.json: animation[1].setting: \"camera.fov\" has a second track; expected one track for each setting",
            ),
            (
                r#"{"setting": "camera.fov", "keys": [{"time": 0, "value": 20}, {"time": 0, "value": 30}]}"#.into(),
                "my.json: animation[0].keys[1].time: 0 s does not come after 0 s; expected keyframes in the order of their times",
            ),
            (
                r#"{"setting": "camera.fov", "period": 2, "keys": [{"time": 3, "value": 20}]}"#.into(),
                "my.json: animation[0].keys[0].time: 3 is not valid; expected 0 to 2 s",
            ),
            (
                r#"{"setting": "camera.fov", "keys": [{"time": 0, "value": 20}, {"time": 1, "value": 200}]}"#.into(),
                "my.json: animation[0].keys[1].value: 200 is not valid; expected 1 to 150 degrees for camera.fov",
            ),
            (
                r#"{"setting": "camera.fov", "keys": [{"time": 0, "value": [1, 2, 3]}]}"#.into(),
                "my.json: animation[0].keys[0].value: [1.0,2.0,3.0] is not valid; expected a number for camera.fov",
            ),
            (
                r#"{"setting": "systems[0].settings.path", "keys": [{"time": 0, "value": "rastre"}]}"#.into(),
                "my.json: animation[0].keys[0].value: \"rastre\" is not valid; expected one of auto, raster, tiled, forward for \
                 systems[0].settings.path",
            ),
            (
                r#"{"setting": "systems[0].settings.accumulate.depth_source", "keys": [{"time": 2, "value": "host"}]}"#
                    .into(),
                "my.json: systems[0].settings.accumulate.downscale: 2 is not valid at 2 s; expected 1 with depth_source \"host\"",
            ),
            (
                format!(r#"{{"setting": "camera.fov", "period": 200000, {key}}}"#),
                "my.json: animation[0].period: 200000 is not valid; expected 0 to 100000 s",
            ),
            (
                format!(r#"{{"setting": "camera.fov", "period": -1, {key}}}"#),
                "my.json: animation[0].period: -1 is not valid; expected 0 to 100000 s",
            ),
            (
                r#"{"setting": "camera.fov", "keys": [{"time": 1e39, "value": 20}]}"#.into(),
                "my.json: animation[0].keys[0].time: inf is not valid; expected -100000 to 100000 s",
            ),
            (
                r#"{"setting": "camera.fov", "keys": [{"time": 0, "value": 20}, {"time": 1, "value": 1e39}]}"#.into(),
                "my.json: animation[0].keys[1].value: a number is not finite; expected finite numbers",
            ),
            (
                r#"{"setting": "camera.target", "keys": [{"time": 0, "value": [0, -1e39, 0]}]}"#.into(),
                "my.json: animation[0].keys[0].value: a number is not finite; expected finite numbers",
            ),
            (
                {
                    let keys: Vec<_> =
                        (0..=MAX_KEYFRAMES).map(|time| format!(r#"{{"time": {time}, "value": 20}}"#)).collect();
                    format!(r#"{{"setting": "camera.fov", "keys": [{}]}}"#, keys.join(", "))
                },
                "my.json: animation: 4097 keyframes are too many; expected at most 4096",
            ),
            (
                r#"{"setting": "camera.fov"}"#.into(),
                "my.json: animation[0]: camera.fov neither changes nor flickers; expected a keyframe in keys, or a flicker.amount \
                 above 0",
            ),
            (
                r#"{"setting": "camera.target", "flicker": {"amount": 0.5}}"#.into(),
                "my.json: animation[0].flicker.amount: 0.5 is not valid; expected 0 for camera.target: only numbers and colors \
                 flicker",
            ),
            (
                r#"{"setting": "camera.fov", "flicker": {"amount": 1.5}}"#.into(),
                "my.json: animation[0].flicker.amount: 1.5 is not valid; expected 0 to 1",
            ),
        ] {
            assert_eq!(parse(&animation).unwrap_err(), expected);
        }
        let of_type = parse(r#"{"setting": "camera.fov", "keys": [{"time": 0, "value": null}]}"#).unwrap_err();
        assert!(
            of_type.starts_with("my.json:") && of_type.contains("animation[0].keys[0].value: null is not valid"),
            "{of_type}"
        );
        let ease =
            parse(r#"{"setting": "camera.fov", "keys": [{"time": 0, "value": 9, "ease": "bounce"}]}"#).unwrap_err();
        assert!(ease.ends_with("expected one of smooth, linear, ease_in, ease_out, hold"), "{ease}");
    }

    #[test]
    fn tracks_are_written_and_read_back() {
        let mut preset = Preset::load("corridor").unwrap();
        let key = |time, value| Keyframe { time, value, ease: Ease::Linear };
        preset.animation = vec![
            Track {
                setting: "lights[0].color".into(),
                keys: vec![key(0.1, KeyValue::Vector(Vec3::new(0.1, 0.2, 0.3))), key(1.0, KeyValue::Vector(Vec3::ONE))],
                period: 2.5,
                flicker: Flicker { amount: 0.25, ..Flicker::default() },
            },
            Track {
                setting: "systems[0].settings.debug.freeze_animation".into(),
                keys: vec![key(0.0, KeyValue::Flag(true))],
                ..Track::default()
            },
        ];
        preset.validate().unwrap();
        let text = preset.to_json("");
        assert_eq!(Preset::parse(Path::new("a.json"), &text).unwrap(), preset);
        assert!(!text.contains("\"period\": 0.0"), "{text}");
        assert!(!Preset::load("corridor").unwrap().to_json("").contains("animation"));
    }

    #[test]
    fn every_setting_of_the_look_can_have_a_keyframe() {
        let mut preset = Preset::load("column").unwrap();
        let key = |value| vec![Keyframe { time: 0.0, value, ease: Ease::default() }];
        let tracks = field_values(&preset).into_iter().filter_map(|(setting, value)| {
            let is_fixed = ["version", "time", "systems[0].emitter.seed"].contains(&setting.as_str());
            let value = KeyValue::from_field(&value).filter(|_| !is_fixed)?;
            Some(Track { setting, keys: key(value), ..Track::default() })
        });
        preset.animation = tracks.collect();
        assert!(preset.animation.len() > 100, "{}", preset.animation.len());
        preset.validate().unwrap();
        assert_eq!(preset.evaluate(preset.time), Preset { animation: Vec::new(), ..preset.clone() });
    }

    #[test]
    fn a_field_that_is_set_has_no_track_any_more() {
        let mut preset = parse(
            r#"{"setting": "lights[0].intensity", "keys": [{"time": 0, "value": 1}]},
            {"setting": "lights[1].intensity", "keys": [{"time": 0, "value": 1}]},
            {"setting": "systems[0].settings.ambient.intensity", "keys": [{"time": 0, "value": 1}]}"#,
        )
        .unwrap();
        preset.set_field("lights[0].intensity", "7").unwrap();
        assert_eq!(preset.evaluate(0.0).lights[0].intensity.to_bits(), 7.0_f32.to_bits());
        assert_eq!(preset.animation.len(), 2);
        preset.set_field("lights.intensity", "7").unwrap();
        assert_eq!(preset.animation.len(), 1);
        assert!(preset.set_field("ambient.intensity", "much").is_err());
        assert_eq!(preset.animation.len(), 1);
    }
}
