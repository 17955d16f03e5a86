//! Hints after the first start, shown one at a time. A hint stays until its action is done or it is dismissed.

use eframe::egui::Rect;
use glam::Vec3;
use haze_preset::{Preset, PresetSystem};

/// One hint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hint {
    Orbit,
    Light,
    Look,
    Find,
    Keys,
}

/// All hints in their order: the hint, its name in the layout file, and its text. If a key does the action, the text
/// follows the name of the key.
pub const HINTS: [(Hint, &str, &str); 5] = [
    (Hint::Orbit, "orbit", "Drag in the image to orbit around the smoke."),
    (Hint::Light, "light", "Click a light in the image to select it, then drag it."),
    (Hint::Look, "look", "These sliders shape the look. The other tabs have every setting."),
    (Hint::Find, "find", "finds a setting by its name or description."),
    (Hint::Keys, "keys", "lists all keys and gestures."),
];

/// Part of the window that a hint points at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WindowPart {
    Image,
    Settings,
    Find,
    Keys,
}

impl Hint {
    pub fn window_part(self) -> WindowPart {
        match self {
            Self::Orbit | Self::Light => WindowPart::Image,
            Self::Look => WindowPart::Settings,
            Self::Find => WindowPart::Find,
            Self::Keys => WindowPart::Keys,
        }
    }
}

/// Hints that are still to be shown.
#[derive(Clone, Debug)]
pub struct FirstRunHints {
    open: Vec<Hint>,
    parts: [Rect; 4],
    /// Camera position and systems of the previous frame, to detect changes.
    last: Option<(Vec3, Vec<PresetSystem>)>,
}

impl Default for FirstRunHints {
    fn default() -> Self {
        Self { open: Vec::new(), parts: [Rect::NOTHING; 4], last: None }
    }
}

impl FirstRunHints {
    /// Starts with all hints.
    pub fn begin(&mut self) {
        self.open = HINTS.map(|(hint, ..)| hint).into();
        self.last = None;
    }

    /// Continues with the hints of these names.
    pub fn resume(&mut self, names: &[String]) {
        let left = HINTS.into_iter().filter(|(_, name, _)| names.iter().any(|left| left == name));
        self.open = left.map(|(hint, ..)| hint).collect();
    }

    /// Returns the names of the remaining hints.
    pub fn left(&self) -> Vec<String> {
        let left = HINTS.into_iter().filter(|(hint, ..)| self.open.contains(hint));
        left.map(|(_, name, _)| name.to_owned()).collect()
    }

    /// Returns the current hint and the rectangle that it points at.
    pub fn shown(&self) -> Option<(Hint, Rect)> {
        self.open.first().map(|hint| (*hint, self.parts[hint.window_part() as usize]))
    }

    /// Records the rectangle of a part of the window.
    pub fn record_rect(&mut self, part: WindowPart, rect: Rect) {
        self.parts[part as usize] = rect;
    }

    /// Dismisses the current hint. Returns false if none was shown.
    pub fn dismiss(&mut self) -> bool {
        let is_shown = !self.open.is_empty();
        self.open.drain(..usize::from(is_shown));
        is_shown
    }

    pub fn dismiss_all(&mut self) {
        self.open.clear();
    }

    /// Removes the hints whose actions were just done.
    pub fn follow(&mut self, preset: &Preset, done: &UserActivity) {
        if self.open.is_empty() {
            return;
        }
        let camera = preset.camera.position;
        let systems = &preset.systems;
        let last = self.last.get_or_insert_with(|| (camera, systems.clone()));
        let has_moved = last.0 != camera;
        let has_set = last.1 != *systems;
        last.0 = camera;
        if has_set {
            last.1.clone_from(systems);
        }
        self.open.retain(|hint| !match hint {
            Hint::Orbit => has_moved && done.is_pressing,
            Hint::Light => done.is_dragging_light,
            Hint::Look => has_set && done.is_look_visible,
            Hint::Find => done.is_searching,
            Hint::Keys => done.is_key_list_open,
        });
    }
}

/// User activity in a frame.
#[allow(clippy::struct_excessive_bools, reason = "independent flags")]
pub struct UserActivity {
    /// A pointer button or the wheel is in use.
    pub is_pressing: bool,
    pub is_dragging_light: bool,
    /// The sliders of the look tab are visible.
    pub is_look_visible: bool,
    pub is_searching: bool,
    pub is_key_list_open: bool,
}
