//! The time that is shown.

use std::ops::RangeInclusive;

/// A clock that can be stopped, stepped and sent round. Seconds into the emission.
#[derive(Clone, Debug, PartialEq)]
pub struct Playback {
    pub time: f32,
    pub is_playing: bool,
    /// Multiplies the clock; negative runs backwards.
    pub speed: f32,
    /// Where it begins again, and where it ends.
    pub range: RangeInclusive<f32>,
    pub is_looping: bool,
}

/// A frame, when time is stepped.
pub const STEP: f32 = 1.0 / 30.0;

/// Longest time that one frame of the window may take from the clock: after a pause the smoke goes on where it was.
const LONGEST: f32 = 0.1;

impl Playback {
    /// Stands still at a time.
    pub fn at(time: f32) -> Self {
        Self { time, is_playing: false, speed: 1.0, range: 0.0..=(time + 6.0).max(10.0), is_looping: false }
    }

    /// Goes on by the seconds that have passed.
    pub fn advance(&mut self, seconds: f32) {
        if self.is_playing {
            self.move_by(seconds.clamp(0.0, LONGEST) * self.speed);
        }
    }

    /// Stops, and goes on by so many frames.
    pub fn step(&mut self, frames: f32) {
        self.is_playing = false;
        self.move_by(frames * STEP);
    }

    fn move_by(&mut self, seconds: f32) {
        let (start, end) = (*self.range.start(), *self.range.end());
        self.time += seconds;
        if self.is_looping && end > start && !self.range.contains(&self.time) {
            self.time = start + (self.time - start).rem_euclid(end - start);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_goes_round_either_way() {
        let mut clock = Playback { is_playing: true, is_looping: true, range: 2.0..=4.0, ..Playback::at(3.9) };
        clock.advance(0.1);
        clock.advance(0.1);
        assert!((clock.time - 2.1).abs() < 1e-5, "{}", clock.time);
        clock.speed = -4.0;
        clock.advance(0.05);
        assert!((clock.time - 3.9).abs() < 1e-5, "{}", clock.time);
        // A window that was away for a minute does not jump.
        clock.speed = 1.0;
        clock.advance(60.0);
        assert!((clock.time - 4.0).abs() < 1e-5, "{}", clock.time);
        clock.step(-1.0);
        assert!(!clock.is_playing && clock.time < 3.99 && clock.time > 3.9);
    }

    #[test]
    fn what_stands_still_stays() {
        let mut clock = Playback::at(5.0);
        clock.advance(1.0);
        assert_eq!(clock, Playback::at(5.0));
        clock.step(3.0);
        assert!((clock.time - 5.1).abs() < 1e-6);
    }
}
