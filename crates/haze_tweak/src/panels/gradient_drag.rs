//! Drag of a gradient from one ramp onto another.

use eframe::egui::{self, CursorIcon, DragAndDrop, Rect, Sense, Stroke, StrokeKind, Ui};
use haze_author::ramp::{Blend, RampStop};

/// Gradient that is dragged.
#[derive(Clone, Debug, PartialEq)]
pub struct DraggedGradient {
    pub stops: Vec<RampStop>,
    pub blend: Blend,
}

/// Draws the grip of a ramp's gradient. `name`: that of the ramp.
pub fn grip(ui: &mut Ui, name: &str, gradient: DraggedGradient) {
    let text = egui::RichText::new("Drag to copy").weak();
    let response = ui.add(egui::Label::new(text).selectable(false).sense(Sense::drag()));
    let spoken = format!("Drag to copy: {name}");
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &spoken));
    if response.drag_started() {
        DragAndDrop::set_payload(ui.ctx(), gradient);
    }
    if response.dragged() {
        ui.set_cursor_icon(CursorIcon::Grabbing);
        egui::Tooltip::always_open(ui.ctx().clone(), ui.layer_id(), response.id, egui::PopupAnchor::Pointer)
            .show(|ui| ui.label(name));
    } else if response.hovered() {
        ui.set_cursor_icon(CursorIcon::Grab);
    }
    response.on_hover_text(
        "Drag it onto the stops of another ramp to copy the gradient. A ramp without stops needs Make my own first.",
    );
}

/// Marks the position of an editor while a gradient is over it, and returns the gradient that is dropped there.
pub fn dropped(ui: &Ui, rect: Rect) -> Option<DraggedGradient> {
    if !DragAndDrop::has_payload_of_type::<DraggedGradient>(ui.ctx()) || !ui.rect_contains_pointer(rect) {
        return None;
    }
    let stroke = Stroke::new(2.0, ui.visuals().selection.stroke.color);
    ui.painter().rect_stroke(rect.expand(2.0), 3.0, stroke, StrokeKind::Outside);
    let is_released = ui.input(|input| input.pointer.any_released());
    let dropped = is_released.then(|| DragAndDrop::take_payload::<DraggedGradient>(ui.ctx())).flatten()?;
    Some((*dropped).clone())
}
