//! Hints after the first start, shown one at a time. A hint stays until its action is done or it is dismissed.

use eframe::egui::Rect;
use glam::Vec3;
use haze_preset::{Preset, PresetSystem};

/// One hint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hint {
    Play,
    Orbit,
    Light,
    Lamp,
    Look,
    Ramp,
    System,
    Find,
    Keys,
}

/// All hints in their order: the hint, its name in the layout file, and its text. If a key does the action, the text
/// follows the name of the key.
pub const HINTS: [(Hint, &str, &str); 9] = [
    (Hint::Play, "play", "plays the smoke, and pauses it."),
    (Hint::Orbit, "orbit", "Drag in the image to orbit around the smoke."),
    (Hint::Light, "light", "Click a light in the image to select it, then drag it."),
    (Hint::Lamp, "lamp", "Right-click in the image to add a lamp there."),
    (Hint::Look, "look", "These sliders shape the look. The other tabs have every setting."),
    (
        Hint::Ramp,
        "ramp",
        "A ramp gives the smoke its colors from dark to bright. Looks… shows this smoke with every ramp.",
    ),
    (Hint::System, "system", "Adds a system to the smoke: flames, sparks, steam, dust."),
    (Hint::Find, "find", "finds a setting by its name or description."),
    (Hint::Keys, "keys", "lists all keys and gestures."),
];

/// Part of the window that a hint points at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WindowPart {
    Image,
    Play,
    Settings,
    RampsTab,
    AddSystem,
    Find,
    Keys,
}

impl Hint {
    pub fn window_part(self) -> WindowPart {
        match self {
            Self::Play => WindowPart::Play,
            Self::Orbit | Self::Light | Self::Lamp => WindowPart::Image,
            Self::Look => WindowPart::Settings,
            Self::Ramp => WindowPart::RampsTab,
            Self::System => WindowPart::AddSystem,
            Self::Find => WindowPart::Find,
            Self::Keys => WindowPart::Keys,
        }
    }
}

/// Hints that are still to be shown.
#[derive(Clone, Debug)]
pub struct FirstRunHints {
    open: Vec<Hint>,
    parts: [Rect; 7],
    /// State of the previous frame, to detect changes.
    last: Option<Seen>,
}

/// State of a frame.
#[derive(Clone, Debug, PartialEq)]
struct Seen {
    camera: Vec3,
    systems: Vec<PresetSystem>,
    light_count: usize,
    is_playing: bool,
}

impl Default for FirstRunHints {
    fn default() -> Self {
        Self { open: Vec::new(), parts: [Rect::NOTHING; 7], last: None }
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
        let seen = || Seen {
            camera: preset.camera.position,
            systems: preset.systems.clone(),
            light_count: preset.lights.len(),
            is_playing: done.is_playing,
        };
        let last = self.last.get_or_insert_with(seen);
        let has_moved = last.camera != preset.camera.position;
        let has_set = last.systems != preset.systems;
        let has_system = last.systems.len() < preset.systems.len();
        let has_lamp = last.light_count < preset.lights.len();
        let has_played = last.is_playing != done.is_playing;
        if has_moved || has_set || has_played || last.light_count != preset.lights.len() {
            *last = seen();
        }
        self.open.retain(|hint| !match hint {
            Hint::Play => has_played,
            Hint::Orbit => has_moved && done.is_pressing,
            Hint::Light => done.is_dragging_light,
            Hint::Lamp => has_lamp,
            Hint::Look => has_set && done.is_look_visible,
            Hint::Ramp => done.is_ramp_visible,
            Hint::System => has_system,
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
    pub is_playing: bool,
    /// The sliders of the look tab are visible.
    pub is_look_visible: bool,
    /// The ramps are visible.
    pub is_ramp_visible: bool,
    pub is_searching: bool,
    pub is_key_list_open: bool,
}
