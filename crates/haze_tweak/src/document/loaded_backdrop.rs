//! Scene and sky of the preset, as last loaded without error.

use haze_author::backdrop::{Backdrop, backdrop_names};
use haze_core::settings::BackdropKind;
use haze_preset::Preset;

/// Scene and sky with the names that they were loaded by. Clones share them.
#[derive(Clone)]
pub struct LoadedBackdrop {
    names: [String; 2],
    backdrop: Backdrop,
}

impl LoadedBackdrop {
    pub fn new(preset: &Preset, backdrop: Backdrop) -> Self {
        Self { names: names(preset), backdrop }
    }

    /// Replaces the file of one kind.
    pub fn put(&mut self, kind: BackdropKind, name: &str, loaded: Backdrop) {
        let [scene_name, sky_name] = &mut self.names;
        match kind {
            BackdropKind::Scene => {
                *scene_name = name.into();
                self.backdrop.scene = loaded.scene;
            }
            BackdropKind::Sky => {
                *sky_name = name.into();
                self.backdrop.sky = loaded.sky;
            }
        }
    }

    /// True if it is that of a preset.
    pub fn is_of(&self, preset: &Preset) -> bool {
        self.names == names(preset)
    }

    /// Returns scene and sky for a preset. A file that is not loaded yet, or cannot be loaded, is shown as the one before; none
    /// if the preset names none.
    pub fn of(&self, preset: &Preset) -> Backdrop {
        let [scene, sky] = names(preset).map(|name| !name.is_empty());
        let Backdrop { scene: loaded_scene, sky: loaded_sky } = self.backdrop.clone();
        Backdrop { scene: loaded_scene.filter(|_| scene), sky: loaded_sky.filter(|_| sky) }
    }
}

/// Returns the names of scene and sky; empty for none.
pub fn names(preset: &Preset) -> [String; 2] {
    backdrop_names(&preset.environment).map(|(_, _, name)| name.to_owned())
}
