//! The strip: the gradient with its handles below it, and what is looked up.

use eframe::egui::{self, Color32, CursorIcon, Mesh, Rect, Sense, Stroke, StrokeKind, Ui, pos2, vec2};

use super::frame::{Drag, Frame, Surroundings};
use super::handles::{self, GAP, share};
use super::paint::{borders, colour32, histogram, ticks};
use super::stops;
use crate::assets::ramp::bake::{Gradient, HexColour, RampRecipe, RampRow};
use crate::formula::colour::srgb_from_linear;

/// Heights of the strip, of the room for handles below it, and of histograms.
const STRIP: f32 = 30.0;
const LANE: f32 = 26.0;
const HISTOGRAM: f32 = 44.0;

/// Draws all of it, and gives the place that is pointed at.
pub fn show(ui: &mut Ui, frame: &mut Frame<'_>, surroundings: &Surroundings<'_>) -> Option<f32> {
    let has_histogram = !surroundings.histograms.is_empty();
    let height = STRIP + LANE + if has_histogram { HISTOGRAM } else { 0.0 };
    let (_, all) = ui.allocate_space(vec2(ui.available_width().max(4.0 * GAP), height));
    // Handles of stops at both ends are inside.
    let all = all.shrink2(vec2(GAP * 0.5, 0.0));
    let (strip, rest) = all.split_top_bottom_at_y(all.top() + STRIP);
    let (lane, below) = rest.split_top_bottom_at_y(rest.top() + LANE);
    let recipe = RampRecipe {
        blend: surroundings.blend,
        rows: vec![RampRow { stops: frame.stops.clone(), ..RampRow::default() }],
        ..RampRecipe::default()
    };
    let gradient = match recipe.gradient() {
        Ok(gradient) => gradient,
        Err(error) => {
            ui.put(all, egui::Label::new(format!("Not a gradient: {error}")));
            return None;
        }
    };
    let pointed_at = ground(ui, frame, strip, &gradient);
    ticks(ui, frame.stops, strip);
    for &(place, colour) in surroundings.marks {
        for (width, colour) in [(4.0, Color32::BLACK), (2.0, colour)] {
            ui.painter().vline(strip.left() + place * strip.width(), strip.y_range(), Stroke::new(width, colour));
        }
    }
    handles::show(ui, frame, strip, lane);
    if has_histogram {
        ui.painter().rect_filled(below, 0.0, ui.visuals().extreme_bg_color);
        surroundings.histograms.iter().for_each(|(colour, bins)| histogram(ui, below, bins, *colour));
    }
    pointed_at
}

/// The sRGB colour at a place.
fn colour_at(gradient: &Gradient, at: f32) -> HexColour {
    HexColour::from_srgb(gradient.sample(at, 0.0).map(|light| srgb_from_linear(light.min(1.0))))
}

/// The gradient itself, where a click or the beginning of a drag adds a stop.
fn ground(ui: &Ui, frame: &mut Frame<'_>, strip: Rect, gradient: &Gradient) -> Option<f32> {
    let response = ui.interact(strip, ui.scope_id().with("strip"), Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, "gradient: add a stop"));
    let mut mesh = Mesh::default();
    let columns = (strip.width() * ui.pixels_per_point()).ceil().max(1.0);
    let width = strip.width() / columns;
    for column in 0..columns as usize {
        let left = strip.left() + column as f32 * width;
        let colour = colour32(colour_at(gradient, (column as f32 + 0.5) / columns));
        mesh.add_colored_rect(Rect::from_min_max(pos2(left, strip.top()), pos2(left + width, strip.bottom())), colour);
    }
    ui.painter().add(mesh);
    let parts = frame.editor.snap.now(ui).filter(|_| response.hovered() || frame.editor.dragged.is_some());
    borders(ui, strip, parts);
    let visuals = ui.style().interact(&response);
    let stroke =
        if response.has_focus() { ui.visuals().selection.stroke } else { Stroke::new(1.0, visuals.fg_stroke.color) };
    ui.painter().rect_stroke(strip, 0.0, stroke, StrokeKind::Outside);
    let place = |x: f32| share(strip, x).clamp(0.0, 1.0);
    let snap = frame.editor.snap;
    let origin = ui.input(|input| input.pointer.press_origin());
    let added = if response.drag_started() {
        origin.map(|origin| place(origin.x))
    } else if response.clicked() {
        // By key there is no place.
        let by_pointer = response.interact_pointer_pos().map(|at| place(at.x));
        Some(by_pointer.unwrap_or_else(|| stops::gap(frame.stops, frame.editor.selected)))
    } else {
        None
    };
    if let Some(at) = added.map(|at| stops::snapped(at, snap.now(ui))) {
        let colour = colour_at(gradient, at);
        let before = (frame.stops.clone(), frame.editor.selected);
        frame.edit_and_select("add a stop", |stops, _| stops::add(stops, at, colour));
        frame.editor.dragged = response.drag_started().then_some(Drag { offset: 0.0, before });
        frame.wants_keyboard = true;
    }
    let hovered = response.hover_pos().filter(|_| frame.editor.dragged.is_none())?;
    ui.set_cursor_icon(CursorIcon::Crosshair);
    response.on_hover_text_at_pointer("Click or drag: a stop with this colour. Ctrl snaps");
    Some(place(hovered.x))
}
