//! Which scale of the accumulation target holds a budget of GPU time.

use super::table::settings;

settings! {
    /// What the smoke may cost, and what it may give up for it.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Budget {
        /// GPU time of the smoke that is held where a scale within the limits can.
        milliseconds: f32 = 2.0, number(0.05..=100.0, "ms");
        /// The finest scale that is chosen.
        min_scale: u32 = 1, integer(1..=16, "pixels");
        /// The coarsest: it is kept where none holds the budget.
        max_scale: u32 = 8, integer(|this| this.min_scale..=16, "pixels");
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
/// ```
/// # use haze::{Settings, Timing, settings::{Budget, ScaleBudget}};
/// # fn each_frame(timing: &Timing, seen: &mut u64, budget: &mut ScaleBudget, settings: &mut Settings) {
/// // A clock of 2 ms; each result of haze's timing goes in once.
/// if let Some(times) = timing.latest().filter(|times| times.frame > *seen) {
///     *seen = times.frame;
///     settings.accumulate.scale = budget.update(times.smoke_ms());
/// }
/// # }
/// ```
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
        if median > OVERLOAD * limit && self.scale < self.budget.max_scale {
            return self.coarser(median);
        }
        let before = self.seen.mean;
        let Some(mean) = self.seen.block(median) else { return };
        self.learn(mean);
        // Twice running: a load that just fits is not given up for noise.
        if mean.min(before) > limit && self.scale < self.budget.max_scale {
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
        let last = self.budget.max_scale.min(2 * self.scale);
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
        if let Some(scale) = (first.max(self.budget.min_scale)..self.scale).find(fits) {
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

    fn keep_within_limits(&mut self) {
        let min = self.budget.min_scale.max(1);
        let scale = self.scale.clamp(min, self.budget.max_scale.max(min));
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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Milliseconds at scale 1: what is fixed, and what falls with the scale.
    #[derive(Clone, Copy, Debug)]
    struct Load {
        fixed: f32,
        falling: f32,
    }

    impl Load {
        fn ms(self, scale: u32) -> f32 {
            self.fixed + self.falling / (scale * scale) as f32
        }
    }

    /// A host: it draws with the scale, and its times come some frames late.
    struct Host {
        chooser: ScaleBudget,
        in_flight: std::collections::VecDeque<f32>,
        seed: u32,
    }

    impl Host {
        fn new(budget: Budget, scale: u32) -> Self {
            Self { chooser: ScaleBudget::new(budget, scale), in_flight: [].into(), seed: 1 }
        }

        /// A frame, with even noise of so much either way.
        fn draw(&mut self, load: Load, noise: f32) -> u32 {
            self.seed = self.seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let noise = noise * ((self.seed >> 8) as f32 / (1 << 23) as f32 - 1.0);
            self.in_flight.push_back(load.ms(self.chooser.scale()) * (1.0 + noise));
            if self.in_flight.len() > 4 {
                self.chooser.update(self.in_flight.pop_front().unwrap());
            }
            self.chooser.scale()
        }

        /// The scales of so many frames, without repetition.
        fn scales(&mut self, frames: usize, mut load: impl FnMut(usize) -> Load, noise: f32) -> Vec<u32> {
            let mut scales: Vec<_> = (0..frames).map(|frame| self.draw(load(frame), noise)).collect();
            scales.dedup();
            scales
        }
    }

    fn budget(milliseconds: f32) -> Budget {
        Budget { milliseconds, min_scale: 1, max_scale: 16 }
    }

    /// How often a list of scales turns round.
    fn turns(scales: &[u32]) -> usize {
        let is_finer: Vec<_> = scales.windows(2).map(|pair| pair[1] < pair[0]).collect();
        is_finer.windows(2).filter(|pair| pair[0] != pair[1]).count()
    }

    proptest! {
        #[test]
        fn a_constant_load_settles_on_the_finest_scale_that_fits(
            fixed in 0.0_f32..4.0, falling in 0.0_f32..64.0, scale in 1_u32..=16, limits in (1_u32..=16, 1_u32..=16),
        ) {
            let (min_scale, max_scale) = (limits.0.min(limits.1), limits.0.max(limits.1));
            let load = Load { fixed: fixed.max(0.01), falling };
            let mut host = Host::new(Budget { milliseconds: 2.0, min_scale, max_scale }, scale);
            host.scales(4000, |_| load, 0.0);
            let settled = host.scales(1000, |_| load, 0.0);
            prop_assert_eq!(settled.len(), 1, "{:?}", settled);
            let settled = settled[0];
            prop_assert!((min_scale..=max_scale).contains(&settled));
            // f32 sums of 64.
            prop_assert!(load.ms(settled) <= 2.0 * 1.0001 || settled == max_scale, "{} ms at {settled}", load.ms(settled));
            let finer = load.ms(settled.max(2) - 1);
            prop_assert!(settled == min_scale || finer > ROOM * 2.0 * 0.999, "{finer} ms finer than {settled}");
        }

        #[test]
        fn noise_makes_no_oscillation(
            fixed in 0.0_f32..4.0, falling in 0.0_f32..64.0, scale in 1_u32..=16, seed in any::<u32>(),
        ) {
            let load = Load { fixed: fixed.max(0.01), falling };
            let mut host = Host { seed, ..Host::new(budget(2.0), scale) };
            host.scales(4000, |_| load, 0.2);
            let scales = host.scales(20_000, |_| load, 0.2);
            // Noise may take a scale across a threshold that it is near to, once.
            let [ms, finer_ms] = [scales[0], scales[0].max(2) - 1].map(|scale| load.ms(scale) / 2.0);
            let may_change = [ms, finer_ms].iter().any(|ms| (0.85 * ROOM..1.1).contains(ms));
            prop_assert!(turns(&scales) <= 1 && (scales.len() == 1 || may_change), "{:?}", scales);
            let last = *scales.last().unwrap();
            prop_assert!(load.ms(last) <= 2.0 * 1.05 || last == 16, "{} ms at {last}", load.ms(last));
        }

        #[test]
        fn a_load_that_jumps_is_answered_within_thirty_frames(
            ms in 1.0_f32..1.95, share in 0.2_f32..1.0, scale in 1_u32..=4, noise in 0.0_f32..0.2,
        ) {
            let at = |ms: f32| {
                let falling = ms * share * (scale * scale) as f32;
                Load { fixed: ms * (1.0 - share), falling }
            };
            let mut host = Host::new(Budget { min_scale: scale, ..budget(2.0) }, scale);
            prop_assert_eq!(host.scales(50, |_| at(ms), 0.0), [scale]);
            let scales = host.scales(30, |_| at(4.0 * ms), noise);
            prop_assert!(scales.len() > 1 && scales.windows(2).all(|pair| pair[1] <= 2 * pair[0]), "{:?}", scales);
            // Where half the resolution is enough, the budget is held by then.
            let last = *scales.last().unwrap();
            prop_assert!(at(4.0 * ms).ms(2 * scale) > 2.0 || at(4.0 * ms).ms(last) <= 2.0 * 1.25, "{:?}", scales);
        }
    }

    #[test]
    fn the_first_step_is_no_longer_than_it_must_be() {
        let mut host = Host::new(budget(2.0), 2);
        assert_eq!(host.scales(1000, |_| Load { fixed: 0.0, falling: 10.0 }, 0.0), [2, 3]);
        let mut host = Host::new(budget(2.0), 8);
        assert_eq!(host.scales(1000, |_| Load { fixed: 0.2, falling: 10.0 }, 0.0), [8, 7, 4, 3]);
    }

    #[test]
    fn what_gets_slower_and_faster_again_is_followed_one_way_at_a_time() {
        let mut host = Host::new(budget(2.0), 1);
        let at = |t: f32| Load { fixed: 0.2 * t, falling: t };
        let up = host.scales(4000, |frame| at(1.0 + frame as f32 / 400.0), 0.1);
        let down = host.scales(4000, |frame| at(11.0 - frame as f32 / 400.0), 0.1);
        assert!(turns(&up) == 0 && up.first() == Some(&1) && up.last() > Some(&3), "{up:?}");
        assert!(turns(&down) == 0, "{down:?}");
        assert_eq!(host.scales(2000, |_| at(1.0), 0.1).last(), Some(&1));
    }

    #[test]
    fn a_load_that_no_scale_changes_goes_to_a_limit() {
        let constant = |fixed| Load { fixed, falling: 0.0 };
        let mut host = Host::new(budget(2.0), 4);
        assert_eq!(host.scales(2000, |_| constant(3.0), 0.2).last(), Some(&16));
        assert_eq!(host.scales(2000, |_| constant(1.0), 0.2).last(), Some(&1));
    }

    #[test]
    fn a_load_that_comes_and_goes_is_not_followed_for_ever() {
        // Smoke that breathes, faster and slower than decisions are made.
        for period in [40.0, 120.0, 300.0, 600.0] {
            let mut host = Host::new(budget(2.0), 2);
            let load = |frame: usize| {
                let t = 1.5 * (1.0 + 0.5 * (frame as f32 * std::f32::consts::TAU / period).sin());
                Load { fixed: 0.3 * t, falling: 0.7 * t }
            };
            host.scales(6000, load, 0.1);
            let scales = host.scales(12_000, load, 0.1);
            // Once patience is longer than a breath, its peak is not forgotten in its trough.
            assert!(turns(&scales) <= 1, "{period}: {scales:?}");
        }
    }

    #[test]
    fn what_is_no_time_is_ignored() {
        let mut chooser = ScaleBudget::new(budget(2.0), 3);
        let fresh = chooser.clone();
        for nonsense in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, -0.0, -5.0] {
            assert!((0..200).all(|_| chooser.update(nonsense) == 3));
        }
        assert_eq!(chooser, fresh);
        // Nor do single frames that stand out count, in a load that fits: a driver compiles, a disk spins up.
        let mut chooser = ScaleBudget::new(budget(2.0), 1);
        assert!((0..2000).all(|frame| chooser.update(if frame % 4 == 0 { 50.0 } else { 1.9 }) == 1));
    }

    #[test]
    fn the_budget_may_be_changed_while_it_is_held() {
        let load = Load { fixed: 0.2, falling: 6.0 };
        let mut host = Host::new(budget(2.0), 1);
        assert_eq!(host.scales(2000, |_| load, 0.1).last(), Some(&2));
        host.chooser.budget.milliseconds = 8.0;
        assert_eq!(host.scales(500, |_| load, 0.1).last(), Some(&1));
        host.chooser.budget.min_scale = 5;
        assert_eq!(host.scales(500, |_| load, 0.1), [5]);
        // Limits and times that no budget should have are survived.
        host.chooser.budget = Budget { milliseconds: f32::NAN, min_scale: 9, max_scale: 0 };
        assert_eq!(host.scales(100, |_| load, 0.1).last(), Some(&9));
        host.chooser.budget.min_scale = 0;
        host.chooser.budget.milliseconds = -1.0;
        assert_eq!(host.scales(100, |_| load, 0.1).last(), Some(&1));
    }
}
