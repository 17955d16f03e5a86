//! Adaptive resolution: the image is drawn at a lower resolution while something moves, so that controls respond
//! quickly.

/// Longest frame, seconds. Leaves a margin to 15 frames per second, the least for direct manipulation.
const MAX_FRAME_SECONDS: f32 = 1.0 / 22.0;

/// The next finer image is tried if its estimated time is below this part of [`MAX_FRAME_SECONDS`].
const REFINE_MARGIN: f32 = 0.7;

/// Largest divisor: window pixels per image pixel, in each direction.
const MAX_DIVISOR: u32 = 4;

/// Number of fast frames before a finer image is tried. It doubles each time that the resolution is lowered.
const FRAMES_BEFORE_REFINE: u32 = 12;

/// Chooses the divisor of the image's sides. Plain data without a clock or a device.
#[derive(Clone, Debug, PartialEq)]
pub struct AdaptiveResolution {
    divisor: u32,
    /// Consecutive frames in which a finer image would have been fast enough.
    fast_frames: u32,
    frames_before_refine: u32,
}

impl Default for AdaptiveResolution {
    fn default() -> Self {
        Self { divisor: 1, fast_frames: 0, frames_before_refine: FRAMES_BEFORE_REFINE }
    }
}

impl AdaptiveResolution {
    pub fn divisor(&self) -> u32 {
        self.divisor
    }

    /// Restores the full resolution; nothing moves.
    pub fn reset(&mut self) {
        *self = Self::default();
    }

    /// Takes the duration of a frame while something moved, seconds.
    pub fn update(&mut self, seconds: f32) {
        if seconds > MAX_FRAME_SECONDS {
            if self.divisor < MAX_DIVISOR {
                // A very slow frame reaches the right divisor in one step, because the cost falls with the square of
                // the divisor.
                let wanted = (self.divisor as f32 * (seconds / MAX_FRAME_SECONDS).sqrt()).ceil() as u32;
                self.divisor = wanted.clamp(self.divisor + 1, MAX_DIVISOR);
                self.frames_before_refine = self.frames_before_refine.saturating_mul(2);
            }
            self.fast_frames = 0;
        } else if self.divisor > 1 {
            let finer = self.divisor as f32 / (self.divisor - 1) as f32;
            self.fast_frames =
                if seconds * finer * finer < REFINE_MARGIN * MAX_FRAME_SECONDS { self.fast_frames + 1 } else { 0 };
            if self.fast_frames >= self.frames_before_refine {
                self.divisor -= 1;
                self.fast_frames = 0;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Simulates frames whose load has a fixed part and a part that falls with the square of the divisor. Returns the
    /// divisor after each.
    fn run(resolution: &mut AdaptiveResolution, fixed: f32, whole: f32, frames: usize) -> Vec<u32> {
        let mut frame = || {
            resolution.update(fixed + whole / (resolution.divisor() * resolution.divisor()) as f32);
            resolution.divisor()
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
            let mut resolution = AdaptiveResolution::default();
            let divisors = run(&mut resolution, 0.008, whole, 2000);
            let found = divisors[2];
            let seconds = 0.008 + whole / (found * found) as f32;
            assert!(seconds <= MAX_FRAME_SECONDS || found == MAX_DIVISOR, "{whole} {found}");
            let changes = divisors[3..].windows(2).filter(|pair| pair[0] != pair[1]).count();
            assert_eq!(changes, 0, "{whole}");
        }
    }

    #[test]
    fn resolution_recovers_after_one_slow_frame_and_at_rest() {
        let mut resolution = AdaptiveResolution::default();
        resolution.update(0.4);
        assert_eq!(resolution.divisor(), MAX_DIVISOR.min(3));
        assert_eq!(run(&mut resolution, 0.002, 0.01, 200).last(), Some(&1));
        resolution.update(10.0);
        assert_eq!(resolution.divisor(), MAX_DIVISOR);
        // Still too slow at the largest divisor: it does not grow further.
        resolution.update(10.0);
        assert_eq!(resolution.divisor(), MAX_DIVISOR);
        resolution.reset();
        assert_eq!(resolution, AdaptiveResolution::default());
    }

    #[test]
    fn an_intermittent_load_is_retried_less_and_less_often() {
        let mut resolution = AdaptiveResolution::default();
        let changes = |divisors: Vec<u32>| divisors.windows(2).filter(|pair| pair[0] != pair[1]).count();
        let mut count = 0;
        for _ in 0..40 {
            count += changes(run(&mut resolution, 0.004, 0.06, 5));
            count += changes(run(&mut resolution, 0.004, 0.01, 40));
        }
        assert!(count < 12, "{count}");
    }
}
