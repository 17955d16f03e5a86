//! Strip of debug views: all views live and small, in the order of the frame.

use eframe::egui::{self, Sense, Ui, Vec2};
use glam::UVec2;
use haze_core::settings::DebugView;
use haze_demo::shot::Shot;
use haze_export::debug_view_sheet::DEBUG_VIEWS;

use crate::session::Session;
use crate::viewport_renderer::ViewportRenderer;

/// Height of a label, points.
const NAME: f32 = 16.0;
/// Least width of an arrow, points.
const ARROW: f32 = 14.0;

/// Returns the width of a view in a strip of this width.
fn view_width(strip: f32) -> f32 {
    let count = DEBUG_VIEWS.len() as f32;
    (strip - (count - 1.0) * ARROW) / count
}

/// Returns the largest height that a strip of this width fills, with views of 4:3.
pub fn filled_height(strip: f32) -> f32 {
    NAME + 0.75 * view_width(strip)
}

/// Draws the views side by side. A click shows a view in the viewport, a second click shows the final image again.
/// `aspect` is the width of the viewport over its height.
pub fn debug_view_strip(ui: &mut Ui, session: &mut Session, renderer: &ViewportRenderer, aspect: f32) {
    // The panel keeps its height while the images are lower, because the shape of the viewport is not known yet.
    ui.set_min_height(ui.available_height());
    let count = DEBUG_VIEWS.len() as f32;
    let height = (ui.available_height() - NAME).min(view_width(ui.available_width()) / aspect);
    let size = Vec2::new((height * aspect).floor(), height.floor());
    let pixels = size * ui.pixels_per_point();
    let pixels = UVec2::new(pixels.x.round() as u32, pixels.y.round() as u32);
    if pixels.min_element() == 0 {
        return;
    }
    let shot = session.shot(pixels);
    ui.spacing_mut().item_spacing = Vec2::ZERO;
    let arrow_width = (ui.available_width() - count * size.x) / (count - 1.0);
    ui.horizontal_top(|ui| {
        for (index, (view, label)) in DEBUG_VIEWS.into_iter().enumerate() {
            if index > 0 {
                arrow(ui, Vec2::new(arrow_width, size.y));
            }
            let (rect, response) = ui.allocate_exact_size(size + Vec2::new(0.0, NAME), Sense::click());
            let image = egui::Rect::from_min_size(rect.min, size);
            renderer.show_debug_view(ui, image, Shot { debug_view: view, ..shot.clone() });
            let is_shown = session.view.debug_view == view;
            response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, is_shown, label));
            let visuals = ui.style().interact_selectable(&response, is_shown);
            if is_shown || response.hovered() || response.has_focus() {
                let stroke = egui::Stroke::new(2.0, visuals.bg_fill);
                ui.painter().rect_stroke(image, 0.0, stroke, egui::StrokeKind::Inside);
            }
            let name = egui::Rect::from_min_max(image.left_bottom(), rect.max);
            let text = egui::WidgetText::from(egui::RichText::new(label).small());
            let wrap = Some(egui::TextWrapMode::Truncate);
            // A long label extends into the space of the arrows.
            let text = text.into_galley(ui, wrap, name.width() + 0.9 * arrow_width, egui::TextStyle::Small);
            let at = egui::pos2(name.center().x - 0.5 * text.size().x, name.center().y - 0.5 * text.size().y);
            ui.painter().galley(at, text, visuals.text_color());
            let tooltip = session.debug_view_tooltips.choice("", view.name()).unwrap_or(label);
            if response.on_hover_text(tooltip).clicked() {
                session.view.debug_view = if is_shown { DebugView::Final } else { view };
            }
        }
    });
}

/// Draws the arrow from one view to the next.
fn arrow(ui: &mut Ui, size: Vec2) {
    let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
    let middle = rect.center();
    let reach = 3.5;
    let points = [
        middle + Vec2::new(-0.5 * reach, -reach),
        middle + Vec2::new(0.5 * reach, 0.0),
        middle + Vec2::new(-0.5 * reach, reach),
    ];
    ui.painter().add(egui::Shape::line(points.to_vec(), egui::Stroke::new(1.5, ui.visuals().weak_text_color())));
}

/// Returns the view after one, cyclically.
pub fn next_debug_view(view: DebugView) -> DebugView {
    let at = DEBUG_VIEWS.iter().position(|(one, _)| *one == view).map_or(0, |at| at + 1);
    DEBUG_VIEWS[at % DEBUG_VIEWS.len()].0
}
