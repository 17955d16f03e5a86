//! Adaptive resolution: the image is drawn at a lower resolution while something moves, so that controls respond
//! quickly.

/// Longest frame, seconds. Leaves a margin to 15 frames per second, the least for direct manipulation.
const LONGEST: f32 = 1.0 / 22.0;

/// The next finer image is tried if its estimated time is below this part of [`LONGEST`].
const ROOM: f32 = 0.7;

/// Largest divisor: window pixels per image pixel, in each direction.
const COARSEST: u32 = 4;

/// Number of fast frames before a finer image is tried. It doubles each time that the resolution is lowered.
const PATIENCE: u32 = 12;

/// Chooses the divisor of the image's sides. Plain data without a clock or a device.
#[derive(Clone, Debug, PartialEq)]
pub struct AdaptiveResolution {
    divisor: u32,
    /// Consecutive frames in which a finer image would have been fast enough.
    easy: u32,
    patience: u32,
}

impl Default for AdaptiveResolution {
    fn default() -> Self {
        Self { divisor: 1, easy: 0, patience: PATIENCE }
    }
}

impl AdaptiveResolution {
    pub fn divisor(&self) -> u32 {
        self.divisor
    }

    /// Restores the full resolution; nothing moves.
    pub fn rest(&mut self) {
        *self = Self::default();
    }

    /// Takes the duration of a frame while something moved, seconds.
    pub fn update(&mut self, seconds: f32) {
        if seconds > LONGEST {
            if self.divisor < COARSEST {
                // A very slow frame reaches the right divisor in one step, because the cost falls with the square of
                // the divisor.
                let wanted = (self.divisor as f32 * (seconds / LONGEST).sqrt()).ceil() as u32;
                self.divisor = wanted.clamp(self.divisor + 1, COARSEST);
                self.patience = self.patience.saturating_mul(2);
            }
            self.easy = 0;
        } else if self.divisor > 1 {
            let finer = self.divisor as f32 / (self.divisor - 1) as f32;
            self.easy = if seconds * finer * finer < ROOM * LONGEST { self.easy + 1 } else { 0 };
            if self.easy >= self.patience {
                self.divisor -= 1;
                self.easy = 0;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Simulates frames whose load has a fixed part and a part that falls with the square of the divisor. Returns the
    /// divisor after each.
    fn run(pace: &mut AdaptiveResolution, fixed: f32, whole: f32, frames: usize) -> Vec<u32> {
        let mut frame = || {
            pace.update(fixed + whole / (pace.divisor() * pace.divisor()) as f32);
            pace.divisor()
        };
        (0..frames).map(|_| frame()).collect()
    }

    #[test]
    fn a_fast_load_keeps_the_full_resolution() {
        assert!(run(&mut AdaptiveResolution::default(), 0.005, 0.03, 500).iter().all(|divisor| *divisor == 1));
    }

    #[test]
    fn a_slow_load_is_reduced_at_once_without_oscillation() {
        for whole in [0.06, 0.1, 0.2, 0.5] {
            let mut pace = AdaptiveResolution::default();
            let divisors = run(&mut pace, 0.008, whole, 2000);
            let found = divisors[2];
            let seconds = 0.008 + whole / (found * found) as f32;
            assert!(seconds <= LONGEST || found == COARSEST, "{whole} {found}");
            let changes = divisors[3..].windows(2).filter(|pair| pair[0] != pair[1]).count();
            assert_eq!(changes, 0, "{whole}");
        }
    }

    #[test]
    fn resolution_recovers_after_one_slow_frame_and_at_rest() {
        let mut pace = AdaptiveResolution::default();
        pace.update(0.4);
        assert_eq!(pace.divisor(), COARSEST.min(3));
        assert_eq!(run(&mut pace, 0.002, 0.01, 200).last(), Some(&1));
        pace.update(10.0);
        assert_eq!(pace.divisor(), COARSEST);
        // Still too slow at the largest divisor: it does not grow further.
        pace.update(10.0);
        assert_eq!(pace.divisor(), COARSEST);
        pace.rest();
        assert_eq!(pace, AdaptiveResolution::default());
    }

    #[test]
    fn an_intermittent_load_is_retried_less_and_less_often() {
        let mut pace = AdaptiveResolution::default();
        let changes = |divisors: Vec<u32>| divisors.windows(2).filter(|pair| pair[0] != pair[1]).count();
        let mut count = 0;
        for _ in 0..40 {
            count += changes(run(&mut pace, 0.004, 0.06, 5));
            count += changes(run(&mut pace, 0.004, 0.01, 40));
        }
        assert!(count < 12, "{count}");
    }
}
