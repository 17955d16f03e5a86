//! The handles of stops: what pointer and keys do to them.

use eframe::egui::{self, CursorIcon, EventFilter, Id, Key, Modifiers, Rect, Sense, Ui, pos2, vec2};

use super::frame::{Drag, Frame};
use super::paint::{colour32, handle};
use super::{fan, stops};

/// A handle's size.
const HANDLE: egui::Vec2 = vec2(12.0, 16.0);
/// From the middle of a handle to the next.
pub const GAP: f32 = 15.0;

/// Draws them in their lane, and does what is done to them.
pub fn show(ui: &Ui, frame: &mut Frame<'_>, strip: Rect, lane: Rect) {
    crowd(ui, frame, lane);
    all(ui, frame, strip, lane);
    drag(ui, frame, strip);
    if frame.wants_keyboard {
        // Not before: a click elsewhere takes the keyboard from handles as they are drawn.
        let id = handle_id(ui, frame.editor.selected);
        ui.memory_mut(|memory| memory.request_focus(id));
    }
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
pub fn share(strip: Rect, x: f32) -> f32 {
    (x - strip.left()) / strip.width()
}

/// A handle for each stop, or those round the selected one where there are more than have room.
fn all(ui: &Ui, frame: &mut Frame<'_>, strip: Rect, lane: Rect) {
    let room = (lane.width() / GAP) as usize + 1;
    let shown = fan::shown(frame.stops.len(), frame.editor.selected, room);
    let wanted: Vec<_> = frame.stops[shown.clone()].iter().map(|stop| stop.at * lane.width()).collect();
    let places = fan::fan_out(&wanted, lane.width(), GAP);
    let before = frame.editor.selected;
    let (mut focused, mut grabbed) = (None, None);
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
            grabbed = origin.map(|origin| stop.at - share(strip, origin.x));
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
                "{name}: {} at {at:.4}. Drag: Ctrl snaps to parts, Shift to other stops, Alt leaves a copy, Escape \
                 puts it back. Arrow keys: Shift ten times as far, Ctrl to the next part. Delete removes it",
                String::from(stop.colour)
            );
            response.on_hover_text(text);
        }
    }
    if let Some(offset) = grabbed {
        let before = (frame.stops.clone(), frame.editor.selected);
        if ui.input(|input| input.modifiers.alt) {
            frame.edit_and_select("copy a stop", stops::copy);
            frame.wants_keyboard = true;
        }
        frame.editor.dragged = Some(Drag { offset, before });
    }
    // The selected one is drawn over the others.
    drawn.sort_by_key(|(index, ..)| *index == before);
    for (index, rect, x, colour, is_hovered) in drawn {
        handle(ui, rect, pos2(x, strip.bottom()), colour, (index == before, is_hovered, focused == Some(index)));
    }
    frame.editor.has_keyboard = focused.is_some();
    if focused.is_some() {
        let id = handle_id(ui, before);
        // Escape ends a drag then, not that it has the keyboard.
        let escape = frame.editor.dragged.is_some();
        let filter = EventFilter { horizontal_arrows: true, escape, ..EventFilter::default() };
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
    let snap = frame.editor.snap;
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
            stops::move_to(all, index, stops::nudged(at, steps, modifiers.shift, snap.with(modifiers)))
        });
    }
}

/// Moves the stop that is dragged. Its handle may have become another's meanwhile: the pointer tells where it is.
fn drag(ui: &Ui, frame: &mut Frame<'_>, strip: Rect) {
    let Some(Drag { offset, .. }) = frame.editor.dragged else { return };
    if ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Escape) || input.pointer.secondary_pressed()) {
        frame.give_up();
        frame.wants_keyboard = true;
        return;
    }
    let (pointer, is_down) = ui.input(|input| (input.pointer.latest_pos(), input.pointer.primary_down()));
    let Some(pointer) = pointer.filter(|_| is_down) else {
        frame.editor.dragged = None;
        return;
    };
    ui.set_cursor_icon(CursorIcon::ResizeHorizontal);
    let before = frame.editor.selected;
    let at = stops::snapped(share(strip, pointer.x) + offset, frame.editor.snap.now(ui));
    let is_beside = ui.input(|input| input.modifiers.shift);
    frame.edit_and_select("move a stop", |all, index| {
        let at = if is_beside { stops::beside(all, index, at) } else { at };
        stops::move_to(all, index, at)
    });
    if frame.editor.selected != before {
        frame.wants_keyboard = true;
    }
}
