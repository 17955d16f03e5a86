//! Preset: camera, lights and particle systems of a shot.

use std::io;
use std::path::Path;

use haze_core::assets::json;
use haze_core::assets::material_assets::MaterialAssets;
use haze_core::emitter::{Emitter, MAX_PARTICLES};
use haze_core::error::{AssetError, FieldError, builtin_path, display_path};
use haze_core::frame::validate_input::validate_lights;
use haze_core::frame::{EmitterSnapshot, Light, LightRole};
use haze_core::settings::{FieldVisitor, Fields, Settings, current_path, validate};
use haze_core::view_setup::AttachmentSet;

use super::animation::{MAX_TIME, Track, validate_tracks};
use super::asset_folders::AssetFolders;
use super::camera::Camera;
use super::environment::Environment;
use super::image_cache::ImageCache;
use super::image_source::ImageSource;
use super::material_sources::MaterialSources;
use super::particle_source::ParticleFiles;
use crate::builtin;

/// Version of the preset format that this code reads and writes.
pub const PRESET_VERSION: u32 = 1;

/// Maximum number of systems in a preset.
pub const MAX_SYSTEMS: usize = 32;

/// Preset of a whole shot.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Preset {
    /// Format version: 1.
    pub version: u32,
    /// Name shown in lists.
    pub name: String,
    /// Description of the shot.
    #[serde(default)]
    pub description: String,
    /// Time that is shown, seconds since the start of emission.
    #[serde(default)]
    pub time: f64,
    /// Camera of the shot.
    #[serde(default)]
    pub camera: Camera,
    /// Scene around the smoke in the demo program. A host shows its own scene instead.
    #[serde(default)]
    pub environment: Environment,
    /// Lights on scene and smoke.
    #[serde(default)]
    pub lights: Vec<Light>,
    /// Particle systems: the smoke.
    #[serde(default)]
    pub systems: Vec<PresetSystem>,
    /// Settings that change over time, by keyframes and flicker: at most one track for each.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub animation: Vec<Track>,
}

/// One particle system.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct PresetSystem {
    /// Name shown in lists.
    pub name: String,
    /// Source of the particles.
    #[serde(default)]
    pub emitter: Emitter,
    /// Particle files, which replace the emitter.
    #[serde(default, alias = "cache")]
    pub particle_files: ParticleFiles,
    /// Images of the system.
    #[serde(default)]
    pub material: MaterialSources,
    /// Settings of the system: its rendering, fade and lighting.
    #[serde(default)]
    pub settings: Settings,
}

impl Default for Preset {
    /// Default camera in the default scene, without lights and systems.
    fn default() -> Self {
        Self {
            version: PRESET_VERSION,
            name: "untitled".into(),
            description: String::new(),
            time: 0.0,
            camera: Camera::default(),
            environment: Environment::default(),
            lights: Vec::new(),
            systems: Vec::new(),
            animation: Vec::new(),
        }
    }
}

impl Default for PresetSystem {
    fn default() -> Self {
        Self {
            name: "smoke".into(),
            emitter: Emitter::default(),
            particle_files: ParticleFiles::default(),
            material: MaterialSources::default(),
            settings: Settings::default(),
        }
    }
}

impl Fields for Preset {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.integer("version", &mut self.version, PRESET_VERSION..=PRESET_VERSION, "");
        visitor.text("name", &mut self.name);
        visitor.text("description", &mut self.description);
        visitor.time("time", &mut self.time, -MAX_TIME..=MAX_TIME, "s");
        visitor.group("camera", &mut self.camera);
        visitor.group("environment", &mut self.environment);
        for (index, light) in self.lights.iter_mut().enumerate() {
            visitor.item("lights", index, light);
        }
        for (index, system) in self.systems.iter_mut().enumerate() {
            visitor.item("systems", index, system);
        }
    }
}

impl Fields for PresetSystem {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.text("name", &mut self.name);
        visitor.group("emitter", &mut self.emitter);
        visitor.group("particle_files", &mut self.particle_files);
        visitor.group("material", &mut self.material);
        visitor.group("settings", &mut self.settings);
    }
}

impl Preset {
    /// Loads a preset from a file, or a built-in one by name.
    ///
    /// # Errors
    /// [`AssetError::Io`], [`AssetError::Text`] with line and column, or [`AssetError::JsonField`] with the field and its range.
    pub fn load(name_or_path: impl AsRef<Path>) -> Result<Self, AssetError> {
        Self::load_with_source(name_or_path).map(|(preset, _)| preset)
    }

    /// As [`Preset::load`], with the text that it was read from, to detect later changes of the file.
    ///
    /// # Errors
    /// As [`Preset::load`].
    pub fn load_with_source(name_or_path: impl AsRef<Path>) -> Result<(Self, String), AssetError> {
        let path = name_or_path.as_ref();
        if let Some(preset) = path.to_str().and_then(|name| builtin::find(builtin::PRESETS, name)) {
            let text = String::from_utf8_lossy(preset.bytes);
            return Ok((Self::parse(&builtin_path(preset.name), &text)?, text.into_owned()));
        }
        let looks_like_a_name = path.extension().is_none() && path.components().count() == 1;
        if looks_like_a_name && !path.exists() {
            let names: Vec<_> = builtin::PRESETS.iter().map(|preset| preset.name).collect();
            let expected = format!("one of {}, or the path of a JSON file", names.join(", "));
            return Err(FieldError::new("preset", format!("{path:?}"), expected).into());
        }
        let text = json::read(path, json::MAX_BYTES)?;
        Ok((Self::parse(path, &text)?, text))
    }

    /// Parses and validates a preset. `path` is only named in errors.
    ///
    /// # Errors
    /// As [`Preset::load`].
    pub fn parse(path: &Path, text: &str) -> Result<Self, AssetError> {
        let mut preset: Self = json::parse_versioned(path, text, PRESET_VERSION)?;
        for track in &mut preset.animation {
            track.setting = current_path(&track.setting);
        }
        preset.validate().map_err(|error| AssetError::JsonField { path: path.into(), error })?;
        Ok(preset)
    }

    /// Loads the images of every system, each file once. They are searched for beside `path`, the preset's file.
    ///
    /// # Errors
    /// As [`MaterialSources::load`], with the preset and the system.
    pub fn load_materials(&self, path: &Path) -> Result<Vec<MaterialAssets>, AssetError> {
        self.load_materials_from(path, &AssetFolders::for_preset_file(path))
    }

    /// As [`Preset::load_materials`], from other folders. `path`, the preset's file, is only named in errors.
    ///
    /// # Errors
    /// As [`Preset::load_materials`].
    pub fn load_materials_from(&self, path: &Path, folders: &AssetFolders) -> Result<Vec<MaterialAssets>, AssetError> {
        self.load_images(path, ImageSource::Folders(folders.clone()))
    }

    /// As [`Preset::load_materials`], with the files that `read` returns for their names: for packed files, asset
    /// servers and web pages. `path`, the preset's file, is only named in errors.
    ///
    /// # Errors
    /// As [`Preset::load_materials`].
    pub fn load_materials_with(
        &self,
        path: &Path,
        mut read: impl FnMut(&Path) -> io::Result<Vec<u8>>,
    ) -> Result<Vec<MaterialAssets>, AssetError> {
        self.load_images(path, ImageSource::Reader(&mut read))
    }

    fn load_images(&self, path: &Path, source: ImageSource<'_>) -> Result<Vec<MaterialAssets>, AssetError> {
        let mut images = ImageCache::new(source);
        let load = |(index, system): (usize, &PresetSystem)| {
            let loaded = system.material.load_with_cache(&mut images);
            loaded.map_err(|mut errors| with_system_context(path, index, errors.swap_remove(0).1))
        };
        self.systems.iter().enumerate().map(load).collect()
    }

    /// Checks every number, and that no more than [`MAX_PARTICLES`] live at once; also with the values of each keyframe at its
    /// time. Between keyframes and with flicker, rules for several settings together may still be broken: `evaluate(time)` can be
    /// validated too.
    ///
    /// # Errors
    /// The first field that is not valid.
    pub fn validate(&self) -> Result<(), FieldError> {
        self.validate_settings()?;
        if self.animation.is_empty() {
            return Ok(());
        }
        let still = Self { animation: Vec::new(), ..self.clone() };
        validate_tracks(&self.animation, &still, Self::validate_settings)
    }

    /// Checks everything but the animation.
    fn validate_settings(&self) -> Result<(), FieldError> {
        validate(self, String::new)?;
        if self.camera.position.distance(self.camera.target) < 1.0e-3 {
            return Err(FieldError::new("camera.target", self.camera.target, "a point other than camera.position"));
        }
        validate_lights(&self.lights)?;
        let mut keys = (0..self.lights.len()).filter(|&index| self.lights[index].role == LightRole::Key);
        if let Some(second) = keys.nth(1) {
            let problem = "a second key light";
            return Err(FieldError::from_problem(format!("lights[{second}].role"), problem, "at most one key light"));
        }
        if self.systems.len() > MAX_SYSTEMS {
            let problem = format!("{} systems are too many", self.systems.len());
            return Err(FieldError::from_problem("systems", problem, format!("at most {MAX_SYSTEMS}")));
        }
        let mut most = 0.0;
        for (index, system) in self.systems.iter().enumerate() {
            system.emitter.validate(|| format!("systems[{index}].emitter"))?;
            if !system.particle_files.is_used() {
                most += system.emitter.max_alive();
            }
            if most > f64::from(MAX_PARTICLES) {
                let field = format!("systems[{index}].emitter.rate");
                let problem = format!("at this rate, {most:.0} particles of all systems are alive at once");
                return Err(FieldError::from_problem(field, problem, format!("at most {MAX_PARTICLES}")));
            }
            let path = || format!("systems[{index}].settings");
            system.settings.validate(path)?;
            AttachmentSet::validate(&system.settings, path)?;
        }
        Ok(())
    }
}

/// Adds the preset's file and the system to an error of the system's files.
pub fn with_system_context(path: &Path, index: usize, error: AssetError) -> AssetError {
    match error {
        AssetError::Field(mut error) => {
            error.field = format!("systems[{index}].{}", error.field);
            AssetError::JsonField { path: path.into(), error }
        }
        AssetError::Named { named_by, error } => {
            AssetError::Named { named_by: format!("{}: systems[{index}].{named_by}", display_path(path)), error }
        }
        other => other,
    }
}

impl PresetSystem {
    /// Unevaluated particles of the emitter at `time`, seconds.
    pub fn emitter_snapshot(&self, time: f64) -> EmitterSnapshot {
        let frame_rate = if self.settings.debug.freeze_animation { 0.0 } else { self.emitter.frame_rate };
        Emitter { frame_rate, ..self.emitter }.snapshot(time)
    }

    /// Flipbook frames per second, of the emitter or the files.
    pub fn frame_rate(&self) -> f32 {
        if self.particle_files.is_used() { self.particle_files.flipbook_rate } else { self.emitter.frame_rate }
    }
}

#[cfg(test)]
mod tests {
    use haze_core::settings::Exponential;

    use super::*;

    #[test]
    fn every_builtin_preset_loads_with_its_assets() {
        for preset in builtin::PRESETS {
            let loaded = Preset::load(preset.name).unwrap();
            assert!(!loaded.description.is_empty() && !loaded.systems.is_empty(), "{}", preset.name);
            for system in &loaded.systems {
                system.material.load(ImageSource::BuiltIn).unwrap();
            }
        }
    }

    #[test]
    fn every_builtin_asset_decodes() {
        for ramp in builtin::RAMPS.iter().chain(builtin::MOTIFS) {
            ramp.ramp().unwrap();
        }
        for builtin in builtin::SPRITES {
            let sprite = builtin.sprite().unwrap();
            let detail = builtin.detail().unwrap().unwrap();
            assert!(sprite.frame_count() > 1);
            assert_eq!((detail.size() * 4, detail.frame_count()), (sprite.size(), sprite.frame_count()));
        }
        for noise in builtin::NOISES {
            assert_eq!(noise.noise().unwrap().size(), 32);
        }
    }

    #[test]
    fn a_file_with_names_of_before_opens() {
        let system = r#"{"name": "a", "cache": {"up": "z"}, "emitter": {"small_share": 0.3}, "settings":
            {"accumulate": {"scale": 4}, "density": {"density": 5}, "sprite": {"size": 2, "debug_loop": 3}}}"#;
        let track = |setting: &str, value: &str| {
            format!(r#"{{"setting": "systems[0].{setting}", "keys": [{{"time": 0, "value": {value}}}]}}"#)
        };
        let tracks = [
            track("settings.accumulate.scale", "8"),
            track("settings.density.density", "6"),
            track("settings.sprite.debug_sprite", "true"),
            track("cache.flipbook_rate", "7"),
            track("emitter.small_share", "0.4"),
        ];
        let tracks = tracks.join(", ");
        let text = format!(r#"{{"version": 1, "name": "old", "systems": [{system}], "animation": [{tracks}]}}"#);
        let preset = Preset::parse(Path::new("old.json"), &text).unwrap();
        let at_rest = &preset.systems[0];
        assert_eq!(at_rest.settings.accumulate.downscale, 4);
        assert_eq!(at_rest.settings.exponential, Exponential { density: 5.0 });
        assert_eq!((at_rest.settings.debug.draw_count, at_rest.settings.sprite.size), (3, 2.0));
        assert_eq!(at_rest.particle_files.up, crate::UpAxis::Z);
        assert!((at_rest.emitter.small_fraction - 0.3).abs() < 1.0e-6);
        let names: Vec<_> = preset.animation.iter().map(|track| track.setting.as_str()).collect();
        let expected = [
            "systems[0].settings.accumulate.downscale",
            "systems[0].settings.exponential.density",
            "systems[0].settings.debug.checkerboard",
            "systems[0].particle_files.flipbook_rate",
            "systems[0].emitter.small_fraction",
        ];
        assert_eq!(names, expected);
        let animated = &preset.evaluate(0.0).systems[0];
        assert_eq!(animated.settings.accumulate.downscale, 8);
        assert_eq!(animated.settings.exponential, Exponential { density: 6.0 });
        assert!(animated.settings.debug.checkerboard);
        assert_eq!(animated.particle_files, ParticleFiles { flipbook_rate: 7.0, ..at_rest.particle_files.clone() });
        // New files have new names.
        let saved = serde_json::to_string(&preset).unwrap();
        assert!(!saved.contains("\"cache\"") && !saved.contains("debug_loop"), "{saved}");
    }

    #[test]
    fn errors_name_the_file_and_the_field() {
        let parse = |text: &str| Preset::parse(Path::new("my.json"), text).unwrap_err().to_string();
        let range = parse(r#"{"version": 1, "name": "x", "camera": {"fov": 200}}"#);
        assert_eq!(range, "my.json: camera.fov: 200 is not valid; expected 1 to 150 degrees");
        let nested = parse(
            r#"{"version": 1, "name": "x", "systems": [{"name": "s", "settings": {"soft_fade": {"fade_scale": 0}}}]}"#,
        );
        assert!(nested.starts_with("my.json: systems[0].settings.soft_fade.fade_scale: 0 is not valid"), "{nested}");
        let emitter = r#"{"rate": 100000, "lifetime": 5, "lifetime_spread": 0}"#;
        let system = format!(r#"{{"name": "s", "emitter": {emitter}}}"#);
        let crowded = parse(&format!(r#"{{"version": 1, "name": "x", "systems": [{system}, {system}, {system}]}}"#));
        assert_eq!(
            crowded,
            "my.json: systems[2].emitter.rate: at this rate, 1500000 particles of all systems are alive at once; \
             expected at most 1048576"
        );
        let keys = parse(
            r#"{"version": 1, "name": "x", "lights": [{"role": "key"}, {"role": "fill"}, {"role": "key"}, {"role": "key"}]}"#,
        );
        assert_eq!(keys, "my.json: lights[2].role: a second key light; expected at most one key light");
        let unknown = Preset::load("colunm").unwrap_err().to_string();
        assert!(unknown.contains("column, backlit_fog"), "{unknown}");
    }
}
