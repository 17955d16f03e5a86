//! Stages of the strip that are still to be drawn.

use haze_core::settings::DebugView;
use haze_export::debug_view_sheet::DEBUG_VIEWS;

/// Stages to draw, at most one in a frame, and none while the user holds something: where the CPU draws, all together take
/// several times as long as the image.
#[derive(Default)]
pub struct StageQueue {
    due: Vec<DebugView>,
    is_touched: bool,
    /// A stage was drawn in this frame.
    has_drawn: bool,
}

impl StageQueue {
    /// Call at the beginning of a frame. `is_touched`: the user holds a button.
    pub fn begin_frame(&mut self, is_touched: bool) {
        self.is_touched = is_touched;
        self.has_drawn = false;
    }

    /// Begins anew: the smoke has changed.
    pub fn restart(&mut self) {
        self.due = DEBUG_VIEWS.map(|(view, _)| view).into();
    }

    /// Takes a stage from the queue. Returns false if it is not due, or has to wait for the next frame.
    pub fn take(&mut self, view: DebugView) -> bool {
        if self.has_drawn || self.is_touched {
            return false;
        }
        let before = self.due.len();
        self.due.retain(|due| *due != view);
        self.has_drawn = self.due.len() < before;
        self.has_drawn
    }

    pub fn is_empty(&self) -> bool {
        self.due.is_empty()
    }

    /// Returns true if another frame is needed.
    pub fn wants_frame(&self) -> bool {
        !self.due.is_empty() && !self.is_touched
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_draws_one_stage_unless_it_is_touched_and_all_come_once() {
        let mut queue = StageQueue::default();
        queue.restart();
        let mut drawn = Vec::new();
        while !queue.is_empty() {
            queue.begin_frame(true);
            assert!(!queue.take(DEBUG_VIEWS[drawn.len()].0) && !queue.wants_frame());
            queue.begin_frame(false);
            let of_frame: Vec<_> = DEBUG_VIEWS.iter().map(|(view, _)| *view).filter(|view| queue.take(*view)).collect();
            assert_eq!(of_frame.len(), 1);
            drawn.extend(of_frame);
        }
        assert_eq!(drawn, DEBUG_VIEWS.map(|(view, _)| view));
        queue.begin_frame(false);
        assert!(!queue.take(DebugView::Final));
    }
}
