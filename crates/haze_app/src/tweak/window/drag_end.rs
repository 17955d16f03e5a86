//! Ends a frame's input with the release of a pointer button.

use eframe::egui::Event;

/// Moves the events after the first release of a button to `later`, and prepends those that were moved before. egui
/// gives a released control the pointer position at the end of the frame; during a long frame, a slider would follow
/// the pointer there.
pub fn split_events_at_release(later: &mut Vec<Event>, events: &mut Vec<Event>) {
    events.splice(..0, later.drain(..));
    let is_release = |event: &Event| matches!(event, Event::PointerButton { pressed: false, .. });
    if let Some(at) = events.iter().position(is_release) {
        *later = events.split_off(at + 1);
    }
}

#[cfg(test)]
mod tests {
    use eframe::egui::{Modifiers, PointerButton, Pos2, pos2};

    use super::*;

    #[test]
    fn events_after_a_release_go_to_the_next_frame() {
        let button = |pos: Pos2, pressed| Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        };
        let (on, off) = (pos2(10.0, 5.0), pos2(-300.0, 5.0));
        let mut events = vec![
            button(on, true),
            Event::PointerMoved(on),
            button(on, false),
            Event::PointerMoved(off),
            button(off, true),
        ];
        let (all, mut later) = (events.clone(), Vec::new());
        split_events_at_release(&mut later, &mut events);
        assert_eq!((&events[..], &later[..]), (&all[..3], &all[3..]));
        let mut events = vec![button(off, false), Event::PointerMoved(on)];
        split_events_at_release(&mut later, &mut events);
        assert_eq!((events.len(), later.len()), (3, 1));
        let mut events = Vec::new();
        split_events_at_release(&mut later, &mut events);
        assert_eq!((events, later.len()), (vec![Event::PointerMoved(on)], 0));
    }
}
