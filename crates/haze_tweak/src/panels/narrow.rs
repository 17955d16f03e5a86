//! Layout for windows that are as narrow as a phone.

use eframe::egui::{self, Ui};

/// Narrower windows have the settings below the image, points. A window of a desktop is at least as wide.
const MIN_WIDE: f32 = 600.0;

/// Returns true if the window is as narrow as a phone.
pub fn is_narrow(context: &egui::Context) -> bool {
    context.content_rect().width() < MIN_WIDE
}

/// Height of controls that a finger touches, points.
const TOUCH_HEIGHT: f32 = 28.0;

/// Makes the controls of a narrow window large enough for fingers.
pub fn set_spacing(ui: &mut Ui) {
    if is_narrow(ui.ctx()) {
        ui.spacing_mut().interact_size.y = TOUCH_HEIGHT;
    }
}

/// Draws a row, which can be scrolled sideways in a narrow window.
pub fn row(ui: &mut Ui, id: &str, content: impl FnOnce(&mut Ui)) {
    if is_narrow(ui.ctx()) {
        let area = egui::ScrollArea::horizontal().id_salt(id);
        area.scroll_bar_visibility(egui::scroll_area::ScrollBarVisibility::AlwaysHidden)
            .show(ui, |ui| ui.horizontal(content));
    } else {
        ui.horizontal(content);
    }
}
