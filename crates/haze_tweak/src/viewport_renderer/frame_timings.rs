//! Time of the smoke of the image, and the accumulation scale that keeps it within a budget.

use std::collections::VecDeque;

use haze_author::preset::Tooltips;
use haze_core::settings::{Budget, ScaleBudget};
use haze_preset::Preset;

use super::smoke_times::{SmokeTimes, TimeSource};
use super::{RenderStats, ViewportRenderer};

/// Number of images whose times are kept.
pub const MAX_KEPT_IMAGES: usize = 200;

/// Number of frames for which a result may still arrive after the image was drawn.
const MAX_DELAY_FRAMES: u32 = 8;

/// Data of the performance tab. Nothing is measured unless the tab is visible or a budget is held.
pub struct FrameTimings {
    /// Budget for the smoke.
    pub budget: Budget,
    /// The budget is enforced through the scale of the shown image. The preset does not change.
    pub is_held: bool,
    pub tooltips: Tooltips,
    /// Times of each image in milliseconds, indexed like `names`; the oldest first.
    pub frame_times: VecDeque<Vec<f32>>,
    /// Names of the passes, in the order of the frame.
    pub names: Vec<&'static str>,
    pub stats: RenderStats,
    scale_budget: Option<ScaleBudget>,
    /// Frame of the latest result; `waiting` counts down the frames in which another may arrive.
    latest_frame: Option<u64>,
    waiting: u32,
}

/// Name of the only entry where the smoke cannot be timed.
const CPU_TIME: &str = "CPU time of the frame";
impl Default for FrameTimings {
    fn default() -> Self {
        Self {
            budget: Budget::default(),
            is_held: false,
            tooltips: Tooltips::of::<Budget>(),
            frame_times: VecDeque::new(),
            names: Vec::new(),
            stats: RenderStats::default(),
            scale_budget: None,
            latest_frame: None,
            waiting: 0,
        }
    }
}

impl FrameTimings {
    /// Call once a frame, after the panels. `cpu_seconds`: CPU time of the previous frame. Returns true if another
    /// frame is needed.
    pub fn follow(
        &mut self,
        renderer: &ViewportRenderer,
        is_seen: bool,
        cpu_seconds: Option<f32>,
        preset: &Preset,
    ) -> bool {
        let is_on = is_seen || self.is_held;
        renderer.measure(is_on);
        if !is_on {
            self.scale_budget = None;
            self.waiting = 0;
            self.frame_times.clear();
            renderer.show_scale(None);
            return false;
        }
        let before = std::mem::replace(&mut self.stats, renderer.render_stats());
        let is_drawn = self.stats.renders != before.renders;
        let is_second_drawn = self.stats.comparison_renders != before.comparison_renders;
        let times = self.stats.times.take().filter(|times| self.latest_frame.replace(times.frame) != Some(times.frame));
        self.waiting = if is_drawn || is_second_drawn { MAX_DELAY_FRAMES } else { self.waiting.saturating_sub(1) };
        if let Some(times) = &times {
            self.add_times(times.passes.iter().copied());
        } else if self.stats.time_source == TimeSource::CpuTime && is_drawn {
            self.add_times(cpu_seconds.map(|seconds| (CPU_TIME, 1.0e3 * seconds)).into_iter());
        }
        if !self.is_held {
            self.scale_budget = None;
        } else if renderer.divisor() == 1 {
            self.hold_budget(renderer, times.as_ref(), preset);
        }
        renderer.show_scale(self.scale());
        self.waiting > 0
    }

    /// Returns the scale that enforces the budget, if one is held.
    pub fn scale(&self) -> Option<u32> {
        self.scale_budget.as_ref().map(ScaleBudget::scale)
    }

    fn hold_budget(&mut self, renderer: &ViewportRenderer, times: Option<&SmokeTimes>, preset: &Preset) {
        let of_preset = preset.systems.first().map_or(1, |system| system.settings.accumulate.downscale);
        let scale_budget = self.scale_budget.get_or_insert_with(|| ScaleBudget::new(self.budget, of_preset));
        scale_budget.budget = self.budget;
        let Some(ms) = times.map(SmokeTimes::sum_ms) else { return };
        let scale = scale_budget.update(ms);
        // A still image is drawn again until it is within the budget or the scale has reached its limit.
        if ms > self.budget.milliseconds && scale < self.budget.max_scale {
            renderer.draw_again();
            self.waiting = MAX_DELAY_FRAMES;
        }
    }

    fn add_times(&mut self, parts: impl Iterator<Item = (&'static str, f32)>) {
        let mut image = vec![0.0; self.names.len()];
        for (name, ms) in parts {
            let at = self.names.iter().position(|known| *known == name).unwrap_or_else(|| {
                self.names.push(name);
                image.push(0.0);
                image.len() - 1
            });
            image[at] += ms;
        }
        self.frame_times.push_back(image);
        let surplus = self.frame_times.len().saturating_sub(MAX_KEPT_IMAGES);
        self.frame_times.drain(..surplus);
    }

    /// Returns the mean time of a pass over the images that are kept, milliseconds.
    pub fn mean(&self, pass: usize) -> f32 {
        let sum: f32 = self.frame_times.iter().filter_map(|image| image.get(pass)).sum();
        sum / self.frame_times.len().max(1) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_kept_by_pass_and_their_number_is_limited() {
        let mut timings = FrameTimings::default();
        timings.add_times([("accumulate", 1.0)].into_iter());
        timings.add_times([("depth_downsample", 2.0), ("accumulate", 3.0), ("accumulate", 1.0)].into_iter());
        assert_eq!(timings.names, ["accumulate", "depth_downsample"]);
        assert!((timings.mean(0) - 2.5).abs() < 1e-6 && (timings.mean(1) - 1.0).abs() < 1e-6);
        for _ in 0..3 * MAX_KEPT_IMAGES {
            timings.add_times([("accumulate", 7.0)].into_iter());
        }
        assert_eq!(timings.frame_times.len(), MAX_KEPT_IMAGES);
        assert!((timings.mean(0) - 7.0).abs() < 1e-4 && timings.mean(1) < 1e-6);
    }
}
