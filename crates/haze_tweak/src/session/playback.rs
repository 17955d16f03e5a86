//! Playback time.

use std::ops::RangeInclusive;

use haze_preset::{Preset, PresetSystem};

/// Clock that can be paused, stepped and looped. Times are in seconds since the emission began.
#[derive(Clone, Debug, PartialEq)]
pub struct Playback {
    pub time: f64,
    pub is_playing: bool,
    /// Factor on the elapsed time; negative plays backwards.
    pub speed: f64,
    /// Range of the loop, seconds.
    pub range: RangeInclusive<f64>,
    pub is_looping: bool,
}

/// Duration of one step, seconds.
pub const STEP: f64 = 1.0 / 30.0;

/// Longest time that one frame of the window may advance the clock, seconds. After a pause of the window, the smoke
/// does not jump.
const MAX_STEP: f64 = 0.1;

impl Playback {
    /// Returns a clock that is paused at a preset's time, with a range that reaches to its last keyframe. It loops if an
    /// emission ends, so that a blast comes again.
    pub fn of(preset: &Preset) -> Self {
        let clock = Self::at(preset.time);
        let keys = preset.animation.iter().filter_map(|track| track.keys.last());
        let end = keys.fold(*clock.range.end(), |end, key| end.max(f64::from(key.time)));
        let ends = |system: &PresetSystem| system.emitter.duration > 0.0 && system.emitter.period <= 0.0;
        Self { range: 0.0..=end, is_looping: preset.systems.iter().any(ends), ..clock }
    }

    /// Returns a clock that is paused at a time.
    pub fn at(time: f64) -> Self {
        Self { time, is_playing: false, speed: 1.0, range: 0.0..=(time + 6.0).max(10.0), is_looping: false }
    }

    /// Time of keyframes that are set now.
    pub fn key_time(&self) -> f32 {
        self.time as f32
    }

    /// Advances by the elapsed seconds, if it plays.
    pub fn advance(&mut self, seconds: f64) {
        if self.is_playing {
            self.move_by(seconds.clamp(0.0, MAX_STEP) * self.speed);
        }
    }

    /// Pauses the clock and moves it by a number of frames.
    pub fn step(&mut self, frames: f64) {
        self.is_playing = false;
        self.move_by(frames * STEP);
    }

    fn move_by(&mut self, seconds: f64) {
        let start = *self.range.start();
        let end = *self.range.end();
        self.time += seconds;
        if self.is_looping && end > start && !self.range.contains(&self.time) {
            self.time = start + (self.time - start).rem_euclid(end - start);
        }
    }
}

#[cfg(test)]
mod tests {
    use haze_preset::KeyValue;

    use super::*;
    use crate::document::keyframes::set_key;

    #[test]
    fn a_loop_wraps_in_both_directions() {
        let mut clock = Playback { is_playing: true, is_looping: true, range: 2.0..=4.0, ..Playback::at(3.9) };
        clock.advance(0.1);
        clock.advance(0.1);
        assert!((clock.time - 2.1).abs() < 1e-5, "{}", clock.time);
        clock.speed = -4.0;
        clock.advance(0.05);
        assert!((clock.time - 3.9).abs() < 1e-5, "{}", clock.time);
        // A window that was hidden for a minute does not jump.
        clock.speed = 1.0;
        clock.advance(60.0);
        assert!((clock.time - 4.0).abs() < 1e-5, "{}", clock.time);
        clock.step(-1.0);
        assert!(!clock.is_playing && clock.time < 3.99 && clock.time > 3.9);
    }

    #[test]
    fn the_range_reaches_to_the_last_keyframe_and_a_blast_loops() {
        let mut preset = Preset { time: 2.0, ..Preset::default() };
        assert_eq!(Playback::of(&preset), Playback::at(2.0));
        set_key(&mut preset, "camera.exposure", 25.0, KeyValue::Number(1.0));
        assert_eq!(Playback::of(&preset).range, 0.0..=25.0);
        assert!(!Playback::of(&preset).is_looping);
        let mut blast = PresetSystem::default();
        blast.emitter.duration = 0.2;
        preset.systems.push(blast);
        assert!(Playback::of(&preset).is_looping, "a blast comes again");
    }

    #[test]
    fn a_paused_clock_does_not_move() {
        let mut clock = Playback::at(5.0);
        clock.advance(1.0);
        assert_eq!(clock, Playback::at(5.0));
        clock.step(3.0);
        assert!((clock.time - 5.1).abs() < 1e-6);
    }
}
