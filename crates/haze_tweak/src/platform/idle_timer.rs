//! Pauses of the user, which leave time for work that can wait.

use eframe::egui::{self, Vec2};

use super::clock::{self, Duration, Instant};

/// Time without input that counts as a pause.
const PAUSE: Duration = Duration::from_millis(300);

/// Time since the user last did something.
#[derive(Clone, Copy, Debug, Default)]
pub struct IdleTimer {
    /// The first frame counts as input, so that it is drawn before other work begins.
    last_input: Option<Instant>,
}

impl IdleTimer {
    /// Looks for input. Call once a frame.
    pub fn follow(&mut self, context: &egui::Context) {
        let has_input = context.input(|input| {
            let is_held = input.pointer.any_down() || !input.keys_down.is_empty();
            is_held || !input.events.is_empty() || input.smooth_scroll_delta() != Vec2::ZERO
        });
        if has_input || self.last_input.is_none() {
            self.last_input = Some(clock::now());
        }
    }

    /// Returns true in a pause. Before it, requests a frame at its beginning.
    pub fn is_idle(&self, context: &egui::Context) -> bool {
        let Some(last_input) = self.last_input else { return false };
        let left = PAUSE.saturating_sub(last_input.elapsed());
        if left > Duration::ZERO {
            context.request_repaint_after(left);
        }
        left == Duration::ZERO
    }
}
