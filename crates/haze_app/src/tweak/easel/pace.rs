//! How coarsely the picture is drawn while something in it moves, so that hands are followed.

/// Longest that a frame should take, seconds: with room to the 15 a second that a hand can live with.
const LONGEST: f32 = 1.0 / 22.0;

/// Part of that which the next finer picture must be expected to stay below.
const ROOM: f32 = 0.7;

/// Most pixels of the window that one of the picture stands for, each way.
const COARSEST: u32 = 4;

/// Frames that are seen before a finer picture is tried, doubled each time that one does not last.
const PATIENCE: u32 = 12;

/// Picks by how many the sides of the picture are divided. Plain data: it knows neither a clock nor a device.
#[derive(Clone, Debug, PartialEq)]
pub struct Pace {
    divisor: u32,
    /// Frames that a finer picture could have been drawn in, one after the other.
    easy: u32,
    patience: u32,
}

impl Default for Pace {
    fn default() -> Self {
        Self { divisor: 1, easy: 0, patience: PATIENCE }
    }
}

impl Pace {
    pub fn divisor(&self) -> u32 {
        self.divisor
    }

    /// Everything stands still: the whole picture is drawn again.
    pub fn rest(&mut self) {
        *self = Self::default();
    }

    /// Takes how long a frame took while something moved, seconds.
    pub fn update(&mut self, seconds: f32) {
        if seconds > LONGEST {
            if self.divisor < COARSEST {
                // What is far too slow gets there in one step: the cost falls with the square.
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

    /// Frames of a load that has a fixed part and one that falls with the square; the divisor after each.
    fn run(pace: &mut Pace, fixed: f32, whole: f32, frames: usize) -> Vec<u32> {
        let mut frame = || {
            pace.update(fixed + whole / (pace.divisor() * pace.divisor()) as f32);
            pace.divisor()
        };
        (0..frames).map(|_| frame()).collect()
    }

    #[test]
    fn what_is_fast_enough_stays_whole() {
        assert!(run(&mut Pace::default(), 0.005, 0.03, 500).iter().all(|divisor| *divisor == 1));
    }

    #[test]
    fn what_is_too_slow_is_coarse_at_once_and_does_not_pump() {
        for whole in [0.06, 0.1, 0.2, 0.5] {
            let mut pace = Pace::default();
            let divisors = run(&mut pace, 0.008, whole, 2000);
            let found = divisors[2];
            let seconds = 0.008 + whole / (found * found) as f32;
            assert!(seconds <= LONGEST || found == COARSEST, "{whole} {found}");
            let changes = divisors[3..].windows(2).filter(|pair| pair[0] != pair[1]).count();
            assert_eq!(changes, 0, "{whole}");
        }
    }

    #[test]
    fn a_hitch_is_forgotten_and_rest_restores_the_picture() {
        let mut pace = Pace::default();
        pace.update(0.4);
        assert_eq!(pace.divisor(), COARSEST.min(3));
        assert_eq!(run(&mut pace, 0.002, 0.01, 200).last(), Some(&1));
        pace.update(10.0);
        assert_eq!(pace.divisor(), COARSEST);
        // Too slow even so: no further.
        pace.update(10.0);
        assert_eq!(pace.divisor(), COARSEST);
        pace.rest();
        assert_eq!(pace, Pace::default());
    }

    #[test]
    fn a_load_that_comes_and_goes_is_tried_less_and_less_often() {
        let mut pace = Pace::default();
        let changes = |divisors: Vec<u32>| divisors.windows(2).filter(|pair| pair[0] != pair[1]).count();
        let mut count = 0;
        for _ in 0..40 {
            count += changes(run(&mut pace, 0.004, 0.06, 5));
            count += changes(run(&mut pace, 0.004, 0.01, 40));
        }
        assert!(count < 12, "{count}");
    }
}
