//! Ends a frame's input where a pointer button is pressed or released.

use eframe::egui::Event;

/// Moves the events after the first part of a gesture to `later`, and prepends those that were moved before. During a
/// long frame, a gesture may begin, move and end; egui has only one pointer position for the frame. So a press, the
/// movement and the release come in frames of their own: a press is where it was made, the movement before a release
/// still moves the dragged thing, and the movement after it does not.
pub fn split_events_at_buttons(later: &mut Vec<Event>, events: &mut Vec<Event>) {
    events.splice(..0, later.drain(..));
    *later = events.split_off(first_part(events));
}

/// Returns the number of events that one frame takes.
fn first_part(events: &[Event]) -> usize {
    let mut is_pressed = false;
    let mut has_moved = false;
    for (index, event) in events.iter().enumerate() {
        match event {
            Event::PointerButton { pressed: false, .. } => return if has_moved { index } else { index + 1 },
            Event::PointerButton { .. } => is_pressed = true,
            Event::PointerMoved(_) if is_pressed => return index,
            Event::PointerMoved(_) => has_moved = true,
            _ => {}
        }
    }
    events.len()
}

#[cfg(test)]
mod tests {
    use eframe::egui::{Modifiers, PointerButton, Pos2, pos2};

    use super::*;

    fn button(pos: Pos2, pressed: bool) -> Event {
        Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers: Modifiers::NONE }
    }

    /// Returns the events of each frame.
    fn frames(mut events: Vec<Event>) -> Vec<Vec<Event>> {
        let mut frames = Vec::new();
        let mut later = Vec::new();
        loop {
            split_events_at_buttons(&mut later, &mut events);
            frames.push(std::mem::take(&mut events));
            if later.is_empty() {
                return frames;
            }
        }
    }

    #[test]
    fn press_movement_and_release_come_in_frames_of_their_own() {
        let on = pos2(10.0, 5.0);
        let off = pos2(-300.0, 5.0);
        let moved = Event::PointerMoved;
        let all =
            [moved(on), button(on, true), moved(off), moved(on), button(on, false), moved(off), button(off, true)];
        assert_eq!(frames(all.to_vec()), [&all[..2], &all[2..4], &all[4..5], &all[5..]].map(<[_]>::to_vec));
    }

    #[test]
    fn a_click_without_movement_takes_one_frame_and_events_keep_their_order() {
        let at = pos2(10.0, 5.0);
        let click = vec![Event::PointerMoved(at), Event::Copy];
        assert_eq!(frames(click.clone()), [click]);
        let click = vec![button(at, true), Event::Copy, button(at, false)];
        assert_eq!(frames(click.clone()), [click]);
        let mut later = vec![button(at, false)];
        let mut events = vec![Event::PointerMoved(at)];
        split_events_at_buttons(&mut later, &mut events);
        assert_eq!((events, later), (vec![button(at, false)], vec![Event::PointerMoved(at)]));
    }
}
