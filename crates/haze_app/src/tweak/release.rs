//! What happens in a frame ends with the release of a button.

use eframe::egui::Event;

/// Keeps what happened after the first release of a button for later, and takes what was kept before. egui gives a control that was
/// let go the place where the pointer is at the end of the frame: in one that takes long a slider would follow it there.
pub fn split_at_release(later: &mut Vec<Event>, events: &mut Vec<Event>) {
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
    fn where_the_pointer_goes_after_a_release_is_of_the_next_frame() {
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
        split_at_release(&mut later, &mut events);
        assert_eq!((&events[..], &later[..]), (&all[..3], &all[3..]));
        let mut events = vec![button(off, false), Event::PointerMoved(on)];
        split_at_release(&mut later, &mut events);
        assert_eq!((events.len(), later.len()), (3, 1));
        let mut events = Vec::new();
        split_at_release(&mut later, &mut events);
        assert_eq!((events, later.len()), (vec![Event::PointerMoved(on)], 0));
    }
}
