//! View state of systems: mute, solo, a name that is being typed. It is not part of the preset.

use std::collections::HashMap;

use eframe::egui::TextureId;
use haze_preset::{ParticleFiles, Preset, PresetSystem};

use super::light_view::MuteSolo;

/// Name of a system, and the number of systems of that name before it.
type SystemKey = (String, usize);

/// View state of a preset's systems, by their names.
#[derive(Clone, Debug, Default)]
pub struct SystemView {
    flags: HashMap<SystemKey, MuteSolo>,
    /// Systems as last seen, to recognise them when their list or a name changes.
    seen: Vec<SystemKey>,
    /// System whose name is being typed, and the text.
    pub renaming: Option<(usize, String)>,
    /// The selected system is brought into view in the next frame.
    pub reveals_selected: bool,
    /// Image of each system alone, once it is rendered.
    pub images: Vec<Option<TextureId>>,
}

impl SystemView {
    /// Follows changes of the list of systems, by undo or by another preset. Returns the new index of the selected system.
    pub fn follow(&mut self, systems: &[PresetSystem], selected: usize) -> usize {
        let now: Vec<_> = (0..systems.len()).map(|index| key(systems, index)).collect();
        let most = systems.len().saturating_sub(1);
        if now == self.seen {
            return selected.min(most);
        }
        let seen = std::mem::replace(&mut self.seen, now);
        let now = &self.seen;
        let differing: Vec<_> = (0..now.len()).filter(|index| seen.get(*index) != now.get(*index)).collect();
        if let ([renamed], true) = (differing.as_slice(), seen.len() == now.len()) {
            if let Some(flags) = self.flags.remove(&seen[*renamed]) {
                self.flags.insert(now[*renamed].clone(), flags);
            }
            return selected.min(most);
        }
        self.renaming = None;
        // Systems that another preset has in their places are other systems.
        let is_same_list = seen.len() != now.len() || seen.iter().all(|key| now.contains(key));
        let position = seen.get(selected).and_then(|key| now.iter().position(|other| other == key));
        position.filter(|_| is_same_list).unwrap_or(selected).min(most)
    }

    /// Returns the flags of a system, for changing them.
    pub fn mute_solo(&mut self, systems: &[PresetSystem], index: usize) -> &mut MuteSolo {
        self.flags.entry(key(systems, index)).or_default()
    }

    /// Returns true if only solo systems are in the image.
    pub fn has_solo(&self, systems: &[PresetSystem]) -> bool {
        (0..systems.len()).any(|index| self.flags_of(systems, index).is_solo)
    }

    /// Returns true if a system is in the image.
    pub fn is_shown(&self, systems: &[PresetSystem], index: usize) -> bool {
        self.is_shown_if(systems, index, self.has_solo(systems))
    }

    /// Takes the particles of systems that are not in the image out of a preset. The systems stay, so that their indices do.
    /// `has_solo` is that of the first image.
    pub fn apply(&self, preset: &mut Preset, has_solo: bool) {
        let shown: Vec<_> =
            (0..preset.systems.len()).map(|index| self.is_shown_if(&preset.systems, index, has_solo)).collect();
        for (system, _) in preset.systems.iter_mut().zip(shown).filter(|(_, is_shown)| !is_shown) {
            system.emitter.rate = 0.0;
            system.particle_files = ParticleFiles::default();
        }
    }

    fn is_shown_if(&self, systems: &[PresetSystem], index: usize, has_solo: bool) -> bool {
        let flags = self.flags_of(systems, index);
        if has_solo { flags.is_solo } else { !flags.is_muted }
    }

    /// Returns the flags of a system.
    pub fn flags_of(&self, systems: &[PresetSystem], index: usize) -> MuteSolo {
        // Without a copy of the name, because most presets have no flags.
        if self.flags.is_empty() {
            MuteSolo::default()
        } else {
            self.flags.get(&key(systems, index)).copied().unwrap_or_default()
        }
    }
}

fn key(systems: &[PresetSystem], index: usize) -> SystemKey {
    let name = systems.get(index).map_or("", |system| &system.name);
    (name.to_owned(), systems.iter().take(index).filter(|system| system.name == name).count())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn preset(names: &[&str]) -> Preset {
        let system = |name: &&str| PresetSystem { name: (*name).into(), ..PresetSystem::default() };
        Preset { systems: names.iter().map(system).collect(), ..Preset::default() }
    }

    fn shown(view: &SystemView, names: &[&str]) -> Vec<usize> {
        let mut preset = preset(names);
        let has_solo = view.has_solo(&preset.systems);
        view.apply(&mut preset, has_solo);
        (0..names.len()).filter(|index| preset.systems[*index].emitter.rate > 0.0).collect()
    }

    #[test]
    fn mute_and_solo_stay_with_their_systems() {
        let all = preset(&["smoke", "fire", "smoke"]).systems;
        let mut view = SystemView::default();
        assert_eq!(view.follow(&all, 2), 2);
        view.mute_solo(&all, 2).is_muted = true;
        assert_eq!(shown(&view, &["smoke", "fire", "smoke"]), [0, 1], "the first of the name is shown");
        assert_eq!(shown(&view, &["fire", "smoke", "smoke"]), [0, 1]);
        assert_eq!(shown(&view, &["fire", "smoke"]), [0, 1]);
        view.mute_solo(&all, 1).is_solo = true;
        assert_eq!(shown(&view, &["smoke", "smoke", "fire"]), [2]);
        assert!(!view.is_shown(&all, 0) && view.is_shown(&all, 1));
        // In a preset without the solo system, nothing is shown beside it.
        let mut other = preset(&["smoke"]);
        view.apply(&mut other, view.has_solo(&all));
        assert!(other.systems[0].emitter.rate <= 0.0);
    }

    #[test]
    fn a_name_that_is_typed_and_undone_keeps_the_flags_and_the_selection() {
        let mut view = SystemView::default();
        let follow = |view: &mut SystemView, names: &[&str], selected| view.follow(&preset(names).systems, selected);
        follow(&mut view, &["smoke", "fire"], 1);
        view.mute_solo(&preset(&["smoke", "fire"]).systems, 1).is_muted = true;
        for name in ["flame", "fire"] {
            assert_eq!(follow(&mut view, &["smoke", name], 1), 1);
            assert_eq!(shown(&view, &["smoke", name]), [0]);
        }
        // Moved, removed, and back.
        assert_eq!(follow(&mut view, &["fire", "smoke"], 1), 0);
        assert_eq!(follow(&mut view, &["smoke"], 0), 0);
        assert_eq!(follow(&mut view, &["fire", "smoke"], 0), 1);
        assert_eq!(shown(&view, &["fire", "smoke"]), [1], "as it was");
        // Another preset.
        assert_eq!(follow(&mut view, &["smoke", "sparks", "dust"], 5), 2);
        assert_eq!(follow(&mut view, &[], 2), 0);
    }
}
