//! Actions that a key or a menu item triggers. [`ACTIONS`] is the one table for key bindings, menus and the key list.

use eframe::egui::{Key, KeyboardShortcut, Modifiers};
use glam::Vec3;

use super::comparison::CompareWith;
use super::view_options::Overlay;

/// Command to the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    Presets,
    Open,
    Save,
    SaveAs,
    Copy,
    CopyLink,
    Paste,
    Screenshot,
    Export,
    Seeds,
    Undo,
    Redo,
    Find,
    Play,
    StepBack,
    StepOn,
    Loop,
    Strip,
    Inspect,
    NextStage,
    /// Shows this comparison beside the image, or hides it if it is shown.
    Compare(&'static CompareWith),
    Image,
    Help,
    InView(InView),
}

/// Command to the viewport.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InView {
    Frame,
    Home,
    /// Deletes the selected light.
    Delete,
    Duplicate,
    /// Puts the selected light, or a new one, behind the smoke.
    Behind,
    Overlay(Overlay),
    Turntable,
    Face(CameraSide),
}

/// Side from which the camera looks at its target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CameraSide {
    Front,
    Back,
    Right,
    Left,
    Top,
    Bottom,
}

impl CameraSide {
    /// Returns the unit direction from the camera's target to the camera.
    pub fn way(self) -> Vec3 {
        match self {
            Self::Front => Vec3::Z,
            Self::Back => Vec3::NEG_Z,
            Self::Right => Vec3::X,
            Self::Left => Vec3::NEG_X,
            Self::Top => Vec3::Y,
            Self::Bottom => Vec3::NEG_Y,
        }
    }
}

/// Action with its menu name and its shortcut.
pub struct ActionEntry {
    pub action: Action,
    pub name: &'static str,
    pub keys: KeyboardShortcut,
}

const fn entry(action: Action, name: &'static str, modifiers: Modifiers, key: Key) -> ActionEntry {
    ActionEntry { action, name, keys: KeyboardShortcut::new(modifiers, key) }
}

const COMMAND_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

/// Entries with more modifiers come first, because egui matches a shortcut without Shift also while Shift is held.
pub const ACTIONS: &[ActionEntry] = &[
    entry(Action::Presets, "New from a preset", Modifiers::COMMAND, Key::N),
    entry(Action::Open, "Open a preset", Modifiers::COMMAND, Key::O),
    entry(Action::SaveAs, "Save as", COMMAND_SHIFT, Key::S),
    entry(Action::Save, "Save", Modifiers::COMMAND, Key::S),
    entry(Action::Copy, "Copy the preset as text", COMMAND_SHIFT, Key::C),
    entry(Action::CopyLink, "Copy link", COMMAND_SHIFT, Key::L),
    entry(Action::Paste, "Paste a preset", COMMAND_SHIFT, Key::V),
    entry(Action::Screenshot, "Save the picture", Modifiers::NONE, Key::F12),
    entry(Action::Seeds, "Nine seeds, side by side", COMMAND_SHIFT, Key::E),
    entry(Action::Export, "Export", Modifiers::COMMAND, Key::E),
    entry(Action::Redo, "Redo", COMMAND_SHIFT, Key::Z),
    entry(Action::Undo, "Undo", Modifiers::COMMAND, Key::Z),
    entry(Action::Find, "Find a setting", Modifiers::COMMAND, Key::P),
    entry(Action::Play, "Play or pause", Modifiers::NONE, Key::Space),
    entry(Action::StepBack, "A frame back", Modifiers::NONE, Key::Comma),
    entry(Action::StepOn, "A frame on", Modifiers::NONE, Key::Period),
    entry(Action::Loop, "Loop the time range", Modifiers::NONE, Key::L),
    entry(Action::Strip, "Shade tree strip", Modifiers::NONE, Key::F4),
    entry(Action::Inspect, "Inspect the pixel under the pointer", Modifiers::NONE, Key::I),
    entry(Action::NextStage, "Next stage of the shading", Modifiers::NONE, Key::N),
    entry(Action::Compare(&CompareWith::Saved), "Compare with the file", Modifiers::NONE, Key::F5),
    entry(Action::Compare(&CompareWith::FullResolution), "Compare with full resolution", Modifiers::NONE, Key::F6),
    entry(Action::Compare(&CompareWith::Forward), "Compare with forward", Modifiers::NONE, Key::F7),
    entry(Action::Compare(&CompareWith::Reference), "Compare with the CPU reference", Modifiers::NONE, Key::F8),
    entry(Action::Image, "Back to the picture", Modifiers::NONE, Key::Escape),
    entry(Action::InView(InView::Frame), "Show the selected light, or all of the smoke", Modifiers::NONE, Key::F),
    entry(Action::InView(InView::Home), "Back to the saved camera", Modifiers::NONE, Key::Home),
    entry(Action::InView(InView::Delete), "Delete the selected light", Modifiers::NONE, Key::Delete),
    entry(Action::InView(InView::Duplicate), "Duplicate the selected light", Modifiers::COMMAND, Key::D),
    entry(Action::InView(InView::Behind), "A light behind the smoke", Modifiers::SHIFT, Key::B),
    entry(Action::InView(InView::Overlay(Overlay::Bounds)), "Bounds", Modifiers::NONE, Key::B),
    entry(Action::InView(InView::Overlay(Overlay::LitPlane)), "Lit plane", Modifiers::NONE, Key::K),
    entry(Action::InView(InView::Overlay(Overlay::Particles)), "Particles", Modifiers::NONE, Key::P),
    entry(Action::InView(InView::Overlay(Overlay::Grid)), "Texels of the smoke", Modifiers::NONE, Key::G),
    entry(Action::InView(InView::Turntable), "Lights round the smoke", Modifiers::NONE, Key::T),
    entry(Action::InView(InView::Face(CameraSide::Back)), "From behind", Modifiers::COMMAND, Key::Num1),
    entry(Action::InView(InView::Face(CameraSide::Front)), "From the front", Modifiers::NONE, Key::Num1),
    entry(Action::InView(InView::Face(CameraSide::Left)), "From the left", Modifiers::COMMAND, Key::Num3),
    entry(Action::InView(InView::Face(CameraSide::Right)), "From the right", Modifiers::NONE, Key::Num3),
    entry(Action::InView(InView::Face(CameraSide::Bottom)), "From below", Modifiers::COMMAND, Key::Num7),
    entry(Action::InView(InView::Face(CameraSide::Top)), "From above", Modifiers::NONE, Key::Num7),
    entry(Action::Help, "This list", Modifiers::NONE, Key::F1),
    entry(Action::Help, "The same", Modifiers::NONE, Key::Questionmark),
];

/// Returns the first shortcut of an action.
pub fn keys_of(action: Action) -> Option<KeyboardShortcut> {
    ACTIONS.iter().find(|entry| entry.action == action).map(|entry| entry.keys)
}

/// Pointer and keyboard gestures for the key list, each with its effect.
pub const GESTURES: &[(&str, &str)] = &[
    ("Drag in the picture, or middle button", "Orbit"),
    ("Shift middle, Alt middle", "Pan"),
    ("Wheel, Ctrl middle, Alt right", "Nearer and farther; the wheel towards the pointer"),
    ("Right button with W A S D Q E", "Fly; Shift for faster, the wheel for another speed"),
    ("Right click in the picture", "Adds a light here"),
    ("Click on a light", "Selects it: drag its handles; Shift is slow, Ctrl snaps, Escape puts it back"),
    ("Click while inspecting", "Keeps the pixel; another click lets it go"),
    ("Double click on a name", "Sets it back"),
    ("Click on a value", "Type it, with its unit or without"),
    ("Squares beside a name", "Its values on a sheet, side by side"),
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
            let hides = |other: &&ActionEntry| other.keys.logical_key == entry.keys.logical_key;
            for other in ACTIONS[index + 1..].iter().filter(hides) {
                assert!(!other.keys.modifiers.contains(entry.keys.modifiers), "{} hides {}", entry.name, other.name);
            }
        }
    }
}
