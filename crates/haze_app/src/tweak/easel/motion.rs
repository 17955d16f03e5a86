//! What is known of frames in which something moves.

use super::pace::Pace;
use crate::tweak::platform::clock::Instant;

/// Tells the pace how long frames take in which something moves and the picture is drawn.
#[derive(Default)]
pub struct Motion {
    pub pace: Pace,
    is_moving: bool,
    /// When the last frame began, and whether it drew the picture.
    last: Option<Instant>,
    drew: bool,
}

impl Motion {
    /// To be called at the beginning of a frame.
    pub fn begin_frame(&mut self, is_moving: bool) {
        let last = self.last.replace(Instant::now());
        let drew = std::mem::take(&mut self.drew);
        if !is_moving {
            self.pace.rest();
        } else if let Some(last) = last.filter(|_| drew && self.is_moving) {
            self.pace.update(last.elapsed().as_secs_f32());
        }
        self.is_moving = is_moving;
    }

    /// To be called when the picture is drawn.
    pub fn draw(&mut self) {
        self.drew = true;
    }

    pub fn is_moving(&self) -> bool {
        self.is_moving
    }

    /// The time to the next frame will tell what this one takes.
    pub fn wants_next(&self) -> bool {
        self.drew && self.is_moving
    }
}
