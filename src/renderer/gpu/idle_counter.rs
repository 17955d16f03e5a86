//! Delayed release of memory: memory that was needed once may be needed again soon.

/// Frames for which memory must have been too large or unused before it is released: 2 s at 60 frames per second.
const RELEASE_DELAY_FRAMES: u32 = 120;

/// Counts consecutive frames in which memory was too large or unused.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct IdleCounter {
    frames: u32,
}

impl IdleCounter {
    /// Counts one more frame. Returns true once the memory should be released.
    pub fn tick(&mut self, is_idle: bool) -> bool {
        self.frames = if is_idle { self.frames + 1 } else { 0 };
        self.frames > RELEASE_DELAY_FRAMES
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_is_released_only_after_enough_consecutive_spare_frames() {
        let mut idle = IdleCounter::default();
        assert!((0..RELEASE_DELAY_FRAMES).all(|_| !idle.tick(true)));
        assert!(!idle.tick(false) && !idle.tick(true));
        assert!((1..RELEASE_DELAY_FRAMES).all(|_| !idle.tick(true)));
        assert!(idle.tick(true));
    }
}
