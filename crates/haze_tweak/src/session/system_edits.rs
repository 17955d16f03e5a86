//! Edits of the list of systems, and the systems that are shown. Tracks of their settings follow, and each edit is one step to undo.

use haze::FieldError;
use haze_preset::layers::Layer;
use haze_preset::{Preset, system_list};

use super::Session;

impl Session {
    /// Returns the preset as it is shown: without the particles of systems that are muted.
    pub(super) fn shown_preset(&self) -> Preset {
        let mut preset = self.preset_now();
        self.view.systems.apply(&mut preset, self.view.systems.has_solo(&self.document.preset.systems));
        preset
    }

    /// Adds a layer at the source of the selected system, or else at the origin, and selects it.
    pub fn add_layer(&mut self, layer: &Layer) {
        let systems = &self.document.preset.systems;
        let selected = systems.get(self.view.system).filter(|system| !system.particle_files.is_used());
        let source = selected.map(|system| system.emitter);
        self.extend_systems(systems.len(), |preset| match source {
            Some(source) => layer.add_at_source(preset, &source),
            None => layer.add_at(preset, glam::Vec3::ZERO),
        });
    }

    /// Copies a system with its keyframes, and selects the copy.
    pub fn duplicate_system(&mut self, index: usize) {
        self.extend_systems(index + 1, |preset| system_list::duplicate(preset, index));
    }

    /// Removes a system and its keyframes.
    pub fn remove_system(&mut self, index: usize) {
        system_list::remove(&mut self.document.preset, index);
        self.simulation.renumber(|system| (system != index).then(|| system - usize::from(system > index)));
        self.looks.close();
    }

    pub fn move_system(&mut self, from: usize, to: usize) {
        system_list::move_to(&mut self.document.preset, from, to);
        self.simulation.renumber(|system| {
            Some(if system == from {
                to
            } else if (from..=to).contains(&system) {
                system - 1
            } else if (to..from).contains(&system) {
                system + 1
            } else {
                system
            })
        });
        self.view.systems.reveals_selected = true;
        self.looks.close();
    }

    /// Gives a system another name, unless it is empty.
    pub fn rename_system(&mut self, index: usize, name: &str) {
        if let Some(system) = self.document.preset.systems.get_mut(index).filter(|_| !name.trim().is_empty()) {
            system.name = name.trim().into();
        }
    }

    /// Adds a system, which then has an index, and selects it. An error is shown, and changes nothing.
    fn extend_systems(&mut self, index: usize, add: impl FnOnce(&mut Preset) -> Result<(), FieldError>) {
        match add(&mut self.document.preset) {
            Ok(()) => {
                self.messages.clear("systems");
                self.simulation.renumber(|system| Some(system + usize::from(system >= index)));
                self.follow_systems();
                self.view.system = index;
                self.view.systems.reveals_selected = true;
                self.looks.close();
            }
            Err(error) => self.messages.error("systems", format!("Cannot add a system: {error}")),
        }
    }

    /// Keeps the selection on its system after changes of the list.
    pub fn follow_systems(&mut self) {
        self.view.system = self.view.systems.follow(&self.document.preset.systems, self.view.system);
    }
}
