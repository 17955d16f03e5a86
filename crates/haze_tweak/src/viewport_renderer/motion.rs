//! Frame times while something moves.

use super::adaptive_resolution::AdaptiveResolution;
use crate::platform::clock::{self, Instant};

/// Reports frame times to [`AdaptiveResolution`], for frames in which something moves and the image is drawn.
#[derive(Default)]
pub struct MotionTimer {
    pub resolution: AdaptiveResolution,
    is_moving: bool,
    /// Start of the last frame, and whether the image was drawn in it.
    last: Option<Instant>,
    drew: bool,
}

impl MotionTimer {
    /// Call at the beginning of a frame.
    pub fn begin_frame(&mut self, is_moving: bool) {
        let last = self.last.replace(clock::now());
        let drew = std::mem::take(&mut self.drew);
        if !is_moving {
            self.resolution.reset();
        } else if let Some(last) = last.filter(|_| drew && self.is_moving) {
            self.resolution.update(last.elapsed().as_secs_f32());
        }
        self.is_moving = is_moving;
    }

    /// Call when the image is drawn.
    pub fn draw(&mut self) {
        self.drew = true;
    }

    pub fn is_moving(&self) -> bool {
        self.is_moving
    }

    /// Returns true if another frame is needed to know the duration of this one.
    pub fn wants_next(&self) -> bool {
        self.drew && self.is_moving
    }
}
