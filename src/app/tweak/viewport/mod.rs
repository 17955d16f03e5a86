//! The picture, and what is done to it with the pointer.

mod camera;

use eframe::egui::{self, Sense, Ui};
use glam::UVec2;
use haze::demo::develop::exposure;
use haze::demo::shot::Shot;

use super::compare::Against;
use super::gpu::{Easel, Exhibit, Other};
use super::referee::Verdict;
use super::session::Session;

pub fn viewport(ui: &mut Ui, session: &mut Session, easel: &Easel) {
    let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
    let pixels = rect.size() * ui.pixels_per_point();
    let size = UVec2::new(pixels.x.round() as u32, pixels.y.round() as u32);
    if size.min_element() == 0 {
        return;
    }
    session.show.aspect = size.x as f32 / size.y as f32;
    camera::steer(ui, &response, &mut session.document.preset.camera);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "viewport"));
    let shot = session.shot(size);
    let other = other(ui, session, &shot);
    let compare = &mut session.compare;
    let exhibit = Exhibit { shot, other, split: compare.split, difference: compare.difference };
    easel.show(ui, rect, exhibit);
    if compare.against.is_some() && compare.difference == 0.0 {
        divider(ui, rect, &mut compare.split);
    }
}

/// What the picture is compared with, if it is there yet.
fn other(ui: &Ui, session: &mut Session, shot: &Shot) -> Option<Other> {
    let against = session.compare.against.clone()?;
    if against != Against::Reference {
        return Some(Other::Shot(Box::new(against.shot(shot, session.saved()))));
    }
    let context = ui.ctx().clone();
    match session.referee.judge(shot, move || context.request_repaint()) {
        Verdict::Made(picture) => return Some(Other::Picture(picture, exposure(shot))),
        Verdict::Later(wait) => ui.ctx().request_repaint_after(wait),
        Verdict::Failed(error) => session.messages.complain("reference", error),
        Verdict::Soon => {}
    }
    None
}

/// What stands between two pictures, and can be moved.
fn divider(ui: &Ui, rect: egui::Rect, split: &mut f32) {
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
