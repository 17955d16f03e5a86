//! Which scale of the accumulation target holds a budget of GPU time.

use super::accumulate::COARSEST;
use super::table::settings;

settings! {
    /// What the smoke may cost, and what it may give up for it.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Budget {
        /// GPU time of the smoke that is held where a scale within the limits can.
        milliseconds: f32 = 2.0, number(0.05..=100.0, "ms");
        /// The finest scale that is chosen.
        min_scale: u32 = 1, integer(1..=COARSEST, "pixels");
        /// The coarsest: it is kept where none holds the budget.
        max_scale: u32 = 8, integer(|this| this.min_scale..=COARSEST, "pixels");
    }
}

/// Part of the budget that a finer scale must be expected to stay below. What is left is for what the expectation is wrong by: a
/// block's mean is off by up to 5 % where measurements are off by 20.
const ROOM: f32 = 0.85;

/// So many times the budget is far too much, and not waited for. More than noise of 20 % makes of the budget.
const OVERLOAD: f32 = 1.25;

/// Measurements that a median is taken of: two that stand out do not count.
const MEDIAN: usize = 5;

/// Measurements after a change that may be of frames before it: those in flight, and some.
const LATE: u32 = 8;

/// Measurements that a mean is taken of: a second.
const BLOCK: u32 = 64;

/// Blocks after which a finer scale is thought of, at first and at most: two seconds and 17.
const PATIENCE: u32 = 2;
const MAX_PATIENCE: u32 = 16;

/// Picks [`Accumulate::scale`](super::Accumulate::scale) from measured GPU time, so that a [`Budget`] is held. Plain data: it
/// knows neither a clock nor a device.
///
/// What is far too slow gets a coarser scale within a few measurements, what is a little too slow within two seconds; a
/// finer scale comes after two more, where it can be expected to take no more than 85 % of the budget. So a load that does
/// not change settles on one scale: that is the coarsest limit, or costs no more than the budget; and the next finer one
/// costs more than 85 % of it. A finer scale that does not last is tried half as often the next time, down to once in 17 seconds,
/// so that a load which comes and goes does not make the picture pump. (Times are those of 60 measurements a second.)
///
/// The cost of a scale is taken for a fixed part and one that falls with its square; how much is fixed is learned from each
/// change.
///
/// What is measured may be one system or all of them; they then share the scale. Systems that are compared with the host's own
/// depth ([`DepthSource::Host`](super::DepthSource::Host)) have no other scale than 1. `docs/recipes.md` has a host.
#[derive(Clone, Debug, PartialEq)]
pub struct ScaleBudget {
    /// May be changed at any time.
    pub budget: Budget,
    scale: u32,
    /// How much of the cost at scale 1 falls with the square of the scale, 0 to 1, where that was seen.
    share: Option<f32>,
    /// What the scale before took, until this one is known.
    before: Option<(u32, f32)>,
    /// True if this scale is finer than the one before.
    is_finer: bool,
    /// Blocks for which a finer scale must be within reach.
    patience: u32,
    seen: Seen,
}

/// What was measured at a scale.
#[derive(Clone, Debug, Default, PartialEq)]
struct Seen {
    measurements: u32,
    last: [f32; MEDIAN],
    /// Medians of the block that is not full yet.
    count: u32,
    sum: f32,
    blocks: u32,
    /// Mean of the last full block.
    mean: f32,
    /// The most that a block took since a finer scale was last thought of.
    peak: f32,
}

impl ScaleBudget {
    /// Starts from a scale, pixels per texel.
    pub fn new(budget: Budget, scale: u32) -> Self {
        let mut new = Self {
            budget,
            scale,
            share: None,
            before: None,
            is_finer: false,
            patience: PATIENCE,
            seen: Seen::default(),
        };
        new.keep_within_limits();
        new
    }

    /// The scale to draw with.
    pub fn scale(&self) -> u32 {
        self.scale
    }

    /// Takes the GPU time of a frame, milliseconds, and gives the scale to draw with. Call it once for each frame that was
    /// measured; results may come up to 8 frames late. What is not above 0 and finite is ignored.
    pub fn update(&mut self, measured_ms: f32) -> u32 {
        self.keep_within_limits();
        if measured_ms > 0.0
            && measured_ms.is_finite()
            && let Some(median) = self.seen.median(measured_ms)
        {
            self.decide(median);
        }
        self.scale
    }

    fn decide(&mut self, median: f32) {
        let limit = self.budget.milliseconds;
        let may_be_coarser = self.scale < self.limits().1;
        if median > OVERLOAD * limit && may_be_coarser {
            return self.coarser(median);
        }
        let before = self.seen.mean;
        let Some(mean) = self.seen.block(median) else { return };
        self.learn(mean);
        // Twice running: a load that just fits is not given up for noise.
        if mean.min(before) > limit && may_be_coarser {
            self.coarser(mean);
        } else if self.seen.blocks.is_multiple_of(self.patience) {
            self.finer(mean);
        }
    }

    /// Goes to the finest scale that fits, but to twice this one at most: what was learned may hold no more.
    fn coarser(&mut self, ms: f32) {
        self.learn(ms);
        if self.is_finer {
            let did_last = self.seen.blocks >= MAX_PATIENCE;
            self.patience = if did_last { PATIENCE } else { MAX_PATIENCE.min(2 * self.patience) };
        }
        let last = self.limits().1.min(2 * self.scale);
        // Not knowing better, all of it falls with the scale.
        let cost = |scale: &u32| ms * relative_cost(self.share.unwrap_or(1.0), self.scale, *scale);
        let scale = (self.scale + 1..=last).find(|scale| cost(scale) <= self.budget.milliseconds);
        self.go_to(scale.unwrap_or(last), ms);
    }

    /// Goes to the finest scale that leaves room, but to half of this one at most; stays where none does.
    fn finer(&mut self, ms: f32) {
        let peak = std::mem::take(&mut self.seen.peak);
        // Not knowing better, a finer scale is free; one step tells.
        let (share, first) = self.share.map_or((0.0, self.scale - 1), |share| (share, self.scale.div_ceil(2)));
        let fits = |scale: &u32| peak * relative_cost(share, self.scale, *scale) <= ROOM * self.budget.milliseconds;
        if let Some(scale) = (first.max(self.limits().0)..self.scale).find(fits) {
            self.go_to(scale, ms);
        }
    }

    fn go_to(&mut self, scale: u32, ms: f32) {
        self.before = Some((self.scale, ms));
        self.is_finer = scale < self.scale;
        self.scale = scale;
        self.seen = Seen::default();
    }

    /// Learns from what the scale before took and what this one takes how much falls with the scale.
    fn learn(&mut self, ms: f32) {
        let Some((scale, ms_before)) = self.before.take() else { return };
        let [before, now] = [scale, self.scale].map(|scale| 1.0 / (scale * scale) as f32);
        // Between nothing and all.
        let ratio = (ms / ms_before).clamp(f32::min(1.0, now / before), f32::max(1.0, now / before));
        self.share = Some((1.0 - ratio) / (1.0 - now - ratio * (1.0 - before)));
    }

    /// The budget's, made to be some.
    fn limits(&self) -> (u32, u32) {
        let min = self.budget.min_scale.clamp(1, COARSEST);
        (min, self.budget.max_scale.clamp(min, COARSEST))
    }

    fn keep_within_limits(&mut self) {
        let (min, max) = self.limits();
        let scale = self.scale.clamp(min, max);
        if scale != self.scale {
            (self.scale, self.before, self.is_finer, self.seen) = (scale, None, false, Seen::default());
        }
    }
}

impl Seen {
    /// Takes a measurement; gives the median of the last ones, once they are of this scale.
    fn median(&mut self, ms: f32) -> Option<f32> {
        self.last.rotate_left(1);
        self.last[MEDIAN - 1] = ms;
        self.measurements = self.measurements.saturating_add(1);
        let mut sorted = self.last;
        sorted.sort_by(f32::total_cmp);
        (self.measurements >= LATE + MEDIAN as u32).then_some(sorted[MEDIAN / 2])
    }

    /// Takes a median; gives the mean of a block with its last.
    fn block(&mut self, median: f32) -> Option<f32> {
        (self.sum, self.count) = (self.sum + median, self.count + 1);
        if self.count < BLOCK {
            return None;
        }
        self.mean = self.sum / BLOCK as f32;
        (self.sum, self.count, self.blocks) = (0.0, 0, self.blocks.saturating_add(1));
        self.peak = self.peak.max(self.mean);
        Some(self.mean)
    }
}

/// Cost at one scale over that at another: a share falls with the square.
fn relative_cost(share: f32, from: u32, to: u32) -> f32 {
    let cost = |scale: u32| 1.0 - share + share / (scale * scale) as f32;
    cost(to) / cost(from)
}
