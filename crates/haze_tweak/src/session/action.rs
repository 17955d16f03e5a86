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
    EngineFlipbook,
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
const COMMAND_ALT: Modifiers = Modifiers::COMMAND.plus(Modifiers::ALT);

/// Entries with more modifiers come first, because egui matches a shortcut without Shift also while Shift is held.
pub const ACTIONS: &[ActionEntry] = &[
    entry(Action::Presets, "New from Preset…", Modifiers::COMMAND, Key::N),
    entry(Action::Open, "Open…", Modifiers::COMMAND, Key::O),
    entry(Action::SaveAs, "Save As…", COMMAND_SHIFT, Key::S),
    entry(Action::Save, "Save", Modifiers::COMMAND, Key::S),
    entry(Action::Copy, "Copy Preset", COMMAND_SHIFT, Key::C),
    entry(Action::CopyLink, "Copy Link", COMMAND_SHIFT, Key::L),
    entry(Action::Paste, "Paste Preset", COMMAND_SHIFT, Key::V),
    entry(Action::Screenshot, "Save Image…", Modifiers::NONE, Key::F12),
    entry(Action::Seeds, "Compare Nine Seeds", COMMAND_SHIFT, Key::E),
    entry(Action::EngineFlipbook, "Flipbook with Normals…", COMMAND_ALT, Key::E),
    entry(Action::Export, "Export…", Modifiers::COMMAND, Key::E),
    entry(Action::Redo, "Redo", COMMAND_SHIFT, Key::Z),
    entry(Action::Redo, "Redo", Modifiers::COMMAND, Key::Y),
    entry(Action::Undo, "Undo", Modifiers::COMMAND, Key::Z),
    entry(Action::Find, "Find Setting…", Modifiers::COMMAND, Key::P),
    entry(Action::Play, "Play or Pause", Modifiers::NONE, Key::Space),
    entry(Action::StepBack, "Previous Frame", Modifiers::NONE, Key::Comma),
    entry(Action::StepOn, "Next Frame", Modifiers::NONE, Key::Period),
    entry(Action::Loop, "Loop Playback", Modifiers::NONE, Key::L),
    entry(Action::Strip, "Show Debug Views", Modifiers::NONE, Key::F4),
    entry(Action::Inspect, "Inspect Pixel", Modifiers::NONE, Key::I),
    entry(Action::NextStage, "Next Debug View", Modifiers::NONE, Key::N),
    entry(Action::Compare(&CompareWith::Saved), "Compare with Saved File", Modifiers::NONE, Key::F5),
    entry(Action::Compare(&CompareWith::FullResolution), "Compare with Full Resolution", Modifiers::NONE, Key::F6),
    entry(Action::Compare(&CompareWith::Forward), "Compare with Forward Shading", Modifiers::NONE, Key::F7),
    entry(Action::Compare(&CompareWith::Reference), "Compare with CPU Reference", Modifiers::NONE, Key::F8),
    entry(Action::Image, "Show Final Image", Modifiers::NONE, Key::Escape),
    entry(Action::InView(InView::Frame), "Frame Selected Light or Smoke", Modifiers::NONE, Key::F),
    entry(Action::InView(InView::Home), "Reset Camera", Modifiers::NONE, Key::Home),
    entry(Action::InView(InView::Delete), "Delete Light", Modifiers::NONE, Key::Delete),
    entry(Action::InView(InView::Duplicate), "Duplicate Light", Modifiers::COMMAND, Key::D),
    entry(Action::InView(InView::Behind), "Light behind Smoke", Modifiers::SHIFT, Key::B),
    entry(Action::InView(InView::Overlay(Overlay::Bounds)), "Show Bounds", Modifiers::NONE, Key::B),
    entry(Action::InView(InView::Overlay(Overlay::LitPlane)), "Show Lit Plane", Modifiers::NONE, Key::K),
    entry(Action::InView(InView::Overlay(Overlay::Particles)), "Show Particles", Modifiers::NONE, Key::P),
    entry(Action::InView(InView::Overlay(Overlay::Grid)), "Show Smoke Buffer Grid", Modifiers::NONE, Key::G),
    entry(Action::InView(InView::Turntable), "Turntable: Rotate Lights", Modifiers::NONE, Key::T),
    entry(Action::InView(InView::Face(CameraSide::Back)), "Back View", Modifiers::COMMAND, Key::Num1),
    entry(Action::InView(InView::Face(CameraSide::Front)), "Front View", Modifiers::NONE, Key::Num1),
    entry(Action::InView(InView::Face(CameraSide::Left)), "Left View", Modifiers::COMMAND, Key::Num3),
    entry(Action::InView(InView::Face(CameraSide::Right)), "Right View", Modifiers::NONE, Key::Num3),
    entry(Action::InView(InView::Face(CameraSide::Bottom)), "Bottom View", Modifiers::COMMAND, Key::Num7),
    entry(Action::InView(InView::Face(CameraSide::Top)), "Top View", Modifiers::NONE, Key::Num7),
    entry(Action::Help, "Keyboard and Mouse", Modifiers::NONE, Key::F1),
    entry(Action::Help, "Keyboard and Mouse", Modifiers::NONE, Key::Questionmark),
];

/// Returns the first shortcut of an action.
pub fn keys_of(action: Action) -> Option<KeyboardShortcut> {
    ACTIONS.iter().find(|entry| entry.action == action).map(|entry| entry.keys)
}

/// Pointer and keyboard gestures for the key list, each with its effect.
pub const GESTURES: &[(&str, &str)] = &[
    ("Drag, or middle button", "Orbit"),
    ("Shift or Alt + middle button", "Pan"),
    ("Wheel, Ctrl + middle, Alt + right button", "Zoom; the wheel zooms towards the pointer"),
    ("Right button + W A S D Q E", "Fly; Shift flies faster, the wheel changes the speed"),
    ("Right click", "Menu: add a light here"),
    ("Click a light", "Select it, then drag its handles: Shift for precision, Ctrl to snap, Escape to cancel"),
    ("Click while inspecting", "Pin the pixel; click again to unpin"),
    (
        "Ctrl + drag while inspecting",
        "Paint the ramp that lights this smoke: up lightens, down darkens, right warms, left cools",
    ),
    ("Double click a name", "Reset to the saved value"),
    ("Diamond beside a name", "Add or delete a keyframe at the time that is shown"),
    ("Click a value", "Type a number, with or without its unit"),
    ("Grid icon beside a name", "Compare values of the setting side by side"),
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
