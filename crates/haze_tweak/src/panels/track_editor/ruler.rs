//! Ruler above the lanes: seconds, and the time of the playback.

use eframe::egui::{self, Sense, Stroke, Ui, pos2};

use super::time_axis::TimeAxis;
use crate::session::Session;

/// Height of the ruler, points.
pub const HEIGHT: f32 = 16.0;
/// Least distance of labels, points.
const LABEL_GAP: f32 = 56.0;

/// Draws the ruler. A click or a drag goes to the time under the pointer.
pub fn ruler(ui: &mut Ui, session: &mut Session, axis: &TimeAxis) {
    let (row, _) = ui.allocate_exact_size(egui::vec2(ui.available_width(), HEIGHT), Sense::hover());
    let rect = row.with_min_x(axis.left).with_max_x(axis.left + axis.width);
    let response = ui.interact(rect, ui.scope_id().with("ruler"), Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Time ruler"));
    if let Some(at) = response.interact_pointer_pos().filter(|_| response.dragged() || response.clicked()) {
        session.playback.time = (f64::from(axis.time(at.x)) * 100.0).round() / 100.0;
        session.playback.is_playing = false;
    }
    let painter = ui.painter_at(rect);
    let faint = ui.visuals().weak_text_color();
    let font = egui::TextStyle::Small.resolve(ui.style());
    let (times, decimals) = axis.labels(LABEL_GAP);
    for time in times {
        let x = axis.x(time);
        painter.vline(x, rect.bottom() - 4.0..=rect.bottom(), Stroke::new(1.0, faint));
        let text = painter.layout_no_wrap(format!("{time:.decimals$} s"), font.clone(), faint);
        // The first and the last label are whole.
        let left = (x - 0.5 * text.size().x).clamp(rect.left(), (rect.right() - text.size().x).max(rect.left()));
        painter.galley(pos2(left, rect.top()), text, faint);
    }
    let now = axis.x(axis.now);
    painter.vline(now, rect.y_range(), Stroke::new(1.0, ui.visuals().selection.stroke.color));
}
