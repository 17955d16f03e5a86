//! Particle files of the systems, as last loaded without error.

use haze_author::particle_files::ParticleFrames;
use haze_preset::Preset;

/// Particles of each system with the path they were loaded from; `None` for a system without particle files.
#[derive(Clone)]
pub struct LoadedParticles(Vec<(String, Option<ParticleFrames>)>);

impl LoadedParticles {
    /// `loaded` has one entry for each system of the preset.
    pub fn new(preset: &Preset, loaded: Vec<Option<ParticleFrames>>) -> Self {
        Self(paths(preset).into_iter().zip(loaded).collect())
    }

    /// Returns the particles for each system of a preset. A system whose own files are not loaded yet, or cannot be
    /// loaded, gets those that were loaded for its index before.
    pub fn of(&self, preset: &Preset) -> Vec<Option<ParticleFrames>> {
        let find = |(index, path): (usize, String)| {
            let own = self.0.iter().find(|(known, _)| *known == path);
            own.or(self.0.get(index)).and_then(|(_, cache)| cache.clone())
        };
        paths(preset).into_iter().enumerate().map(find).collect()
    }
}

/// Returns the particle-file path of each system; empty for a system without one.
pub fn paths(preset: &Preset) -> Vec<String> {
    preset.systems.iter().map(|system| system.particle_files.path.clone()).collect()
}
