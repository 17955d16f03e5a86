//! What can be done by key or by menu: one table for the keys, the menus and the list of both.

use eframe::egui::{Key, KeyboardShortcut, Modifiers};

/// Something that the window does when it is told to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    Undo,
    Redo,
    Find,
    Play,
    StepBack,
    StepOn,
    Loop,
    Strip,
    NextStage,
    Picture,
    Help,
}

/// An action, what it is called, and its keys.
pub struct Entry {
    pub action: Action,
    pub name: &'static str,
    pub keys: KeyboardShortcut,
}

const fn entry(action: Action, name: &'static str, modifiers: Modifiers, key: Key) -> Entry {
    Entry { action, name, keys: KeyboardShortcut::new(modifiers, key) }
}

const COMMAND_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

/// Those with more modifiers come first: egui lets Shift pass where it is not asked for.
pub const ACTIONS: &[Entry] = &[
    entry(Action::Redo, "Redo", COMMAND_SHIFT, Key::Z),
    entry(Action::Undo, "Undo", Modifiers::COMMAND, Key::Z),
    entry(Action::Find, "Find a setting", Modifiers::COMMAND, Key::P),
    entry(Action::Play, "Play or pause", Modifiers::NONE, Key::Space),
    entry(Action::StepBack, "A frame back", Modifiers::NONE, Key::Comma),
    entry(Action::StepOn, "A frame on", Modifiers::NONE, Key::Period),
    entry(Action::Loop, "Go round in the range", Modifiers::NONE, Key::L),
    entry(Action::Strip, "Shade tree strip", Modifiers::NONE, Key::F4),
    entry(Action::NextStage, "Next stage of the shading", Modifiers::NONE, Key::N),
    entry(Action::Picture, "Back to the picture", Modifiers::NONE, Key::Escape),
    entry(Action::Help, "This list", Modifiers::NONE, Key::F1),
];

/// What else is done with pointer and keys.
pub const GESTURES: &[(&str, &str)] = &[
    ("Drag in the picture, or middle button", "Orbit"),
    ("Shift drag", "Pan"),
    ("Wheel, Ctrl middle, Alt right", "Nearer and farther"),
    ("Right button with W A S D Q E", "Fly; Shift for faster"),
    ("Double click on a name", "Sets it back"),
    ("Click on a value", "Type it, with its unit or without"),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_actions_have_the_same_keys() {
        for (index, entry) in ACTIONS.iter().enumerate() {
            assert!(ACTIONS[..index].iter().all(|other| other.keys != entry.keys), "{}", entry.name);
        }
    }

    #[test]
    fn an_action_is_not_hidden_by_one_with_fewer_modifiers() {
        for (index, entry) in ACTIONS.iter().enumerate() {
            let hides = |other: &&Entry| other.keys.logical_key == entry.keys.logical_key;
            for other in ACTIONS[index + 1..].iter().filter(hides) {
                assert!(!other.keys.modifiers.contains(entry.keys.modifiers), "{} hides {}", entry.name, other.name);
            }
        }
    }
}
