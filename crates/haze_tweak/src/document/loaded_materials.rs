//! Ramps and sprites of the systems, as last loaded without error.

use haze::MaterialAssets;
use haze_preset::{MaterialSources, Preset};

/// Images, and the names they were loaded by. Clones share the images.
#[derive(Clone)]
pub struct LoadedMaterials(Vec<(MaterialSources, MaterialAssets)>);

impl LoadedMaterials {
    /// `loaded` has the images of every system of the preset.
    pub fn new(preset: &Preset, loaded: Vec<MaterialAssets>) -> Self {
        Self(names(preset).into_iter().zip(loaded).collect())
    }

    /// Returns the images for each system of a preset. A system whose own images are not loaded yet, or cannot be
    /// loaded, gets those that were loaded for its index before.
    pub fn of(&self, preset: &Preset) -> Vec<MaterialAssets> {
        let systems = preset.systems.iter().enumerate();
        let find = |(index, system): (usize, &haze_preset::PresetSystem)| {
            let own = self.0.iter().find(|(names, _)| *names == system.material);
            own.or(self.0.get(index)).or(self.0.last()).map(|(_, assets)| assets.clone())
        };
        systems.filter_map(find).collect()
    }

    /// Replaces reloaded images that have not changed by the present ones, so that nothing is uploaded for them.
    pub fn reuse_equal(&self, loaded: Vec<MaterialAssets>) -> Vec<MaterialAssets> {
        let same = |new: &MaterialAssets| self.0.iter().map(|(_, old)| old).find(|old| *old == new).cloned();
        loaded.into_iter().map(|new| same(&new).unwrap_or(new)).collect()
    }
}

/// Returns the names of images of each system.
pub fn names(preset: &Preset) -> Vec<MaterialSources> {
    preset.systems.iter().map(|system| system.material.clone()).collect()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn a_system_keeps_its_images_at_any_index() {
        let load = |preset: &Preset| preset.load_materials(Path::new("")).unwrap();
        let mut preset = Preset::load("column").unwrap();
        let mut other = preset.systems[0].clone();
        other.material.diffuse_ramp = "diffuse_ember".into();
        preset.systems.push(other);
        let loaded_materials = LoadedMaterials::new(&preset, load(&preset));
        let [first, second] = &loaded_materials.of(&preset)[..] else { panic!("two systems") };
        assert!(!first.shares_memory(second));
        let first = first.clone();
        let second = second.clone();
        preset.systems.reverse();
        let swapped = loaded_materials.of(&preset);
        assert!(swapped[0].shares_memory(&second) && swapped[1].shares_memory(&first));
        // Not loaded yet, so the former images of this index are used.
        preset.systems[0].material.diffuse_ramp = "mine.png".into();
        assert!(loaded_materials.of(&preset)[0].shares_memory(&first));
        // A reload of the same files gives the same images.
        let again = loaded_materials.reuse_equal(load(&Preset::load("column").unwrap()));
        assert!(again[0].shares_memory(&first));
    }
}
