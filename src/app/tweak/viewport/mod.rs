//! The picture, and what is done to it with the pointer.

mod camera;

use eframe::egui::{self, Sense, Ui};
use glam::UVec2;

use super::gpu::{Easel, Exhibit};
use super::session::Session;

pub fn viewport(ui: &mut Ui, session: &mut Session, easel: &Easel) {
    let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
    let pixels = rect.size() * ui.pixels_per_point();
    let size = UVec2::new(pixels.x.round() as u32, pixels.y.round() as u32);
    if size.min_element() == 0 {
        return;
    }
    camera::steer(ui, &response, &mut session.preset.camera);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "viewport"));
    let exhibit = Exhibit { shot: session.shot(size), other: None, split: 1.0, difference: 0.0 };
    easel.show(ui, rect, exhibit);
}
