//! Choice of the accumulation target's scale by a budget of GPU time.

use super::accumulate::MAX_SCALE;
use super::settings_macro::settings;

settings! {
    /// GPU time that the smoke may take, and the scales that it may use to stay within it.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Budget {
        /// GPU time of the smoke per frame. Lower: cheaper and less sharp. It is kept as far as the scales allow.
        milliseconds: f32 = 2.0, number(0.05..=100.0, "ms");
        /// Finest scale that may be chosen. Lower: sharper smoke when there is time for it.
        min_scale: u32 = 1, integer(1..=MAX_SCALE, "pixels");
        /// Coarsest scale that may be chosen. It is used even if it takes longer than the budget.
        max_scale: u32 = 8, integer(|this| this.min_scale..=MAX_SCALE, "pixels");
    }
}

/// Fraction of the budget that the expected cost of a finer scale must stay below. The rest is a margin for the error of
/// the estimate: if measurements are off by 20 %, the mean of a block is off by up to 5 %.
const FINER_SCALE_FRACTION: f32 = 0.85;

/// A median above this multiple of the budget makes the scale coarser at once. Noise of 20 % on a load at the budget
/// stays below it.
const OVERLOAD: f32 = 1.25;

/// Number of measurements in a median: two outliers do not affect it.
const MEDIAN: usize = 5;

/// Number of measurements to skip after a change of scale, because they may belong to frames in flight.
const STALE_MEASUREMENTS: u32 = 8;

/// Number of measurements that one mean is taken over: one second.
const BLOCK: u32 = 64;

/// Number of blocks between attempts at a finer scale, at first and at most: two seconds and 17.
const FINER_INTERVAL: u32 = 2;
const MAX_FINER_INTERVAL: u32 = 16;

/// Picks [`Accumulate::downscale`](super::Accumulate::downscale) from measured GPU time, so that a [`Budget`] is kept. Plain
/// data, without a clock or a device.
///
/// A scale that is far too slow becomes coarser within a few measurements, one that is a little too slow within two
/// seconds. A finer scale is tried after two more seconds, if its expected cost is at most 85 % of the budget. A
/// constant load therefore settles on one scale, which is the coarsest limit or costs no more than the budget, and of
/// which the next finer one costs more than 85 % of it. If a finer scale soon has to be given up again, the next
/// attempt waits twice as long, up to 17 seconds, so that a load that comes and goes does not make the image pulse.
/// (Times are for 60 measurements a second.)
///
/// The cost is modelled as a fixed part and a part that falls with the square of the scale. Their ratio is learned from
/// each change of scale.
///
/// The measurements may be of one system, or of all systems, which then share the scale. Systems that are compared with
/// the host's own depth ([`DepthSource::Host`](super::DepthSource::Host)) support scale 1 only, and those whose
/// `scale_mode` is `auto` choose their own. `docs/recipes.md` has an example host.
#[derive(Clone, Debug, PartialEq)]
pub struct ScaleBudget {
    /// May be changed at any time.
    pub budget: Budget,
    scale: u32,
    /// Fraction of the cost at scale 1 that falls with the square of the scale, 0 to 1. `None` until it has been measured.
    fraction: Option<f32>,
    /// Previous scale and its cost, milliseconds, until the cost of the current one is known.
    before: Option<(u32, f32)>,
    /// True if the current scale is finer than the previous one.
    is_finer: bool,
    /// Blocks between attempts at a finer scale.
    finer_interval: u32,
    statistics: ScaleStatistics,
}

/// Measurements at the current scale.
#[derive(Clone, Debug, Default, PartialEq)]
struct ScaleStatistics {
    measurements: u32,
    last: [f32; MEDIAN],
    /// Medians in the current block, which is not full yet.
    count: u32,
    sum: f32,
    blocks: u32,
    /// Mean of the last full block.
    mean: f32,
    /// Largest mean of a block since the last attempt at a finer scale.
    peak: f32,
}

impl ScaleBudget {
    /// Starts from a scale, pixels per texel, clamped to the limits of the budget.
    pub fn new(budget: Budget, scale: u32) -> Self {
        let mut new = Self {
            budget,
            scale,
            fraction: None,
            before: None,
            is_finer: false,
            finer_interval: FINER_INTERVAL,
            statistics: ScaleStatistics::default(),
        };
        new.keep_within_limits();
        new
    }

    /// Scale to draw with, pixels per texel.
    pub fn scale(&self) -> u32 {
        self.scale
    }

    /// Takes the GPU time of a frame, milliseconds, and returns the scale to draw with. Call it once for each measured
    /// frame; results may come up to 8 frames late. Values that are not above 0 and finite are ignored.
    pub fn update(&mut self, measured_ms: f32) -> u32 {
        self.keep_within_limits();
        if measured_ms > 0.0
            && measured_ms.is_finite()
            && let Some(median) = self.statistics.median(measured_ms)
        {
            self.decide(median);
        }
        self.scale
    }

    fn decide(&mut self, median: f32) {
        let limit = self.budget.milliseconds;
        let may_be_coarser = self.scale < self.limits().1;
        if median > OVERLOAD * limit && may_be_coarser {
            return self.go_coarser(median);
        }
        let before = self.statistics.mean;
        let Some(mean) = self.statistics.block(median) else { return };
        self.learn_fraction(mean);
        // Two blocks in a row: noise does not end a scale that just fits.
        if mean.min(before) > limit && may_be_coarser {
            self.go_coarser(mean);
        } else if self.statistics.blocks.is_multiple_of(self.finer_interval) {
            self.try_finer(mean);
        }
    }

    /// Goes to the finest scale that is expected to fit, but to twice the current one at most, because the learned
    /// fraction may not hold beyond.
    fn go_coarser(&mut self, ms: f32) {
        self.learn_fraction(ms);
        if self.is_finer {
            let did_last = self.statistics.blocks >= MAX_FINER_INTERVAL;
            self.finer_interval =
                if did_last { FINER_INTERVAL } else { MAX_FINER_INTERVAL.min(2 * self.finer_interval) };
        }
        let last = self.limits().1.min(2 * self.scale);
        // If the fraction is unknown, all of the cost is taken to fall with the scale.
        let cost = |scale: &u32| ms * relative_cost(self.fraction.unwrap_or(1.0), self.scale, *scale);
        let scale = (self.scale + 1..=last).find(|scale| cost(scale) <= self.budget.milliseconds);
        self.go_to(scale.unwrap_or(last), ms);
    }

    /// Goes to the finest scale that is expected to leave a margin, but to half of the current one at most. Stays if
    /// there is none.
    fn try_finer(&mut self, ms: f32) {
        let peak = std::mem::take(&mut self.statistics.peak);
        // If the fraction is unknown, a finer scale is taken to be free, and a single step measures it.
        let (fraction, first) =
            self.fraction.map_or((0.0, self.scale - 1), |fraction| (fraction, self.scale.div_ceil(2)));
        let fits = |scale: &u32| {
            peak * relative_cost(fraction, self.scale, *scale) <= FINER_SCALE_FRACTION * self.budget.milliseconds
        };
        if let Some(scale) = (first.max(self.limits().0)..self.scale).find(fits) {
            self.go_to(scale, ms);
        }
    }

    fn go_to(&mut self, scale: u32, ms: f32) {
        self.before = Some((self.scale, ms));
        self.is_finer = scale < self.scale;
        self.scale = scale;
        self.statistics = ScaleStatistics::default();
    }

    /// Learns the fraction of the cost that falls with the scale, from the costs of the previous scale and the current
    /// one.
    fn learn_fraction(&mut self, ms: f32) {
        let Some((scale, ms_before)) = self.before.take() else { return };
        let [before, now] = [scale, self.scale].map(|scale| 1.0 / (scale * scale) as f32);
        // Between no dependence on the scale and full dependence.
        let ratio = (ms / ms_before).clamp(f32::min(1.0, now / before), f32::max(1.0, now / before));
        self.fraction = Some((1.0 - ratio) / (1.0 - now - ratio * (1.0 - before)));
    }

    /// Scale limits of the budget, made valid.
    fn limits(&self) -> (u32, u32) {
        let min = self.budget.min_scale.clamp(1, MAX_SCALE);
        (min, self.budget.max_scale.clamp(min, MAX_SCALE))
    }

    fn keep_within_limits(&mut self) {
        let (min, max) = self.limits();
        let scale = self.scale.clamp(min, max);
        if scale != self.scale {
            self.scale = scale;
            self.before = None;
            self.is_finer = false;
            self.statistics = ScaleStatistics::default();
        }
    }
}

impl ScaleStatistics {
    /// Takes a measurement. Returns the median of the last ones, or `None` while they may belong to another scale.
    fn median(&mut self, ms: f32) -> Option<f32> {
        self.last.rotate_left(1);
        self.last[MEDIAN - 1] = ms;
        self.measurements = self.measurements.saturating_add(1);
        let mut sorted = self.last;
        sorted.sort_by(f32::total_cmp);
        (self.measurements >= STALE_MEASUREMENTS + MEDIAN as u32).then_some(sorted[MEDIAN / 2])
    }

    /// Takes a median. Returns the mean of the block if this one completes it.
    fn block(&mut self, median: f32) -> Option<f32> {
        self.sum += median;
        self.count += 1;
        if self.count < BLOCK {
            return None;
        }
        self.mean = self.sum / BLOCK as f32;
        self.sum = 0.0;
        self.count = 0;
        self.blocks = self.blocks.saturating_add(1);
        self.peak = self.peak.max(self.mean);
        Some(self.mean)
    }
}

/// Cost at scale `to` relative to the cost at `from`, if `fraction` of it falls with the square of the scale.
fn relative_cost(fraction: f32, from: u32, to: u32) -> f32 {
    let cost = |scale: u32| 1.0 - fraction + fraction / (scale * scale) as f32;
    cost(to) / cost(from)
}
