//! The particle files of the systems, as they were last loaded well.

use haze::preset::Preset;
use haze_author::particle_files::Cache;

/// Particles, and the paths that they were loaded by; none of a system without files.
#[derive(Clone)]
pub struct Caches(Vec<(String, Option<Cache>)>);

impl Caches {
    /// `loaded` has one of every system of the preset.
    pub fn new(preset: &Preset, loaded: Vec<Option<Cache>>) -> Self {
        Self(paths(preset).into_iter().zip(loaded).collect())
    }

    /// What there is for the systems of a preset: where a system's own is not loaded yet, or cannot be, what stood in its place.
    pub fn of(&self, preset: &Preset) -> Vec<Option<Cache>> {
        let find = |(index, path): (usize, String)| {
            let own = self.0.iter().find(|(known, _)| *known == path);
            own.or(self.0.get(index)).and_then(|(_, cache)| cache.clone())
        };
        paths(preset).into_iter().enumerate().map(find).collect()
    }
}

/// The particle files that the systems of a preset name.
pub fn paths(preset: &Preset) -> Vec<String> {
    preset.systems.iter().map(|system| system.cache.path.clone()).collect()
}
