//! Track: the keyframes and the flicker of one setting.

use haze_core::fire::flicker;
use haze_core::settings::settings;

use super::interpolation::{self, Kind};
use super::keyframe::{KeyValue, Keyframe, is_default};

/// Most keyframes in a preset.
pub const MAX_KEYFRAMES: usize = 4096;

settings! {
    /// Random changes of a number or a color, as of a flame or a failing lamp.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Flicker {
        /// Largest change, as a fraction of the value. 0: steady. 1: it goes out at times, and doubles.
        amount: f32 = 0.0, number(0.0..=1.0, "");
        /// Changes per second. Higher: more nervous. A fire has 5.
        rate: f32 = 5.0, number(0.01..=60.0, "1/s");
        /// Seed of the flicker. Tracks with the same seed and rate flicker together.
        seed: u32 = 1, seed;
    }
}

/// Course of one setting over time.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Track {
    /// Full name of the setting, as `haze preset show` prints it: `lights[0].intensity`. At most one track has it.
    pub setting: String,
    /// Keyframes in the order of their times. They replace the setting's own value; without any, it stays and flickers.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub keys: Vec<Keyframe>,
    /// Seconds after which the keyframes repeat, from 0 on; the last one leads to the first again. 0: they do not repeat.
    #[serde(default, skip_serializing_if = "is_default")]
    #[cfg_attr(feature = "schema", schemars(range(min = 0.0, max = super::keyframe::MAX_TIME)))]
    pub period: f32,
    /// Flicker on top of the keyframes. It does not repeat.
    #[serde(default, skip_serializing_if = "is_default")]
    pub flicker: Flicker,
}

impl Track {
    /// Index of the keyframe at a time, or the index at which one would be inserted.
    ///
    /// # Errors
    /// The index at which to insert, if no keyframe is within `tolerance` seconds.
    pub fn find(&self, time: f32, tolerance: f32) -> Result<usize, usize> {
        let near = |key: &&Keyframe| (key.time - time).abs();
        let nearest = self.keys.iter().min_by(|a, b| near(a).total_cmp(&near(b)));
        match nearest.filter(|key| near(key) <= tolerance) {
            Some(key) => Ok(self.keys.partition_point(|other| other.time < key.time)),
            None => Err(self.keys.partition_point(|key| key.time < time)),
        }
    }

    /// Value at a time, without flicker. `None` without keyframes.
    pub(super) fn value(&self, time: f64, kind: Kind) -> Option<KeyValue> {
        interpolation::value(&self.keys, self.period, time, kind)
    }

    /// Factor of the flicker at a time.
    pub(super) fn flicker_factor(&self, time: f64) -> f32 {
        let Flicker { amount, rate, seed } = self.flicker;
        if amount > 0.0 { flicker(amount, rate, time, seed) } else { 1.0 }
    }

    /// Time within the period.
    pub fn wrapped(&self, time: f64) -> f32 {
        let wrapped = if self.period > 0.0 { time.rem_euclid(f64::from(self.period)) } else { time };
        wrapped as f32
    }
}
