//! Time along the width of the lanes.

use std::ops::RangeInclusive;

use crate::session::Session;

/// Times from the left to the right of the lanes.
pub struct TimeAxis {
    pub left: f32,
    pub width: f32,
    range: RangeInclusive<f32>,
    /// Time of the playback.
    pub now: f32,
}

/// Room beside the first and the last time, points, so that the marks there are whole.
const MARGIN: f32 = 8.0;

impl TimeAxis {
    /// Axis over the range of the playback and all keyframes.
    pub fn new(left: f32, width: f32, session: &Session) -> Self {
        let keys = session.document.preset.animation.iter().flat_map(|track| &track.keys);
        let playback = &session.playback;
        let played = *playback.range.start() as f32..=*playback.range.end() as f32;
        let range = keys.fold(played, |range, key| range.start().min(key.time)..=range.end().max(key.time));
        Self { left, width, range, now: playback.key_time() }
    }

    pub fn x(&self, time: f32) -> f32 {
        let fraction = (time - self.range.start()) / (self.range.end() - self.range.start()).max(1.0e-3);
        self.left + MARGIN + fraction * (self.width - 2.0 * MARGIN)
    }

    pub fn time(&self, x: f32) -> f32 {
        let fraction = ((x - self.left - MARGIN) / (self.width - 2.0 * MARGIN).max(1.0)).clamp(0.0, 1.0);
        self.range.start() + fraction * (self.range.end() - self.range.start())
    }

    /// Returns the times of labels, at least `gap` points apart, and the number of their decimals.
    pub fn labels(&self, gap: f32) -> (Vec<f32>, usize) {
        let seconds_per_point = (self.range.end() - self.range.start()) / (self.width - 2.0 * MARGIN).max(1.0);
        let least = (gap * seconds_per_point).max(1.0e-3);
        let power = 10.0_f32.powf(least.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|times| times * power).into_iter().find(|step| *step >= least * 0.999);
        let step = step.unwrap_or(10.0 * power);
        let first = (self.range.start() / step).ceil() as i64;
        let last = (self.range.end() / step).floor() as i64;
        let decimals = (-step.log10().floor()).max(0.0) as usize;
        ((first..=last.min(first + 1000)).map(|index| index as f32 * step).collect(), decimals)
    }

    pub fn end(&self) -> f32 {
        *self.range.end()
    }
}
