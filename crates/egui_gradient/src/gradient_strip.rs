//! The strip: the gradient, its handles and the histogram of lookups below it.

use egui::{self, Color32, CursorIcon, Rect, Sense, Stroke, StrokeKind, Ui, vec2};
use haze_core::formula::color::srgb_from_linear;

use super::edit_context::{DisplayOptions, EditContext};
use super::handles::{self, GAP, strip_position};
use super::paint::{borders, color32, gradient as paint_gradient, histogram, readout, ticks};
use super::selection::Selection;
use super::stop_operations;
use haze_author::ramp::gradient::add_stop;
use haze_author::ramp::{Curve, Gradient, HexColor};

/// Heights of the strip, of the lane for handles below it, and of histograms, points.
const STRIP: f32 = 30.0;
const LANE: f32 = 26.0;
const HISTOGRAM: f32 = 44.0;

/// Draws strip, handles and histograms. Returns the position under the pointer.
pub fn show(ui: &mut Ui, context: &mut EditContext<'_>, options: &DisplayOptions<'_>) -> Option<f32> {
    let has_histogram = !options.histograms.is_empty();
    let height = STRIP + LANE + if has_histogram { HISTOGRAM } else { 0.0 };
    let (_, all) = ui.allocate_space(vec2(ui.available_width().max(4.0 * GAP), height));
    // Margin for the handles of stops at both ends.
    let all = all.shrink2(vec2(GAP * 0.5, 0.0));
    let (strip, rest) = all.split_top_bottom_at_y(all.top() + STRIP);
    let (lane, below) = rest.split_top_bottom_at_y(rest.top() + LANE);
    let gradient = match stop_operations::gradient(context.stops, options.blend) {
        Ok(gradient) => gradient,
        Err(error) => {
            ui.put(all, egui::Label::new(format!("Not a gradient: {error}")));
            return None;
        }
    };
    let pointed_at = strip_input(ui, context, strip, &gradient);
    middles(ui, context, strip, &gradient);
    ticks(ui, context.stops, strip);
    for &(position, color) in options.marks {
        for (width, color) in [(4.0, Color32::BLACK), (2.0, color)] {
            ui.painter().vline(strip.left() + position * strip.width(), strip.y_range(), Stroke::new(width, color));
        }
    }
    let stop = handles::show(ui, context, strip, lane);
    if has_histogram {
        ui.painter().rect_filled(below, 0.0, ui.visuals().extreme_bg_color);
        options.histograms.iter().for_each(|(color, bins)| histogram(ui, below, bins, *color));
    }
    pointed_at.or(stop)
}

/// Returns the sRGB color at a position.
pub fn color_at(gradient: &Gradient, at: f32) -> HexColor {
    HexColor::from_srgb(gradient.sample(at, 0.0).map(|light| srgb_from_linear(light.min(1.0))))
}

/// Adds a stop with the color of the gradient. `drag`: x of the pointer and position where a drag of it begins.
fn add(context: &mut EditContext<'_>, gradient: &Gradient, at: f32, drag: Option<(f32, f32)>) {
    let color = color_at(gradient, at);
    let before = (context.stops.clone(), context.editor.selection.clone());
    context.edit("add a stop", |stops, selection| {
        *selection = Selection::one(add_stop(stops, at, color));
    });
    if let Some((x, position)) = drag {
        handles::begin_drag(context, x, position, before, true);
    }
    context.requests_focus = true;
}

/// Side of the mark in the middle between two stops, and least distance of stops that have one, points.
const MIDDLE: f32 = 8.0;
const MIDDLE_ROOM: f32 = 36.0;

/// Draws marks in the middle between stops. A drag moves the color there: it adds a stop, because a recipe has no other way to
/// bend the course between two stops.
fn middles(ui: &Ui, context: &mut EditContext<'_>, strip: Rect, gradient: &Gradient) {
    if context.editor.dragged.is_some() {
        return;
    }
    let pairs: Vec<_> = context.stops.windows(2).map(|pair| (pair[0].at, pair[1].at, pair[0].curve)).collect();
    for (index, (from, to, curve)) in pairs.into_iter().enumerate() {
        if (to - from) * strip.width() < MIDDLE_ROOM || curve == Curve::Constant {
            continue;
        }
        let at = f32::midpoint(from, to);
        let center = egui::pos2(strip.left() + at * strip.width(), strip.bottom() - 0.5 * MIDDLE - 1.0);
        let rect = Rect::from_center_size(center, vec2(MIDDLE, MIDDLE));
        let response = ui.interact(rect, ui.scope_id().with(("middle", index)), Sense::click_and_drag());
        let name = format!("middle between stop {} and {}", index + 1, index + 2);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
        let side = if response.hovered() { 0.5 * MIDDLE + 1.0 } else { 0.5 * MIDDLE - 1.0 };
        let corners = [vec2(0.0, -side), vec2(side, 0.0), vec2(0.0, side), vec2(-side, 0.0)];
        let corners = corners.map(|corner| center + corner).to_vec();
        ui.painter().add(egui::Shape::convex_polygon(corners, Color32::WHITE, Stroke::new(1.0, Color32::BLACK)));
        let origin = ui.input(|input| input.pointer.press_origin());
        if response.drag_started() || response.clicked() {
            add(context, gradient, at, origin.filter(|_| response.drag_started()).map(|origin| (origin.x, at)));
            return;
        }
        if response.hovered() {
            ui.set_cursor_icon(CursorIcon::ResizeHorizontal);
            response.on_hover_text("Drag to move the middle: adds a stop");
        }
    }
}

/// Draws the gradient. A click on it, or the start of a drag, adds a stop. Returns the hovered position.
fn strip_input(ui: &Ui, context: &mut EditContext<'_>, strip: Rect, gradient: &Gradient) -> Option<f32> {
    let response = ui.interact(strip, ui.scope_id().with("strip"), Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, "gradient: add a stop"));
    paint_gradient(ui, strip, |at| color32(color_at(gradient, at)));
    let parts = context.editor.snap.now(ui).filter(|_| response.hovered() || context.editor.dragged.is_some());
    borders(ui, strip, parts);
    let visuals = ui.style().interact(&response);
    let stroke =
        if response.has_focus() { ui.visuals().selection.stroke } else { Stroke::new(1.0, visuals.fg_stroke.color) };
    ui.painter().rect_stroke(strip, 0.0, stroke, StrokeKind::Outside);
    let position = |x: f32| strip_position(strip, x).clamp(0.0, 1.0);
    let snap = context.editor.snap;
    let origin = ui.input(|input| input.pointer.press_origin());
    let added = if response.drag_started() {
        origin.map(|origin| position(origin.x))
    } else if response.clicked() {
        // A click by keyboard has no position.
        let by_pointer = response.interact_pointer_pos().map(|at| position(at.x));
        Some(
            by_pointer
                .unwrap_or_else(|| stop_operations::insertion_position(context.stops, context.editor.selection.lead())),
        )
    } else {
        None
    };
    if let Some(position) = added {
        let at = stop_operations::snap_to_parts(position, snap.now(ui));
        add(context, gradient, at, origin.filter(|_| response.drag_started()).map(|origin| (origin.x, position)));
    }
    let hovered = response.hover_pos().filter(|_| context.editor.dragged.is_none())?;
    ui.set_cursor_icon(CursorIcon::Crosshair);
    response.on_hover_text_at_pointer("Click or drag to add a stop with this color. Ctrl snaps");
    let at = position(hovered.x);
    let color = color_at(gradient, at);
    readout(ui, hovered.x, strip, color32(color), format!("{at:.4}  {}", String::from(color)));
    Some(at)
}
