//! Loads the particle files of one preset: each is read once, and their total size is limited.

use std::collections::HashMap;
use std::path::Path;

use haze_core::emitter::MAX_PARTICLES;
use haze_core::error::{Error, FieldError, one_line};
use haze_core::frame::{EmitterSnapshot, Particle};
use haze_preset::{AssetFolders, ParticleFiles, Preset, PresetSystem, particle_file_path, with_system_context};

use super::particle_frames::{Limits, ParticleFrames};

/// Maximum memory of the particle files of a preset, bytes.
pub const MAX_PARTICLE_FILE_BYTES: u64 = 1 << 30;

/// Loads the particle files of every system that names some, each once. The result has one entry for each system,
/// `None` if an emitter makes its particles. The files are searched for like images; `path`, the preset's file, is only
/// named in errors.
///
/// # Errors
/// As [`ParticleFrames::load`], wrapped in [`Error::Asset`] with the preset and the system, also for more than
/// [`MAX_PARTICLE_FILE_BYTES`]; [`Error::JsonField`] for an invalid path, and for more than [`MAX_PARTICLES`] in all
/// systems.
pub fn load_particle_files(
    preset: &Preset,
    path: &Path,
    folders: &AssetFolders,
) -> Result<Vec<Option<ParticleFrames>>, Error> {
    check_particle_files(preset, path, folders).map_err(|mut errors| errors.swap_remove(0))
}

/// As [`load_particle_files`], but returns all errors.
///
/// # Errors
/// Errors of every system: at least one.
pub fn check_particle_files(
    preset: &Preset,
    path: &Path,
    folders: &AssetFolders,
) -> Result<Vec<Option<ParticleFrames>>, Vec<Error>> {
    let mut known = HashMap::new();
    let (mut bytes, mut particles) = (0, 0.0);
    let (mut loaded, mut errors) = (Vec::new(), Vec::new());
    for (index, system) in preset.systems.iter().enumerate() {
        if !system.cache.is_used() {
            particles += system.emitter.max_alive();
            loaded.push(None);
            continue;
        }
        let name = &system.cache.path;
        let frames = match known.get(name) {
            Some(frames) => Ok(ParticleFrames::clone(frames)),
            None => load(name, folders, MAX_PARTICLE_FILE_BYTES - bytes).inspect(|frames| {
                bytes += frames.bytes();
                known.insert(name, frames.clone());
            }),
        };
        let counted = frames.and_then(|frames| {
            particles += frames.max_particles() as f64;
            if particles <= f64::from(MAX_PARTICLES) {
                return Ok(frames);
            }
            let name = one_line(name);
            let problem = format!("with {name:?}, {particles:.0} particles of all systems are alive at once");
            Err(FieldError::from_problem("cache.path", problem, format!("at most {MAX_PARTICLES}")).into())
        });
        match counted {
            Ok(frames) => loaded.push(Some(frames)),
            Err(error) => errors.push(with_system_context(path, index, error)),
        }
    }
    if errors.is_empty() { Ok(loaded) } else { Err(errors) }
}

/// Replaces `particles` with those alive at `time`, seconds: those of `files` if the system names some and they are
/// given; else those of its emitter.
pub fn particles(system: &PresetSystem, files: Option<&ParticleFrames>, time: f32, particles: &mut Vec<Particle>) {
    match files.filter(|_| system.cache.is_used()) {
        Some(files) => {
            let is_frozen = system.settings.sprite.freeze_animation;
            let flipbook_rate = if is_frozen { 0.0 } else { system.cache.flipbook_rate };
            files.evaluate(&ParticleFiles { flipbook_rate, ..system.cache.clone() }, time, particles);
        }
        None => system.emitter_snapshot(time).evaluate(particles),
    }
}

/// Unevaluated particles of the emitter; `None` if they come from `files`.
pub fn emission(system: &PresetSystem, files: Option<&ParticleFrames>, time: f32) -> Option<EmitterSnapshot> {
    (!system.cache.is_used() || files.is_none()).then(|| system.emitter_snapshot(time))
}

fn load(name: &str, folders: &AssetFolders, bytes: u64) -> Result<ParticleFrames, Error> {
    let Some(file) = particle_file_path(name) else {
        let expected = "a CSV or PLY file inside the preset's folder; one run of # in its name for a frame's digits";
        return Err(FieldError::new("cache.path", format!("{name:?}"), expected).into());
    };
    let limits = Limits { particles: MAX_PARTICLES as usize, bytes };
    let frames = folders.find(file).and_then(|file| ParticleFrames::load(&file, limits));
    frames.map_err(|error| Error::Asset { named_by: "cache.path".into(), error: Box::new(error) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_of_every_systems_files_are_reported() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        write("good.csv", "x,y,z\n1,2,3\n");
        write("smoke_01.csv", "x,y,z\n1,2,3\n");
        write("smoke_02.csv", "x,y,z\n1,2,-\n");
        let preset = |paths: &[&str]| {
            let mut preset = Preset::default();
            for path in paths {
                let mut system = PresetSystem::default();
                system.cache.path = (*path).into();
                preset.systems.push(system);
            }
            preset
        };
        let folders = AssetFolders::new(folder.path());
        let check = |paths: &[&str]| check_particle_files(&preset(paths), Path::new("my.json"), &folders);
        let loaded = check(&["good.csv", "", "good.csv"]).unwrap();
        let [Some(first), None, Some(second)] = &loaded[..] else { panic!("two files") };
        assert!(first.shares_memory(second));
        let said: Vec<_> = check(&["", "smok_##.csv", "good.csv", "smoke_##.csv", "../good.csv"])
            .unwrap_err()
            .iter()
            .map(ToString::to_string)
            .collect();
        let [missing, broken, outside] = &said[..] else { panic!("{said:?}") };
        assert!(
            missing.starts_with("my.json: systems[1].cache.path: ") && missing.contains("No such file in "),
            "{missing}"
        );
        assert!(missing.ends_with("; the nearest name is \"smoke_01.csv\""), "{missing}");
        assert!(broken.starts_with("my.json: systems[3].cache.path: "), "{broken}");
        assert!(broken.ends_with("smoke_02.csv:2:5: z: \"-\" is not valid; expected a number"), "{broken}");
        assert!(outside.starts_with("my.json: systems[4].cache.path: \"../good.csv\" is not valid; "), "{outside}");
        // Particles that an emitter may make count too, except for systems that use files.
        let mut crowded = preset(&["", "good.csv"]);
        for system in &mut crowded.systems {
            (system.emitter.rate, system.emitter.lifetime, system.emitter.lifetime_spread) = (10_000.0, 104.8576, 0.0);
        }
        crowded.validate().unwrap();
        let said = load_particle_files(&crowded, Path::new("my.json"), &folders).unwrap_err().to_string();
        assert!(
            said.ends_with("1048577 particles of all systems are alive at once; expected at most 1048576"),
            "{said}"
        );
    }
}
