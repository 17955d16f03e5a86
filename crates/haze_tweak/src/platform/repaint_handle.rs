//! Repaint requests from other threads.

use std::sync::{Arc, Mutex, PoisonError};

use eframe::egui;

/// Requests a repaint of the current window. After a device loss that is another window. Clones share the state.
#[derive(Clone, Default)]
pub struct RepaintHandle(Arc<Mutex<Option<egui::Context>>>);

impl RepaintHandle {
    /// Sets the current window.
    pub fn follow(&self, context: &egui::Context) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(context.clone());
    }

    pub fn call(&self) {
        let context = self.0.lock().unwrap_or_else(PoisonError::into_inner).clone();
        if let Some(context) = context {
            context.request_repaint();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_current_window_is_repainted() {
        let still = || {
            let context = egui::Context::default();
            (0..3).for_each(|_| context.run_ui(egui::RawInput::default(), |_| {}).textures_delta.clear());
            context
        };
        let wake = RepaintHandle::default();
        let [first, second] = [still(), still()];
        wake.follow(&first);
        let its = wake.clone();
        wake.follow(&second);
        its.call();
        assert!(!first.has_requested_repaint() && second.has_requested_repaint());
    }
}
