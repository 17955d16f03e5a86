//! Handles of the stops: drawing, and input by pointer and keys.

use egui::{self, CursorIcon, EventFilter, Id, Key, Modifiers, PointerButton, Rect, Response, Sense, Ui};
use egui::{pos2, vec2};

use super::edit_context::{Drag, EditContext, MOVE, REMOVE, Selected};
use super::paint::{HandleState, color32, handle, readout};
use super::selection::Selection;
use super::{handle_layout, stop_operations};

/// Size of a handle, points.
const HANDLE: egui::Vec2 = vec2(12.0, 16.0);
/// Minimum distance between the centers of two handles, points.
pub const GAP: f32 = 15.0;
/// Speed of a stop relative to the pointer while Alt is held.
const FINE: f32 = 0.1;

/// Distance above the strip or below the handles at which a dragged stop is removed, points.
const OFF: f32 = 24.0;

/// Draws the handles in their lane and handles their input. Returns the position of the stop under the pointer.
pub fn show(ui: &Ui, context: &mut EditContext<'_>, strip: Rect, lane: Rect) -> Option<f32> {
    lane_input(ui, context, lane);
    let pointed_at = show_handles(ui, context, strip, lane);
    update_drag(ui, context, strip.union(lane), strip);
    // Stops selected in this frame may have been removed in it.
    context.editor.selection.clamp_to(context.stops.len());
    if context.requests_focus {
        // Must come last: drawing the handles after a click elsewhere removes their focus.
        let index = context.editor.cursor.unwrap_or(context.editor.selection.lead());
        ui.memory_mut(|memory| memory.request_focus(handle_id(ui, index)));
    }
    pointed_at
}

/// Handles input on the lane outside the handles. A click selects the nearest stop, also one without a handle; a drag
/// selects the stops under the band.
fn lane_input(ui: &Ui, context: &mut EditContext<'_>, lane: Rect) {
    let response = ui.interact(lane, ui.scope_id().with("lane"), Sense::click_and_drag());
    let (origin, modifiers) = ui.input(|input| (input.pointer.press_origin(), input.modifiers));
    if let Some(at) = response.interact_pointer_pos().filter(|_| response.clicked()) {
        let at = strip_position(lane, at.x);
        let apart = |index: &usize| (context.stops[*index].at - at).abs();
        let nearest = (0..context.stops.len()).min_by(|a, b| apart(a).total_cmp(&apart(b)));
        context.select(nearest.unwrap_or(0), modifiers);
        context.requests_focus = true;
    }
    if response.drag_started() {
        context.editor.band = origin.map(|origin| strip_position(lane, origin.x));
    }
    let Some(from) = context.editor.band else { return };
    let Some(pointer) = response.interact_pointer_pos().filter(|_| response.dragged()) else {
        context.editor.band = None;
        context.requests_focus = true;
        return;
    };
    let to = strip_position(lane, pointer.x);
    let first = context.stops.partition_point(|stop| stop.at < from.min(to));
    let behind = context.stops.partition_point(|stop| stop.at <= from.max(to));
    if let Some(last) = behind.checked_sub(1).filter(|last| *last >= first) {
        context.editor.cursor = None;
        context.editor.selection =
            if from < to { Selection::between(first, last) } else { Selection::between(last, first) };
    }
    let x = |fraction: f32| lane.left() + fraction.clamp(0.0, 1.0) * lane.width();
    let band = Rect::from_x_y_ranges(x(from.min(to))..=x(from.max(to)), lane.y_range());
    ui.painter().rect_filled(band, 0.0, ui.visuals().selection.bg_fill.gamma_multiply(0.5));
}

fn handle_id(ui: &Ui, index: usize) -> Id {
    ui.scope_id().with(("stop", index))
}

/// Converts x to a position on the strip: 0 to 1 inside it.
pub fn strip_position(strip: Rect, x: f32) -> f32 {
    (x - strip.left()) / strip.width()
}

/// Draws and handles all handles that fit. Returns the position of the stop under the pointer.
fn show_handles(ui: &Ui, context: &mut EditContext<'_>, strip: Rect, lane: Rect) -> Option<f32> {
    let room = (lane.width() / GAP) as usize + 1;
    let middle = context.editor.cursor.unwrap_or(context.editor.selection.lead());
    let shown = handle_layout::visible_handles(context.stops.len(), middle, room);
    let wanted: Vec<_> = context.stops[shown.clone()].iter().map(|stop| stop.at * lane.width()).collect();
    let positions = handle_layout::spread(&wanted, lane.width(), GAP);
    // State before any edit in this frame.
    let before = (context.stops.clone(), context.editor.selection.clone());
    let mut focused = None;
    let mut pointed_at = None;
    let mut drawn = Vec::new();
    for ((index, position), wanted) in shown.zip(positions).zip(wanted) {
        let stop = &before.0[index];
        let middle = pos2(lane.left() + position, lane.bottom() - 0.5 * HANDLE.y - 2.0);
        let rect = Rect::from_center_size(middle, HANDLE);
        let response = ui.interact(rect.expand2(vec2(1.0, 2.0)), handle_id(ui, index), Sense::click_and_drag());
        let name = format!("stop {}", index + 1);
        response.widget_info(|| egui::WidgetInfo::slider(true, f64::from(stop.at), &name));
        handle_pointer(ui, context, &response, index, &before);
        if response.has_focus() {
            focused = Some(index);
        }
        drawn.push((index, rect, lane.left() + wanted, color32(stop.color), response.hovered()));
        if context.editor.dragged.is_none() && response.hovered() {
            ui.set_cursor_icon(CursorIcon::ResizeHorizontal);
            pointed_at = Some(stop.at);
            response.on_hover_text(format!("{} at {:.4}. Drag it off to delete", String::from(stop.color), stop.at));
        }
    }
    // Selected handles are drawn over the others, the lead over all.
    let (_, selection) = &before;
    drawn.sort_by_key(|(index, ..)| (selection.contains(*index), *index == selection.lead()));
    for (index, rect, x, color, is_hovered) in drawn {
        let state =
            HandleState { is_selected: selection.contains(index), is_hovered, has_focus: focused == Some(index) };
        handle(ui, rect, pos2(x, strip.bottom()), color, state);
    }
    context.editor.has_keyboard = focused.is_some();
    if let Some(index) = focused {
        // Then Escape cancels the drag or reduces the selection instead of removing the focus.
        let escape = context.editor.dragged.is_some() || context.editor.selection.is_many();
        let filter = EventFilter { horizontal_arrows: true, vertical_arrows: true, escape, ..EventFilter::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(handle_id(ui, index), filter));
        let cursor = context.editor.cursor;
        handle_keys(ui, context);
        if context.editor.selection != before.1 || context.editor.cursor != cursor {
            context.requests_focus = true;
        }
    }
    pointed_at
}

/// Handles pointer input on a handle, and focus changes.
fn handle_pointer(ui: &Ui, context: &mut EditContext<'_>, response: &Response, index: usize, before: &Selected) {
    let (origin, modifiers, is_space) =
        ui.input(|input| (input.pointer.press_origin(), input.modifiers, input.key_pressed(Key::Space)));
    if response.middle_clicked() {
        if !context.editor.selection.contains(index) {
            context.editor.selection = Selection::one(index);
        }
        remove(context);
        context.requests_focus = true;
    } else if response.drag_started_by(PointerButton::Primary) {
        response.request_focus();
        // All selected stops are dragged together.
        if !context.editor.selection.contains(index) {
            context.editor.selection = Selection::one(index);
        }
        context.editor.selection.set_lead(index);
        if modifiers.alt {
            context.edit_selected(["copy a stop", "copy stops"], stop_operations::copy);
            context.requests_focus = true;
        }
        if let Some(origin) = origin {
            let position = before.0[index].at;
            begin_drag(context, origin.x, position, before.clone(), !modifiers.alt);
        }
    } else if response.clicked() {
        response.request_focus();
        let modifiers = if is_space { Modifiers::COMMAND } else { modifiers };
        context.select(index, modifiers);
    } else if response.gained_focus() && context.editor.dragged.is_none() && context.editor.cursor != Some(index) {
        // Focus by Tab selects the stop. Focus by a click or another key has already set the selection.
        if !context.editor.selection.contains(index) || context.editor.selection.lead() != index {
            context.select(index, Modifiers::NONE);
        }
    }
}

/// Begins a drag of the selected stops, with the lead at `position` and the pointer at `x`.
pub fn begin_drag(context: &mut EditContext<'_>, x: f32, position: f32, before: Selected, alt_slows: bool) {
    let from = (context.stops.clone(), context.editor.selection.clone());
    let now = context.stops.clone();
    context.editor.dragged = Some(Drag { x, position, from, before, now, alt_slows });
}

fn remove(context: &mut EditContext<'_>) {
    context.edit_selected(REMOVE, stop_operations::remove);
}

/// Keys that the focused stop handles, with any modifiers.
const HANDLED_KEYS: [Key; 8] =
    [Key::ArrowLeft, Key::ArrowRight, Key::ArrowUp, Key::ArrowDown, Key::Home, Key::End, Key::Delete, Key::Backspace];

/// Handles keys while a stop has keyboard focus.
fn handle_keys(ui: &Ui, context: &mut EditContext<'_>) {
    let handles_escape = context.editor.dragged.is_none() && context.editor.selection.is_many();
    let mut pressed = Vec::new();
    ui.input_mut(|input| {
        input.events.retain(|event| {
            let egui::Event::Key { key, pressed: true, modifiers, .. } = event else { return true };
            let is_handled = match key {
                Key::A => modifiers.command,
                Key::Escape => handles_escape,
                key => HANDLED_KEYS.contains(key),
            };
            if is_handled {
                pressed.push((*key, *modifiers));
            }
            !is_handled
        });
    });
    for (key, modifiers) in pressed {
        let last = context.stops.len().saturating_sub(1);
        let here = context.editor.cursor.unwrap_or(context.editor.selection.lead());
        match key {
            Key::ArrowLeft => nudge(context, -1.0, modifiers),
            Key::ArrowRight => nudge(context, 1.0, modifiers),
            Key::ArrowUp => move_focus(context, here.saturating_sub(1), modifiers),
            Key::ArrowDown => move_focus(context, (here + 1).min(last), modifiers),
            Key::Home => move_focus(context, 0, modifiers),
            Key::End => move_focus(context, last, modifiers),
            Key::A => {
                context.editor.selection = Selection::between(0, last);
                context.editor.cursor = None;
            }
            Key::Escape => context.select(context.editor.selection.lead(), Modifiers::NONE),
            _ => remove(context),
        }
    }
}

fn nudge(context: &mut EditContext<'_>, steps: f32, modifiers: Modifiers) {
    let Some(at) = context.lead().map(|lead| lead.at) else { return };
    let at = stop_operations::nudge_position(at, steps, modifiers.shift, context.editor.snap.with(modifiers));
    context.edit_selected(MOVE, |all, selection| stop_operations::move_to(all, selection, at));
}

/// Moves keyboard focus to a stop and selects it; with Shift extends the range to it; with Ctrl leaves the selection
/// unchanged until Space is pressed.
fn move_focus(context: &mut EditContext<'_>, index: usize, modifiers: Modifiers) {
    if modifiers.command {
        context.editor.cursor = Some(index);
    } else {
        context.select(index, modifiers);
    }
}

/// Updates the drag by the pointer. Uses no response of a handle, since the stops' indices may change during the drag. Off `whole`,
/// the strip with its handles, the stops are removed until the pointer comes back.
fn update_drag(ui: &Ui, context: &mut EditContext<'_>, whole: Rect, strip: Rect) {
    let Some(mut drag) = context.editor.dragged.take_if(|drag| drag.now == *context.stops) else {
        context.editor.dragged = None;
        return;
    };
    if ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Escape) || input.pointer.secondary_pressed()) {
        context.editor.dragged = Some(drag);
        context.cancel_drag();
        context.requests_focus = true;
        return;
    }
    let (pointer, is_down, modifiers) =
        ui.input(|input| (input.pointer.latest_pos(), input.pointer.primary_down(), input.modifiers));
    let Some(pointer) = pointer.filter(|_| is_down) else { return };
    ui.set_cursor_icon(CursorIcon::ResizeHorizontal);
    drag.alt_slows |= !modifiers.alt;
    let is_fine = modifiers.alt && drag.alt_slows;
    drag.position += (pointer.x - drag.x) / strip.width() * if is_fine { FINE } else { 1.0 };
    drag.x = pointer.x;
    let (from, selection) = &drag.from;
    let is_off = pointer.y < whole.top() - OFF || pointer.y > whole.bottom() + OFF;
    if is_off && selection.count() < from.len() {
        context.edit_selected(REMOVE, |all, removed| {
            (*all, *removed) = drag.from.clone();
            stop_operations::remove(all, removed);
        });
        context.editor.pending = Some(REMOVE[usize::from(selection.is_many())]);
        ui.set_cursor_icon(CursorIcon::NoDrop);
        if let Some(was) = from.get(selection.lead()) {
            let text = format!("Release to delete {}", String::from(was.color));
            readout(ui, pointer.x.clamp(strip.left(), strip.right()), strip, color32(was.color), text);
        }
        drag.now.clone_from(context.stops);
        context.editor.dragged = Some(drag);
        return;
    }
    if context.editor.pending.is_some_and(|step| REMOVE.contains(&step)) {
        // Back on the strip.
        context.editor.pending = Some(MOVE[usize::from(selection.is_many())]);
    }
    let at = stop_operations::snap_to_parts(drag.position, context.editor.snap.with(modifiers));
    let at = if modifiers.shift { stop_operations::snap_to_stop(from, selection, at) } else { at };
    let led = context.editor.selection.lead();
    context.edit_selected(MOVE, |all, moved| {
        (*all, *moved) = drag.from.clone();
        stop_operations::move_to(all, moved, at);
    });
    context.requests_focus |= context.editor.selection.lead() != led;
    drag.now.clone_from(context.stops);
    if let (Some(lead), Some(was)) = (context.lead(), drag.from.0.get(drag.from.1.lead())) {
        let mut text = format!("{:.4}  {}", lead.at, String::from(lead.color));
        match drag.from.1.count() {
            1 => {}
            count => text += &format!("  {:+.4}, {count} stops", lead.at - was.at),
        }
        if is_fine {
            text += "  fine";
        }
        readout(ui, strip.left() + lead.at * strip.width(), strip, color32(lead.color), text);
    }
    context.editor.dragged = Some(drag);
}
