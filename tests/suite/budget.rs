//! `ScaleBudget` under loads of every kind, driven as by a host.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use haze_core::settings::{Budget, ScaleBudget};
use proptest::prelude::*;

/// Fraction of the budget that the time at a finer scale must stay below.
const HEADROOM: f32 = 0.85;

/// Milliseconds at scale 1: a fixed part, and a part that falls with the square of the scale.
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

/// A host that renders at the chosen scale and gets its times some frames late.
struct Host {
    chooser: ScaleBudget,
    in_flight: std::collections::VecDeque<f32>,
    seed: u32,
}

impl Host {
    fn new(budget: Budget, scale: u32) -> Self {
        Self { chooser: ScaleBudget::new(budget, scale), in_flight: [].into(), seed: 1 }
    }

    /// Renders a frame, with uniform noise of up to this fraction of its time either way.
    fn draw(&mut self, load: Load, noise: f32) -> u32 {
        self.seed = self.seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let noise = noise * ((self.seed >> 8) as f32 / (1 << 23) as f32 - 1.0);
        self.in_flight.push_back(load.ms(self.chooser.scale()) * (1.0 + noise));
        if self.in_flight.len() > 4 {
            self.chooser.update(self.in_flight.pop_front().unwrap());
        }
        self.chooser.scale()
    }

    /// Returns the scales of so many frames, without consecutive repetitions.
    fn scales(&mut self, frames: usize, mut load: impl FnMut(usize) -> Load, noise: f32) -> Vec<u32> {
        let mut scales: Vec<_> = (0..frames).map(|frame| self.draw(load(frame), noise)).collect();
        scales.dedup();
        scales
    }
}

fn budget(milliseconds: f32) -> Budget {
    Budget { milliseconds, min_scale: 1, max_scale: 16 }
}

/// Counts how often a list of scales changes direction.
fn reversals(scales: &[u32]) -> usize {
    let is_finer: Vec<_> = scales.windows(2).map(|pair| pair[1] < pair[0]).collect();
    is_finer.windows(2).filter(|pair| pair[0] != pair[1]).count()
}

proptest! {
    #[test]
    fn a_constant_load_settles_on_the_finest_scale_that_fits(
        fixed in 0.0_f32..4.0, falling in 0.0_f32..64.0, scale in 1_u32..=16, limits in (1_u32..=16, 1_u32..=16),
    ) {
        let min_scale = limits.0.min(limits.1);
        let max_scale = limits.0.max(limits.1);
        let load = Load { fixed: fixed.max(0.01), falling };
        let mut host = Host::new(Budget { milliseconds: 2.0, min_scale, max_scale }, scale);
        host.scales(4000, |_| load, 0.0);
        let settled = host.scales(1000, |_| load, 0.0);
        prop_assert_eq!(settled.len(), 1, "{:?}", settled);
        let settled = settled[0];
        prop_assert!((min_scale..=max_scale).contains(&settled));
        // Tolerance for f32 sums of 64 times.
        prop_assert!(load.ms(settled) <= 2.0 * 1.0001 || settled == max_scale, "{} ms at {settled}", load.ms(settled));
        let finer = load.ms(settled.max(2) - 1);
        prop_assert!(settled == min_scale || finer > HEADROOM * 2.0 * 0.999, "{finer} ms finer than {settled}");
    }

    #[test]
    fn noise_causes_no_oscillation(
        fixed in 0.0_f32..4.0, falling in 0.0_f32..64.0, scale in 1_u32..=16, seed in any::<u32>(),
    ) {
        let load = Load { fixed: fixed.max(0.01), falling };
        let mut host = Host { seed, ..Host::new(budget(2.0), scale) };
        host.scales(4000, |_| load, 0.2);
        let scales = host.scales(20_000, |_| load, 0.2);
        // Noise may cross a threshold that is near, once.
        let [ms, finer_ms] = [scales[0], scales[0].max(2) - 1].map(|scale| load.ms(scale) / 2.0);
        let may_change = [ms, finer_ms].iter().any(|ms| (0.85 * HEADROOM..1.1).contains(ms));
        prop_assert!(reversals(&scales) <= 1 && (scales.len() == 1 || may_change), "{:?}", scales);
        let last = *scales.last().unwrap();
        prop_assert!(load.ms(last) <= 2.0 * 1.05 || last == 16, "{} ms at {last}", load.ms(last));
    }

    #[test]
    fn a_load_that_jumps_is_answered_within_thirty_frames(
        ms in 1.0_f32..1.95, fraction in 0.2_f32..1.0, scale in 1_u32..=4, noise in 0.0_f32..0.2,
    ) {
        let at = |ms: f32| {
            let falling = ms * fraction * (scale * scale) as f32;
            Load { fixed: ms * (1.0 - fraction), falling }
        };
        let mut host = Host::new(Budget { min_scale: scale, ..budget(2.0) }, scale);
        prop_assert_eq!(host.scales(50, |_| at(ms), 0.0), [scale]);
        let scales = host.scales(30, |_| at(4.0 * ms), noise);
        prop_assert!(scales.len() > 1 && scales.windows(2).all(|pair| pair[1] <= 2 * pair[0]), "{:?}", scales);
        // If half the resolution is enough, the budget is held by then.
        let last = *scales.last().unwrap();
        prop_assert!(at(4.0 * ms).ms(2 * scale) > 2.0 || at(4.0 * ms).ms(last) <= 2.0 * 1.25, "{:?}", scales);
    }
}

#[test]
fn the_first_step_is_no_larger_than_needed() {
    let mut host = Host::new(budget(2.0), 2);
    assert_eq!(host.scales(1000, |_| Load { fixed: 0.0, falling: 10.0 }, 0.0), [2, 3]);
    let mut host = Host::new(budget(2.0), 8);
    assert_eq!(host.scales(1000, |_| Load { fixed: 0.2, falling: 10.0 }, 0.0), [8, 7, 4, 3]);
}

#[test]
fn a_slowly_changing_load_is_followed_without_reversals() {
    let mut host = Host::new(budget(2.0), 1);
    let at = |t: f32| Load { fixed: 0.2 * t, falling: t };
    let up = host.scales(4000, |frame| at(1.0 + frame as f32 / 400.0), 0.1);
    let down = host.scales(4000, |frame| at(11.0 - frame as f32 / 400.0), 0.1);
    assert!(reversals(&up) == 0 && up.first() == Some(&1) && up.last() > Some(&3), "{up:?}");
    assert!(reversals(&down) == 0, "{down:?}");
    assert_eq!(host.scales(2000, |_| at(1.0), 0.1).last(), Some(&1));
}

#[test]
fn a_load_that_no_scale_changes_ends_at_a_limit() {
    let constant = |fixed| Load { fixed, falling: 0.0 };
    let mut host = Host::new(budget(2.0), 4);
    assert_eq!(host.scales(2000, |_| constant(3.0), 0.2).last(), Some(&16));
    assert_eq!(host.scales(2000, |_| constant(1.0), 0.2).last(), Some(&1));
}

#[test]
fn a_periodic_load_is_not_followed_for_ever() {
    // A load that oscillates faster and slower than decisions are made.
    for period in [40.0, 120.0, 300.0, 600.0] {
        let mut host = Host::new(budget(2.0), 2);
        let load = |frame: usize| {
            let t = 1.5 * (1.0 + 0.5 * (frame as f32 * std::f32::consts::TAU / period).sin());
            Load { fixed: 0.3 * t, falling: 0.7 * t }
        };
        host.scales(6000, load, 0.1);
        let scales = host.scales(12_000, load, 0.1);
        // Once the chooser waits longer than a period, it still knows the peak in the trough.
        assert!(reversals(&scales) <= 1, "{period}: {scales:?}");
    }
}

#[test]
fn invalid_times_are_ignored() {
    let mut chooser = ScaleBudget::new(budget(2.0), 3);
    let fresh = chooser.clone();
    for nonsense in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, -0.0, -5.0] {
        assert!((0..200).all(|_| chooser.update(nonsense) == 3));
    }
    assert_eq!(chooser, fresh);
    // Single outliers in a load that fits do not count either: a driver that compiles, a disk that spins up.
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
    // Invalid limits and times are tolerated.
    host.chooser.budget = Budget { milliseconds: f32::NAN, min_scale: 9, max_scale: 0 };
    assert_eq!(host.scales(100, |_| load, 0.1).last(), Some(&9));
    host.chooser.budget.min_scale = 0;
    host.chooser.budget.milliseconds = -1.0;
    assert_eq!(host.scales(100, |_| load, 0.1).last(), Some(&1));
    host.chooser.budget.max_scale = u32::MAX;
    assert_eq!(host.scales(1000, |_| Load { fixed: f32::MAX, falling: 0.0 }, 0.0).last(), Some(&16));
}
