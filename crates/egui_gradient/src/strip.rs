//! The strip: the gradient, its handles and the histogram of lookups below it.

use egui::{self, Color32, CursorIcon, Rect, Sense, Stroke, StrokeKind, Ui, vec2};

use super::frame::{Frame, Surroundings};
use super::handles::{self, GAP, share};
use super::paint::{borders, colour32, gradient as paint_gradient, histogram, readout, ticks};
use super::selection::Selection;
use super::stops;
use haze::error::FieldError;
use haze::formula::colour::srgb_from_linear;
use haze_author::ramp::bake::{Blend, Gradient, HexColour, RampRecipe, RampRow, RampStop};

/// Heights of the strip, of the lane for handles below it, and of histograms, points.
const STRIP: f32 = 30.0;
const LANE: f32 = 26.0;
const HISTOGRAM: f32 = 44.0;

/// Draws strip, handles and histograms. Returns the position under the pointer.
pub fn show(ui: &mut Ui, frame: &mut Frame<'_>, surroundings: &Surroundings<'_>) -> Option<f32> {
    let has_histogram = !surroundings.histograms.is_empty();
    let height = STRIP + LANE + if has_histogram { HISTOGRAM } else { 0.0 };
    let (_, all) = ui.allocate_space(vec2(ui.available_width().max(4.0 * GAP), height));
    // Margin for the handles of stops at both ends.
    let all = all.shrink2(vec2(GAP * 0.5, 0.0));
    let (strip, rest) = all.split_top_bottom_at_y(all.top() + STRIP);
    let (lane, below) = rest.split_top_bottom_at_y(rest.top() + LANE);
    let gradient = match gradient(frame.stops, surroundings.blend) {
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

/// Builds the gradient of the stops.
pub fn gradient(stops: &[RampStop], blend: Blend) -> Result<Gradient, FieldError> {
    let rows = vec![RampRow { stops: stops.to_vec(), ..RampRow::default() }];
    RampRecipe { blend, rows, ..RampRecipe::default() }.gradient()
}

/// Returns the sRGB colour at a position.
pub fn colour_at(gradient: &Gradient, at: f32) -> HexColour {
    HexColour::from_srgb(gradient.sample(at, 0.0).map(|light| srgb_from_linear(light.min(1.0))))
}

/// Draws the gradient. A click on it, or the start of a drag, adds a stop. Returns the hovered position.
fn ground(ui: &Ui, frame: &mut Frame<'_>, strip: Rect, gradient: &Gradient) -> Option<f32> {
    let response = ui.interact(strip, ui.scope_id().with("strip"), Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, "gradient: add a stop"));
    paint_gradient(ui, strip, |at| colour32(colour_at(gradient, at)));
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
        // A click by keyboard has no position.
        let by_pointer = response.interact_pointer_pos().map(|at| place(at.x));
        Some(by_pointer.unwrap_or_else(|| stops::gap(frame.stops, frame.editor.selection.lead())))
    } else {
        None
    };
    if let Some(place) = added {
        let at = stops::snapped(place, snap.now(ui));
        let colour = colour_at(gradient, at);
        let before = (frame.stops.clone(), frame.editor.selection.clone());
        frame.edit("add a stop", |stops, selection| *selection = Selection::one(stops::add(stops, at, colour)));
        if let Some(origin) = origin.filter(|_| response.drag_started()) {
            handles::begin(frame, origin.x, place, before, true);
        }
        frame.wants_keyboard = true;
    }
    let hovered = response.hover_pos().filter(|_| frame.editor.dragged.is_none())?;
    ui.set_cursor_icon(CursorIcon::Crosshair);
    response.on_hover_text_at_pointer("Click or drag to add a stop with this colour. Ctrl snaps");
    let at = place(hovered.x);
    let colour = colour_at(gradient, at);
    readout(ui, hovered.x, strip, colour32(colour), format!("{at:.4}  {}", String::from(colour)));
    Some(at)
}
