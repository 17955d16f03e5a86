//! Loads the particle files of one preset: each is read once, and their total size is limited.

use std::collections::HashMap;
use std::ffi::OsStr;
use std::path::Path;

use haze_core::emitter::MAX_PARTICLES;
use haze_core::error::{AssetError, FieldError, one_line};
use haze_core::frame::{EmitterPaths, EmitterSnapshot, Particle};
use haze_preset::{AssetFolders, ParticleFiles, Preset, PresetSystem, particle_file_path, with_system_context};

use super::particle_frames::{Limits, ParticleFrames};

/// Maximum memory of the particle files of a preset, bytes.
pub const MAX_PARTICLE_FILE_BYTES: u64 = 1 << 30;

/// Loads the particle files of every system that names some, each once. The result has one entry for each system,
/// `None` if an emitter makes its particles. The files are searched for like images; `path`, the preset's file, is only
/// named in errors.
///
/// # Errors
/// As [`ParticleFrames::load`], wrapped in [`AssetError::Named`] with the preset and the system, also for more than
/// [`MAX_PARTICLE_FILE_BYTES`]; [`AssetError::JsonField`] for an invalid path, and for more than [`MAX_PARTICLES`] in all
/// systems.
pub fn load_particle_files(
    preset: &Preset,
    path: &Path,
    folders: &AssetFolders,
) -> Result<Vec<Option<ParticleFrames>>, AssetError> {
    load_each(preset, path, folders).into_iter().collect()
}

/// Loads the particle files of every system. Returns all errors; and notes on the columns: the attributes that they are
/// read as, those that are not read, and those that the settings of their system do not use.
pub fn check_particle_files(preset: &Preset, path: &Path, folders: &AssetFolders) -> (Vec<AssetError>, Vec<String>) {
    let mut errors = Vec::new();
    let mut notes = Vec::new();
    for (index, loaded) in load_each(preset, path, folders).into_iter().enumerate() {
        match loaded {
            Ok(Some(frames)) => notes.extend(column_notes(preset, index, &frames).into_iter().map(|note| note.text)),
            Ok(None) => {}
            Err(error) => errors.push(error),
        }
    }
    (errors, notes)
}

/// Notes on columns of the particle files of a system that are not read, or that its settings do not use.
pub fn unused_columns(preset: &Preset, index: usize, frames: &ParticleFrames) -> Vec<String> {
    let unused = column_notes(preset, index, frames).into_iter().filter(|note| note.is_unused);
    unused.map(|note| note.text).collect()
}

/// Note on columns of a particle file.
struct ColumnNote {
    text: String,
    /// False for the attributes that columns are read as.
    is_unused: bool,
}

fn column_notes(preset: &Preset, index: usize, frames: &ParticleFrames) -> Vec<ColumnNote> {
    let Some(system) = preset.systems.get(index).filter(|system| system.particle_files.is_used()) else {
        return Vec::new();
    };
    let settings = &system.settings;
    let is_animated = |setting: &str| {
        let path = format!("systems[{index}].settings.{setting}");
        preset.animation.iter().any(|track| track.setting == path)
    };
    let is_tinted = settings.sprite.tint > 0.0 || is_animated("sprite.tint");
    let burns = settings.burns() || is_animated("fire.intensity");
    let mut notes = Vec::new();
    for (file, columns) in frames.columns() {
        let name = file.file_name().map(OsStr::to_string_lossy).unwrap_or_default();
        let mut add = |note: &str, is_unused| {
            let text = format!("systems[{index}].particle_files.path: {}: {note}", one_line(&name));
            notes.push(ColumnNote { text, is_unused });
        };
        add(&columns.read, false);
        columns.unread.iter().for_each(|note| add(note, true));
        if !columns.color.is_empty() && !is_tinted {
            add(&format!("{}: no effect; expected a sprite.tint above 0", columns.color), true);
        }
        if !columns.heat.is_empty() && !burns {
            add(&format!("{}: no effect; expected a fire.intensity above 0", columns.heat), true);
        }
    }
    notes
}

/// Loads the particle files of every system, each file once.
fn load_each(preset: &Preset, path: &Path, folders: &AssetFolders) -> Vec<Result<Option<ParticleFrames>, AssetError>> {
    let mut known = HashMap::new();
    let mut bytes = 0;
    let mut particles = 0.0;
    let mut loaded = Vec::new();
    for (index, system) in preset.systems.iter().enumerate() {
        if !system.particle_files.is_used() {
            particles += system.emitter.max_alive();
            loaded.push(Ok(None));
            continue;
        }
        let name = &system.particle_files.path;
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
            Err(FieldError::from_problem("particle_files.path", problem, format!("at most {MAX_PARTICLES}")).into())
        });
        loaded.push(counted.map(Some).map_err(|error| with_system_context(path, index, error)));
    }
    loaded
}

/// Replaces `particles` with those alive at `time`, seconds: those of `files` if the system names some and they are
/// given; else those of its emitter.
pub fn particles(system: &PresetSystem, files: Option<&ParticleFrames>, time: f64, particles: &mut Vec<Particle>) {
    particles_along(system, files, time, &mut EmitterPaths::default(), particles);
}

/// [`particles`] for frame after frame: those of the emitter are evaluated along `paths`.
pub fn particles_along(
    system: &PresetSystem,
    files: Option<&ParticleFrames>,
    time: f64,
    paths: &mut EmitterPaths,
    particles: &mut Vec<Particle>,
) {
    match files.filter(|_| system.particle_files.is_used()) {
        Some(files) => {
            let is_frozen = system.settings.debug.freeze_animation;
            let flipbook_rate = if is_frozen { 0.0 } else { system.particle_files.flipbook_rate };
            files.evaluate(&ParticleFiles { flipbook_rate, ..system.particle_files.clone() }, time, particles);
        }
        None => system.emitter_snapshot(time).evaluate_along(paths, particles),
    }
}

/// Unevaluated particles of the emitter; `None` if they come from `files`.
pub fn emission(system: &PresetSystem, files: Option<&ParticleFrames>, time: f64) -> Option<EmitterSnapshot> {
    (!system.particle_files.is_used() || files.is_none()).then(|| system.emitter_snapshot(time))
}

fn load(name: &str, folders: &AssetFolders, bytes: u64) -> Result<ParticleFrames, AssetError> {
    let Some(file) = particle_file_path(name) else {
        let expected = "a CSV or PLY file inside the preset's folder; one run of # in its name for a frame's digits";
        return Err(FieldError::new("particle_files.path", format!("{name:?}"), expected).into());
    };
    let limits = Limits { particles: MAX_PARTICLES as usize, bytes };
    let frames = folders.find(file).and_then(|file| ParticleFrames::load(&file, limits));
    frames.map_err(|error| AssetError::Named { named_by: "particle_files.path".into(), error: Box::new(error) })
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
                system.particle_files.path = (*path).into();
                preset.systems.push(system);
            }
            preset
        };
        let folders = AssetFolders::new(folder.path());
        let check = |paths: &[&str]| check_particle_files(&preset(paths), Path::new("my.json"), &folders);
        let same = preset(&["good.csv", "", "good.csv"]);
        let loaded = load_particle_files(&same, Path::new("my.json"), &folders).unwrap();
        let [Some(first), None, Some(second)] = &loaded[..] else { panic!("two files") };
        assert!(first.shares_memory(second));
        let said: Vec<_> = check(&["", "smok_##.csv", "good.csv", "smoke_##.csv", "../good.csv"])
            .0
            .iter()
            .map(ToString::to_string)
            .collect();
        let [missing, broken, outside] = &said[..] else { panic!("{said:?}") };
        assert!(
            missing.starts_with("my.json: systems[1].particle_files.path: ") && missing.contains("No such file in "),
            "{missing}"
        );
        assert!(missing.ends_with("; the nearest name is \"smoke_01.csv\""), "{missing}");
        assert!(broken.starts_with("my.json: systems[3].particle_files.path: "), "{broken}");
        assert!(broken.ends_with("smoke_02.csv:2:5: z: \"-\" is not valid; expected a number"), "{broken}");
        assert!(
            outside.starts_with("my.json: systems[4].particle_files.path: \"../good.csv\" is not valid; "),
            "{outside}"
        );
        // Particles that an emitter may make count too, except for systems that use files.
        let mut crowded = preset(&["", "good.csv"]);
        for system in &mut crowded.systems {
            system.emitter.rate = 10_000.0;
            system.emitter.lifetime = 104.8576;
            system.emitter.lifetime_spread = 0.0;
        }
        crowded.validate().unwrap();
        let said = load_particle_files(&crowded, Path::new("my.json"), &folders).unwrap_err().to_string();
        assert!(
            said.ends_with("1048577 particles of all systems are alive at once; expected at most 1048576"),
            "{said}"
        );
    }

    #[test]
    fn notes_say_what_every_column_is_read_as_and_what_has_no_effect() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        write("s_1.csv", "x,y,z,nx,amount,opacity,red,green,blue,alpha,temperature,\n1,2,3,0,2,1,9,0,0,255,1500,");
        write("s_2.csv", "x,y,z,nx,amount,opacity,red,green,blue,alpha,temperature,\n1,2,3,0,1,1,0,0,0,255,300,");
        write("s_3.csv", "x,y,z,r\n1,2,3,1");
        let rgb = "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n";
        let position = "property float x\nproperty float y\nproperty float z\nproperty list uchar int near\n";
        let head = format!("ply\nformat ascii 1.0\nelement vertex 1\n{position}{rgb}end_header\n");
        write("a.ply", &format!("{head}0 0 0 0 9 9 9 255"));
        let mut preset = Preset { systems: vec![PresetSystem::default(); 2], ..Preset::default() };
        preset.systems[0].particle_files.path = "s_#.csv".into();
        preset.systems[1].particle_files.path = "a.ply".into();
        let check =
            |preset: &Preset| check_particle_files(preset, Path::new("my.json"), &AssetFolders::new(folder.path()));
        let (errors, notes) = check(&preset);
        assert!(errors.is_empty(), "{errors:?}");
        let first = "systems[0].particle_files.path: s_1.csv: ";
        let second = "systems[1].particle_files.path: a.ply: ";
        let codes = "color from red, green, blue as sRGB codes";
        let kelvin = "heat from temperature in kelvin: 800 is 0, 2000 is 1";
        assert_eq!(
            notes,
            [
                format!(
                    "{first}position from x, y, z; {codes} of 0 to 255; amount from amount, 0 to 2, clamped to 0 to 1; {kelvin}"
                ),
                format!("{first}alpha is not read: the amount is read from amount"),
                format!("{first}opacity is not read: the amount is read from amount"),
                format!("{first}nx, column 12: not read; expected names that docs/particles.md lists"),
                format!("{first}red, green, blue: no effect; expected a sprite.tint above 0"),
                format!("{first}temperature: no effect; expected a fire.intensity above 0"),
                "systems[0].particle_files.path: s_3.csv: position from x, y, z; radius from r".into(),
                format!("{second}position from x, y, z; {codes}"),
                format!(
                    "{second}alpha is not read: it is full in every particle, as programs write it beside colors; \
                 expected an alpha that varies, or a column named amount"
                ),
                format!("{second}near: not read; expected names that docs/particles.md lists"),
                format!("{second}red, green, blue: no effect; expected a sprite.tint above 0"),
            ]
        );
        let loaded = load_particle_files(&preset, Path::new("my.json"), &AssetFolders::new(folder.path())).unwrap();
        let unused: Vec<_> = (0..)
            .zip(&loaded)
            .flat_map(|(index, frames)| unused_columns(&preset, index, frames.as_ref().unwrap()))
            .collect();
        assert_eq!(unused, [&notes[1..6], &notes[8..]].concat());
        preset.systems[0].settings.sprite.tint = 1.0;
        preset.systems[0].settings.fire.intensity = 1.0;
        let notes = check(&preset).1;
        assert!(notes.iter().all(|note| !note.starts_with(first) || !note.contains("no effect")), "{notes:?}");
    }
}
