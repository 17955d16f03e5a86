//! Size of a resizable panel: as the user chose it, in a window of about the same size.

use eframe::egui::{self, Context, PanelState};

use crate::files::persistence::PanelSize;

/// Returns true for two lengths that are further apart than rounding, in points.
fn differ(a: f32, b: f32) -> bool {
    (a - b).abs() > 0.01
}

/// Panel as it was last shown.
#[derive(Default)]
pub struct PanelTracker {
    shown: Option<PanelSize>,
}

impl PanelTracker {
    /// Returns the size to show the panel with. Call before it. `room` is the size of the window along the panel. In a
    /// window that was resized, the panel starts anew from the chosen or the usual size.
    pub fn begin(&mut self, context: &Context, chosen: Option<PanelSize>, room: f32, usual: f32) -> f32 {
        if self.shown.take_if(|shown| differ(shown.room, room)).is_some() {
            context.data_mut(egui::util::IdTypeMap::remove_by_type::<PanelState>);
        }
        chosen.and_then(|chosen| chosen.in_room(room)).unwrap_or(usual)
    }

    /// Records the size of the shown panel. A size that changes while a button is down, in the same window, is the
    /// user's choice.
    pub fn end(&mut self, context: &Context, size: f32, room: f32, chosen: &mut Option<PanelSize>) {
        let now = PanelSize { size, room };
        let is_dragged = context.input(|input| input.pointer.any_down());
        if is_dragged && self.shown.is_some_and(|shown| differ(shown.size, size)) {
            *chosen = Some(now);
        }
        self.shown = Some(now);
    }
}
