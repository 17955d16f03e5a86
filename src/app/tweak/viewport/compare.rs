//! What the picture is compared with, beside it.

use eframe::egui::{self, Sense, Ui};
use haze::demo::develop::exposure;
use haze::demo::shot::Shot;

use crate::app::tweak::compare::Against;
use crate::app::tweak::easel::other::Other;
use crate::app::tweak::referee::Verdict;
use crate::app::tweak::session::Session;

/// What the picture is compared with, if it is there yet.
pub fn other(ui: &Ui, session: &mut Session, shot: &Shot) -> Option<Other> {
    let against = session.compare.against.clone()?;
    if against != Against::Reference {
        return Some(Other::Shot(Box::new(against.shot(shot, session.saved(), &session.show.lights))));
    }
    let context = ui.ctx().clone();
    match session.referee.judge(shot, move || context.request_repaint()) {
        Verdict::Made(picture) => {
            session.messages.withdraw("reference");
            return Some(Other::Picture(picture, exposure(shot)));
        }
        Verdict::Later(wait) => ui.ctx().request_repaint_after(wait),
        Verdict::Failed(error) => session.messages.complain("reference", error),
        Verdict::Soon => {}
    }
    None
}

/// What stands between two pictures, and can be moved.
pub fn divider(ui: &Ui, rect: egui::Rect, split: &mut f32) {
    let x = rect.left() + *split * rect.width();
    let grip = egui::Rect::from_x_y_ranges(x - 5.0..=x + 5.0, rect.y_range());
    let response = ui
        .interact(grip, ui.scope_id().with("divider"), Sense::drag())
        .on_hover_cursor(egui::CursorIcon::ResizeHorizontal);
    response.widget_info(|| egui::WidgetInfo::slider(true, f64::from(*split), "divider"));
    if response.dragged() {
        *split = (*split + response.drag_delta().x / rect.width()).clamp(0.02, 0.98);
    }
    let x = (rect.left() + *split * rect.width()).round() + 0.5;
    let colour = if response.hovered() || response.dragged() {
        egui::Color32::WHITE
    } else {
        egui::Color32::from_white_alpha(160)
    };
    ui.painter().vline(x - 1.0, rect.y_range(), egui::Stroke::new(1.0, egui::Color32::from_black_alpha(160)));
    ui.painter().vline(x, rect.y_range(), egui::Stroke::new(1.0, colour));
    ui.painter().circle(
        egui::pos2(x, rect.center().y),
        5.0,
        egui::Color32::from_black_alpha(120),
        egui::Stroke::new(1.0, colour),
    );
}

/// How far the two are apart, in the lower right corner.
pub fn figures(ui: &Ui, rect: egui::Rect, text: &str) {
    let font = egui::TextStyle::Body.resolve(ui.style());
    let galley = ui.painter().layout_no_wrap(text.to_owned(), font, egui::Color32::WHITE);
    let at = rect.right_bottom() - galley.size() - egui::vec2(12.0, 10.0);
    let plate = egui::Rect::from_min_size(at, galley.size()).expand2(egui::vec2(6.0, 3.0));
    let response = ui.interact(plate, ui.scope_id().with("figures"), Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Status, true, text));
    ui.painter().rect_filled(plate, 3.0, egui::Color32::from_black_alpha(170));
    ui.painter().galley(at, galley, egui::Color32::WHITE);
    response.on_hover_text(
        "Peak signal-to-noise ratio of the two as they are shown; over all, and where the scene's depth jumps",
    );
}
