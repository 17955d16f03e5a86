//! Painting of the editor's parts.

use egui::{Align2, Area, Color32, Frame, Label, Mesh, Order, Pos2, Rect, Shape, Stroke, StrokeKind, Ui, pos2, vec2};

use haze_author::ramp::{HexColor, RampStop};

pub fn color32(HexColor([r, g, b]): HexColor) -> Color32 {
    Color32::from_rgb(r, g, b)
}

/// Draws a gradient across a rectangle, one column per pixel. `color` returns the color at a position, 0 to 1.
pub fn gradient(ui: &Ui, rect: Rect, color: impl Fn(f32) -> Color32) {
    let mut mesh = Mesh::default();
    let columns = (rect.width() * ui.pixels_per_point()).ceil().max(1.0);
    let width = rect.width() / columns;
    for column in 0..columns as usize {
        let left = rect.left() + column as f32 * width;
        let column = Rect::from_min_max(pos2(left, rect.top()), pos2(left + width, rect.bottom()));
        mesh.add_colored_rect(column, color((column.center().x - rect.left()) / rect.width()));
    }
    ui.painter().add(mesh);
}

/// Shows a text with a color swatch at `x` above the strip, or below it if there is no room.
pub fn readout(ui: &Ui, x: f32, strip: Rect, color: Color32, text: String) {
    const ROOM: f32 = 28.0;
    let (pivot, y) = if strip.top() - ui.ctx().viewport_rect().top() < ROOM {
        (Align2::CENTER_TOP, strip.bottom() + ROOM)
    } else {
        (Align2::CENTER_BOTTOM, strip.top() - 3.0)
    };
    let area = Area::new(ui.scope_id().with("readout")).order(Order::Tooltip).interactable(false);
    area.pivot(pivot).fixed_pos(pos2(x, y)).show(ui.ctx(), |ui| {
        Frame::popup(ui.style()).inner_margin(3.0).show(ui, |ui| {
            ui.horizontal(|ui| {
                let (_, swatch) = ui.allocate_space(vec2(10.0, 10.0));
                ui.painter().rect_filled(swatch, 2.0, color);
                ui.add(Label::new(text).extend());
            });
        });
    });
}

/// Draws the borders of the equal parts that positions snap to, if any.
pub fn borders(ui: &Ui, strip: Rect, parts: Option<u32>) {
    let Some(parts) = parts else { return };
    for border in 1..parts {
        let x = strip.left() + strip.width() * border as f32 / parts as f32;
        for (beside, color) in [(0.0, Color32::BLACK), (1.0, Color32::WHITE)] {
            ui.painter().vline(x + beside, strip.y_range(), Stroke::new(1.0, color.gamma_multiply(0.3)));
        }
    }
}

/// Draws ticks at the stops' positions, at most one per point.
pub fn ticks(ui: &Ui, stops: &[RampStop], strip: Rect) {
    let mut last = f32::NEG_INFINITY;
    for stop in stops {
        let x = strip.left() + stop.at * strip.width();
        if x - last >= 1.0 {
            for (width, color) in [(3.0, Color32::BLACK), (1.0, Color32::WHITE)] {
                ui.painter().vline(x, strip.bottom() - 4.0..=strip.bottom(), Stroke::new(width, color));
            }
            last = x;
        }
    }
}

/// State of a handle that shows.
#[derive(Clone, Copy)]
pub struct HandleState {
    pub is_selected: bool,
    pub is_hovered: bool,
    pub has_focus: bool,
}

/// Draws a handle and a line to its stop's position.
pub fn handle(ui: &Ui, rect: Rect, position: Pos2, color: Color32, state: HandleState) {
    let HandleState { is_selected, is_hovered, has_focus } = state;
    let visuals = ui.visuals();
    let ink = if is_selected { visuals.selection.stroke.color } else { visuals.text_color() };
    let stroke = Stroke::new(if is_selected || is_hovered { 2.0 } else { 1.0 }, ink);
    ui.painter().line_segment([position, pos2(rect.center().x, rect.top())], stroke);
    if has_focus {
        ui.painter().rect_stroke(rect.expand(3.0), 3.0, Stroke::new(1.0, ink), StrokeKind::Inside);
    }
    ui.painter().rect(rect, 2.0, color, stroke, StrokeKind::Outside);
}

/// Draws a histogram with heights from 0 to 1 over a rectangle: translucent columns and a line along their tops.
pub fn histogram(ui: &Ui, rect: Rect, bins: &[f32], color: Color32) {
    let width = rect.width() / bins.len().max(1) as f32;
    let mut mesh = Mesh::default();
    let mut outline = Vec::new();
    for (index, bin) in bins.iter().enumerate() {
        let left = rect.left() + index as f32 * width;
        // The square root makes rare values visible.
        let top = rect.bottom() - bin.clamp(0.0, 1.0).sqrt() * (rect.height() - 2.0);
        let column = Rect::from_min_max(pos2(left, top), pos2(left + width, rect.bottom()));
        mesh.add_colored_rect(column, color.gamma_multiply(0.25));
        outline.extend([column.left_top(), column.right_top()]);
    }
    ui.painter().add(mesh);
    ui.painter().add(Shape::line(outline, Stroke::new(1.5, color)));
}
