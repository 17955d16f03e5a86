//! What is pointed at after the first start, one thing after the other, until it is done or dismissed.

use eframe::egui::Rect;
use glam::Vec3;
use haze::preset::{Preset, PresetSystem};

/// Something worth knowing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hint {
    Orbit,
    Light,
    Look,
    Find,
    Keys,
}

/// All of them in their order, as they are remembered, and what they say; after the key where one does it.
pub const HINTS: [(Hint, &str, &str); 5] = [
    (Hint::Orbit, "orbit", "Drag in the picture, or use the middle button or Alt, to go round the smoke."),
    (Hint::Light, "light", "Lights stand in the picture. Click on one, and drag it."),
    (Hint::Look, "look", "These sliders make a look. The tabs above have all the rest."),
    (Hint::Find, "find", "finds any setting, by its name or by what it does."),
    (Hint::Keys, "keys", "lists all keys and gestures."),
];

/// What hints point at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    Picture,
    Settings,
    Find,
    Keys,
}

impl Hint {
    pub fn place(self) -> Place {
        match self {
            Self::Orbit | Self::Light => Place::Picture,
            Self::Look => Place::Settings,
            Self::Find => Place::Find,
            Self::Keys => Place::Keys,
        }
    }
}

/// The hints that are still to be shown.
#[derive(Clone, Debug)]
pub struct Hints {
    open: Vec<Hint>,
    places: [Rect; 4],
    /// The camera's place and the smoke, as they were last seen.
    last: Option<(Vec3, Vec<PresetSystem>)>,
}

impl Default for Hints {
    fn default() -> Self {
        Self { open: Vec::new(), places: [Rect::NOTHING; 4], last: None }
    }
}

impl Hints {
    /// Shows all of them, from the first on.
    pub fn begin(&mut self) {
        self.open = HINTS.map(|(hint, ..)| hint).into();
        self.last = None;
    }

    /// Shows those that were left.
    pub fn go_on(&mut self, names: &[String]) {
        let left = HINTS.into_iter().filter(|(_, name, _)| names.iter().any(|left| left == name));
        self.open = left.map(|(hint, ..)| hint).collect();
    }

    /// The names of those that are left.
    pub fn left(&self) -> Vec<String> {
        let left = HINTS.into_iter().filter(|(hint, ..)| self.open.contains(hint));
        left.map(|(_, name, _)| name.to_owned()).collect()
    }

    /// The one that is shown, and where to.
    pub fn shown(&self) -> Option<(Hint, Rect)> {
        self.open.first().map(|hint| (*hint, self.places[hint.place() as usize]))
    }

    /// Takes note of where something is.
    pub fn see(&mut self, place: Place, rect: Rect) {
        self.places[place as usize] = rect;
    }

    /// Goes on to the next; false where none was shown.
    pub fn dismiss(&mut self) -> bool {
        let is_shown = !self.open.is_empty();
        self.open.drain(..usize::from(is_shown));
        is_shown
    }

    pub fn dismiss_all(&mut self) {
        self.open.clear();
    }

    /// Takes those away whose thing was just done.
    pub fn follow(&mut self, preset: &Preset, done: &Doing) {
        if self.open.is_empty() {
            return;
        }
        let (camera, systems) = (preset.camera.position, &preset.systems);
        let last = self.last.get_or_insert_with(|| (camera, systems.clone()));
        let (has_moved, has_set) = (last.0 != camera, last.1 != *systems);
        last.0 = camera;
        if has_set {
            last.1.clone_from(systems);
        }
        self.open.retain(|hint| !match hint {
            Hint::Orbit => has_moved && done.presses,
            Hint::Light => done.drags_light,
            Hint::Look => has_set && done.sees_look,
            Hint::Find => done.finds,
            Hint::Keys => done.sees_keys,
        });
    }
}

/// What is being done in a frame.
#[allow(clippy::struct_excessive_bools, reason = "each is one thing that is done or not")]
pub struct Doing {
    /// With a button of the pointer, or the wheel.
    pub presses: bool,
    pub drags_light: bool,
    /// The sliders that make a look are shown.
    pub sees_look: bool,
    pub finds: bool,
    pub sees_keys: bool,
}
