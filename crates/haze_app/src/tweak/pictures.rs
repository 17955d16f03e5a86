//! The ramps and sprites of the systems, as they were last loaded well.

use haze::MaterialAssets;
use haze::preset::{MaterialNames, Preset};

/// Pictures, and the names that they were loaded by. A clone is the same pictures.
#[derive(Clone)]
pub struct Pictures(Vec<(MaterialNames, MaterialAssets)>);

impl Pictures {
    /// `loaded` has the pictures of every system of the preset.
    pub fn new(preset: &Preset, loaded: Vec<MaterialAssets>) -> Self {
        Self(names(preset).into_iter().zip(loaded).collect())
    }

    /// What there is for the systems of a preset: where a system's own is not loaded yet, or cannot be, what stood in its place.
    pub fn of(&self, preset: &Preset) -> Vec<MaterialAssets> {
        let systems = preset.systems.iter().enumerate();
        let find = |(index, system): (usize, &haze::preset::PresetSystem)| {
            let own = self.0.iter().find(|(names, _)| *names == system.material);
            own.or(self.0.get(index)).or(self.0.last()).map(|(_, assets)| assets.clone())
        };
        systems.filter_map(find).collect()
    }

    /// Pictures read again: those that are as they were stay the same, so that nothing is uploaded for them.
    pub fn keep_same(&self, loaded: Vec<MaterialAssets>) -> Vec<MaterialAssets> {
        let same = |new: &MaterialAssets| self.0.iter().map(|(_, old)| old).find(|old| *old == new).cloned();
        loaded.into_iter().map(|new| same(&new).unwrap_or(new)).collect()
    }
}

/// The pictures that the systems of a preset name.
pub fn names(preset: &Preset) -> Vec<MaterialNames> {
    preset.systems.iter().map(|system| system.material.clone()).collect()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn a_system_keeps_its_pictures_wherever_it_stands() {
        let load = |preset: &Preset| preset.load_materials(Path::new("")).unwrap();
        let mut preset = Preset::load("column").unwrap();
        let mut other = preset.systems[0].clone();
        other.material.diffuse_ramp = "diffuse_ember".into();
        preset.systems.push(other);
        let pictures = Pictures::new(&preset, load(&preset));
        let [first, second] = &pictures.of(&preset)[..] else { panic!("two systems") };
        assert!(!first.shares(second));
        let (first, second) = (first.clone(), second.clone());
        preset.systems.reverse();
        let swapped = pictures.of(&preset);
        assert!(swapped[0].shares(&second) && swapped[1].shares(&first));
        // Not loaded yet: what stood there.
        preset.systems[0].material.diffuse_ramp = "mine.png".into();
        assert!(pictures.of(&preset)[0].shares(&first));
        // Read again, nothing of it is new.
        let again = pictures.keep_same(load(&Preset::load("column").unwrap()));
        assert!(again[0].shares(&first));
    }
}
