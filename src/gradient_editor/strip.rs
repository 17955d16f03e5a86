//! The strip with its handles: what is drawn, and what pointer and keys do to it.

use eframe::egui::{
    self, Color32, CursorIcon, EventFilter, Id, Key, Mesh, Rect, Sense, Stroke, StrokeKind, Ui, pos2, vec2,
};

use super::frame::{Frame, Surroundings};
use super::paint::{handle, histogram, ticks};
use super::{fan, stops};
use crate::assets::ramp::bake::{Gradient, HexColour, RampRecipe, RampRow};
use crate::formula::colour::srgb_from_linear;

/// Heights of the strip, of the room for handles below it, and of histograms; a handle's size.
const STRIP: f32 = 30.0;
const LANE: f32 = 26.0;
const HISTOGRAM: f32 = 44.0;
const HANDLE: egui::Vec2 = vec2(12.0, 16.0);
/// From the middle of a handle to the next.
const GAP: f32 = 15.0;

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
    crowd(ui, frame, lane);
    handles(ui, frame, strip, lane);
    drag(ui, frame, strip);
    if frame.wants_keyboard {
        // Not before: a click elsewhere takes the keyboard from handles as they are drawn.
        let id = handle_id(ui, frame.editor.selected);
        ui.memory_mut(|memory| memory.request_focus(id));
    }
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

fn colour32(HexColour([r, g, b]): HexColour) -> Color32 {
    Color32::from_rgb(r, g, b)
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
    let visuals = ui.style().interact(&response);
    let stroke =
        if response.has_focus() { ui.visuals().selection.stroke } else { Stroke::new(1.0, visuals.fg_stroke.color) };
    ui.painter().rect_stroke(strip, 0.0, stroke, StrokeKind::Outside);
    let place = |x: f32| share(strip, x).clamp(0.0, 1.0);
    let snapped = |at: f32| if ui.input(|input| input.modifiers.command) { stops::tenth(at) } else { at };
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
    if let Some(at) = added.map(snapped) {
        let colour = colour_at(gradient, at);
        frame.edit_and_select("add a stop", |stops, _| stops::add(stops, at, colour));
        frame.editor.dragged = response.drag_started().then_some(0.0);
        frame.wants_keyboard = true;
    }
    let hovered = response.hover_pos().filter(|_| frame.editor.dragged.is_none())?;
    ui.set_cursor_icon(CursorIcon::Crosshair);
    response.on_hover_text_at_pointer("Click or drag: a stop with this colour. Ctrl: at tenths");
    Some(place(hovered.x))
}

/// A click where no handle is selects the stop that is nearest: the way to those without one.
fn crowd(ui: &Ui, frame: &mut Frame<'_>, lane: Rect) {
    let response = ui.interact(lane, ui.scope_id().with("lane"), Sense::CLICK);
    if let Some(at) = response.interact_pointer_pos().filter(|_| response.clicked()) {
        let at = (at.x - lane.left()) / lane.width();
        let apart = |index: &usize| (frame.stops[*index].at - at).abs();
        let nearest = (0..frame.stops.len()).min_by(|a, b| apart(a).total_cmp(&apart(b)));
        frame.editor.selected = nearest.unwrap_or(0);
        frame.wants_keyboard = true;
    }
}

fn handle_id(ui: &Ui, index: usize) -> Id {
    ui.scope_id().with(("stop", index))
}

/// A place across, 0 to 1 if it is on the strip.
fn share(strip: Rect, x: f32) -> f32 {
    (x - strip.left()) / strip.width()
}

/// A handle for each stop, or those round the selected one where there are more than have room.
fn handles(ui: &Ui, frame: &mut Frame<'_>, strip: Rect, lane: Rect) {
    let room = (lane.width() / GAP) as usize + 1;
    let shown = fan::shown(frame.stops.len(), frame.editor.selected, room);
    let wanted: Vec<_> = frame.stops[shown.clone()].iter().map(|stop| stop.at * lane.width()).collect();
    let places = fan::fan_out(&wanted, lane.width(), GAP);
    let before = frame.editor.selected;
    let mut focused = None;
    let mut drawn = Vec::new();
    for ((index, place), wanted) in shown.zip(places).zip(wanted) {
        let stop = &frame.stops[index];
        let middle = pos2(lane.left() + place, lane.bottom() - 0.5 * HANDLE.y - 2.0);
        let rect = Rect::from_center_size(middle, HANDLE);
        let response = ui.interact(rect.expand2(vec2(1.0, 2.0)), handle_id(ui, index), Sense::click_and_drag());
        let (name, at) = (format!("stop {}", index + 1), f64::from(stop.at));
        response.widget_info(|| egui::WidgetInfo::slider(true, at, &name));
        if response.drag_started() || response.clicked() {
            response.request_focus();
            frame.editor.selected = index;
            // It stays as far from the pointer as it was when grabbed, also where its handle stands apart from its place.
            let origin = ui.input(|input| input.pointer.press_origin()).filter(|_| response.drag_started());
            frame.editor.dragged = origin.map(|origin| stop.at - share(strip, origin.x));
        } else if response.gained_focus() && frame.editor.dragged.is_none() {
            frame.editor.selected = index;
        }
        if response.has_focus() {
            focused = Some(index);
        }
        drawn.push((index, rect, lane.left() + wanted, colour32(stop.colour), response.hovered()));
        if frame.editor.dragged.is_none() && response.hovered() {
            ui.set_cursor_icon(CursorIcon::ResizeHorizontal);
            let text = format!(
                "{name}: {} at {at:.4}. Drag, or arrow keys; Shift: ten times as far, Ctrl: tenths. \
                 Delete removes it",
                String::from(stop.colour)
            );
            response.on_hover_text(text);
        }
    }
    // The selected one is drawn over the others.
    drawn.sort_by_key(|(index, ..)| *index == before);
    for (index, rect, x, colour, is_hovered) in drawn {
        handle(ui, rect, pos2(x, strip.bottom()), colour, (index == before, is_hovered, focused == Some(index)));
    }
    frame.editor.has_keyboard = focused.is_some();
    if focused.is_some() {
        let id = handle_id(ui, before);
        let filter = EventFilter { horizontal_arrows: true, ..EventFilter::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(id, filter));
        keys(ui, frame);
        if frame.editor.selected != before {
            frame.wants_keyboard = true;
        }
    }
}

/// What keys do to the stop that has the keyboard.
fn keys(ui: &Ui, frame: &mut Frame<'_>) {
    let mut pressed = Vec::new();
    ui.input_mut(|input| {
        input.events.retain(|event| {
            let egui::Event::Key { key, pressed: true, modifiers, .. } = event else { return true };
            let is_ours = [Key::ArrowLeft, Key::ArrowRight, Key::Delete, Key::Backspace].contains(key);
            if is_ours {
                pressed.push((*key, *modifiers));
            }
            !is_ours
        });
    });
    for (key, modifiers) in pressed {
        let steps = match key {
            Key::ArrowLeft => -1.0,
            Key::ArrowRight => 1.0,
            _ => {
                frame.edit_and_select("remove a stop", stops::remove);
                continue;
            }
        };
        frame.edit_and_select("move a stop", |all, index| {
            let at = all.get(index).map_or(0.0, |stop| stop.at);
            stops::move_to(all, index, stops::nudged(at, steps, modifiers.shift, modifiers.command))
        });
    }
}

/// Moves the stop that is dragged. Its handle may have become another's meanwhile: the pointer tells where it is.
fn drag(ui: &Ui, frame: &mut Frame<'_>, strip: Rect) {
    let Some(offset) = frame.editor.dragged else { return };
    let (pointer, is_down, snaps) =
        ui.input(|input| (input.pointer.latest_pos(), input.pointer.primary_down(), input.modifiers.command));
    let Some(pointer) = pointer.filter(|_| is_down) else {
        frame.editor.dragged = None;
        return;
    };
    ui.set_cursor_icon(CursorIcon::ResizeHorizontal);
    let before = frame.editor.selected;
    let at = share(strip, pointer.x) + offset;
    frame.edit_and_select("move a stop", |all, index| {
        stops::move_to(all, index, if snaps { stops::tenth(at) } else { at })
    });
    if frame.editor.selected != before {
        frame.wants_keyboard = true;
    }
}
