//! What other threads call when there is something new to see.

use std::sync::{Arc, Mutex, PoisonError};

use eframe::egui;

/// Makes the window draw itself again: the one that there is when it is called, which is another after a device was lost. A clone
/// is the same.
#[derive(Clone, Default)]
pub struct Wake(Arc<Mutex<Option<egui::Context>>>);

impl Wake {
    /// There is another window.
    pub fn follow(&self, context: &egui::Context) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(context.clone());
    }

    pub fn call(&self) {
        let context = self.0.lock().unwrap_or_else(PoisonError::into_inner).clone();
        context.iter().for_each(egui::Context::request_repaint);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_window_that_there_is_is_woken() {
        let still = || {
            let context = egui::Context::default();
            (0..3).for_each(|_| context.run_ui(egui::RawInput::default(), |_| {}).textures_delta.clear());
            context
        };
        let (wake, [first, second]) = (Wake::default(), [still(), still()]);
        wake.follow(&first);
        let its = wake.clone();
        wake.follow(&second);
        its.call();
        assert!(!first.has_requested_repaint() && second.has_requested_repaint());
    }
}
