//! GPU time of the image, and the accumulation scale that keeps it within a budget.

use std::collections::VecDeque;

use haze::preset::Preset;
use haze::settings::Budget;
use haze::{FrameTimes, ScaleBudget};
use haze_author::preset::Tooltips;

use super::easel::{Easel, RenderStats};

/// Number of images whose times are kept.
pub const REMEMBERED: usize = 200;

/// Number of frames for which a result may still arrive after the image was drawn.
const LATE: u32 = 8;

/// Data of the performance tab. Nothing is measured unless the tab is visible or a budget is held.
pub struct Performance {
    /// Budget for the smoke.
    pub budget: Budget,
    /// The budget is enforced through the scale of the shown image. The preset does not change.
    pub is_held: bool,
    pub tooltips: Tooltips,
    /// Times of each image in milliseconds, indexed like `names`; the oldest first.
    pub pictures: VecDeque<Vec<f32>>,
    /// Names of the passes, in the order of the frame.
    pub names: Vec<&'static str>,
    pub figures: RenderStats,
    holder: Option<ScaleBudget>,
    /// Frame of the latest result; `waiting` counts down the frames in which another may arrive.
    seen: Option<u64>,
    waiting: u32,
}

/// Name of the only entry where the GPU cannot be timed.
pub const CPU_TIME: &str = "CPU time of the frame";

impl Default for Performance {
    fn default() -> Self {
        Self {
            budget: Budget::default(),
            is_held: false,
            tooltips: Tooltips::of::<Budget>(),
            pictures: VecDeque::new(),
            names: Vec::new(),
            figures: RenderStats::default(),
            holder: None,
            seen: None,
            waiting: 0,
        }
    }
}

impl Performance {
    /// Call once a frame, after the panels. `cpu_seconds`: CPU time of the previous frame. Returns true if another
    /// frame is needed.
    pub fn follow(&mut self, easel: &Easel, is_seen: bool, cpu_seconds: Option<f32>, preset: &Preset) -> bool {
        let is_on = is_seen || self.is_held;
        easel.measure(is_on);
        if !is_on {
            (self.holder, self.waiting) = (None, 0);
            self.pictures.clear();
            easel.show_scale(None);
            return false;
        }
        let before = std::mem::replace(&mut self.figures, easel.figures());
        let is_drawn = self.figures.pictures != before.pictures;
        let is_second_drawn = self.figures.seconds != before.seconds;
        let times = self.figures.times.take().filter(|times| self.seen.replace(times.frame) != Some(times.frame));
        self.waiting = if is_drawn || is_second_drawn { LATE } else { self.waiting.saturating_sub(1) };
        if let Some(times) = &times {
            self.remember(times.passes.iter().filter(|pass| !pass.is_host).map(|pass| (pass.name, pass.ms)));
        } else if !self.figures.is_timed && is_drawn {
            self.remember(cpu_seconds.map(|seconds| (CPU_TIME, 1.0e3 * seconds)).into_iter());
        }
        if !self.is_held {
            self.holder = None;
        } else if easel.divisor() == 1 {
            self.hold(easel, times.as_ref(), preset);
        }
        easel.show_scale(self.scale());
        self.waiting > 0
    }

    /// Returns the scale that enforces the budget, if one is held.
    pub fn scale(&self) -> Option<u32> {
        self.holder.as_ref().map(ScaleBudget::scale)
    }

    fn hold(&mut self, easel: &Easel, times: Option<&FrameTimes>, preset: &Preset) {
        let of_preset = preset.systems.first().map_or(1, |system| system.settings.accumulate.scale);
        let holder = self.holder.get_or_insert_with(|| ScaleBudget::new(self.budget, of_preset));
        holder.budget = self.budget;
        let Some(ms) = times.map(FrameTimes::smoke_ms) else { return };
        let scale = holder.update(ms);
        // A still image is drawn again until it is within the budget or the scale has reached its limit.
        if ms > self.budget.milliseconds && scale < self.budget.max_scale {
            easel.draw_again();
            self.waiting = LATE;
        }
    }

    fn remember(&mut self, parts: impl Iterator<Item = (&'static str, f32)>) {
        let mut picture = vec![0.0; self.names.len()];
        for (name, ms) in parts {
            let at = self.names.iter().position(|known| *known == name).unwrap_or_else(|| {
                self.names.push(name);
                picture.push(0.0);
                picture.len() - 1
            });
            picture[at] += ms;
        }
        self.pictures.push_back(picture);
        let surplus = self.pictures.len().saturating_sub(REMEMBERED);
        self.pictures.drain(..surplus);
    }

    /// Returns the mean time of a pass over the images that are kept, milliseconds.
    pub fn mean(&self, pass: usize) -> f32 {
        let sum: f32 = self.pictures.iter().filter_map(|picture| picture.get(pass)).sum();
        sum / self.pictures.len().max(1) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_kept_by_pass_and_their_number_is_limited() {
        let mut performance = Performance::default();
        performance.remember([("accumulate", 1.0)].into_iter());
        performance.remember([("depth_downsample", 2.0), ("accumulate", 3.0), ("accumulate", 1.0)].into_iter());
        assert_eq!(performance.names, ["accumulate", "depth_downsample"]);
        assert!((performance.mean(0) - 2.5).abs() < 1e-6 && (performance.mean(1) - 1.0).abs() < 1e-6);
        for _ in 0..3 * REMEMBERED {
            performance.remember([("accumulate", 7.0)].into_iter());
        }
        assert_eq!(performance.pictures.len(), REMEMBERED);
        assert!((performance.mean(0) - 7.0).abs() < 1e-4 && performance.mean(1) < 1e-6);
    }
}
