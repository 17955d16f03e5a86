//! Presets: a camera, lights and particle systems in a JSON file.

mod material;
#[cfg(feature = "app")]
mod schema;

use std::path::Path;

use glam::camera::rh;
use glam::{UVec2, Vec3};

pub use material::MaterialNames;
#[cfg(feature = "app")]
pub use schema::schema;

use crate::builtin;
use crate::emitter::Emitter;
use crate::error::{Error, FieldError};
use crate::fields::{FieldVisitor, Fields, validate};
use crate::frame::validate_lights;
use crate::json;
use crate::light::Light;
use crate::particle::Particle;
use crate::settings::Settings;
use crate::view::View;

/// The version of the preset format that this code writes and reads.
pub const PRESET_VERSION: u32 = 1;

/// Height of the picture that pixel sizes in presets are meant for. A renderer of another height scales them, so that a
/// preset looks the same at every size.
pub const DESIGN_HEIGHT: f32 = 720.0;

/// Most systems of one preset.
pub const MAX_SYSTEMS: usize = 32;

/// A whole shot.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "app", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Preset {
    /// Format version: 1.
    pub version: u32,
    /// What a list shows.
    pub name: String,
    /// What there is to see.
    #[serde(default)]
    pub description: String,
    /// Seconds into the emission that is shown.
    #[serde(default)]
    pub time: f32,
    /// Where it is seen from.
    #[serde(default)]
    pub camera: Camera,
    /// What stands round the smoke in the demo program. A host shows its own scene instead.
    #[serde(default)]
    pub environment: Environment,
    /// Lights on scene and smoke.
    #[serde(default)]
    pub lights: Vec<Light>,
    /// The smoke.
    #[serde(default)]
    pub systems: Vec<PresetSystem>,
}

/// A perspective camera.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "app", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct Camera {
    /// World space, metres.
    #[cfg_attr(feature = "app", schemars(with = "[f32; 3]"))]
    pub position: Vec3,
    /// The point in the middle of the picture, metres.
    #[cfg_attr(feature = "app", schemars(with = "[f32; 3]"))]
    pub target: Vec3,
    /// Vertical field of view, degrees.
    pub fov: f32,
    /// Near plane, metres.
    pub near: f32,
    /// Far plane, metres.
    pub far: f32,
    /// Multiplies the linear picture by 2^exposure before it is tonemapped.
    pub exposure: f32,
}

impl Default for Camera {
    fn default() -> Self {
        Self {
            position: Vec3::new(0.0, 2.0, 8.0),
            target: Vec3::new(0.0, 1.5, 0.0),
            fov: 45.0,
            near: 0.1,
            far: 200.0,
            exposure: 0.0,
        }
    }
}

impl Camera {
    /// The view of a picture of this size.
    pub fn view(&self, size: UVec2) -> View {
        let aspect = size.x.max(1) as f32 / size.y.max(1) as f32;
        // Looking straight up or down, any other up will do.
        let forward = (self.target - self.position).normalize_or(Vec3::NEG_Z);
        let up = if forward.y.abs() > 0.999 { Vec3::Z } else { Vec3::Y };
        View {
            view_from_world: rh::view::look_to_mat4(self.position, forward, up),
            clip_from_view: rh::proj::directx::perspective(self.fov.to_radians(), aspect, self.near, self.far),
            size,
        }
    }
}

/// The demo scene and the light of its sky.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "app", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct Environment {
    /// Which scene.
    pub scene: SceneName,
    /// Linear RGB of the sky overhead.
    #[cfg_attr(feature = "app", schemars(with = "[f32; 3]"))]
    pub zenith: Vec3,
    /// Linear RGB of the sky at the horizon.
    #[cfg_attr(feature = "app", schemars(with = "[f32; 3]"))]
    pub horizon: Vec3,
    /// Linear RGB of the light that the ground throws back.
    #[cfg_attr(feature = "app", schemars(with = "[f32; 3]"))]
    pub ground: Vec3,
}

impl Default for Environment {
    fn default() -> Self {
        Self {
            scene: SceneName::default(),
            zenith: Vec3::new(0.045, 0.07, 0.14),
            horizon: Vec3::new(0.22, 0.19, 0.2),
            ground: Vec3::new(0.03, 0.028, 0.026),
        }
    }
}

/// The demo scenes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "app", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum SceneName {
    /// A yard with walls, crates, pillars and a fence.
    #[default]
    Yard,
    /// A colonnade with a far door.
    Corridor,
}

/// One particle system.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "app", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct PresetSystem {
    /// What a list shows.
    pub name: String,
    /// Where its particles come from.
    #[serde(default)]
    pub emitter: Emitter,
    /// Its pictures.
    #[serde(default)]
    pub material: MaterialNames,
    /// Everything a slider moves.
    #[serde(default)]
    pub settings: Settings,
}

impl Fields for Camera {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.vector("position", &mut self.position, -1.0e5..=1.0e5, "m");
        visitor.vector("target", &mut self.target, -1.0e5..=1.0e5, "m");
        visitor.number("fov", &mut self.fov, 1.0..=150.0, "degrees");
        visitor.number("near", &mut self.near, 0.001..=100.0, "m");
        visitor.number("far", &mut self.far, self.near * 1.01..=1.0e5, "m");
        visitor.number("exposure", &mut self.exposure, -16.0..=16.0, "EV");
    }
}

impl Fields for Environment {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.vector("zenith", &mut self.zenith, 0.0..=100.0, "");
        visitor.vector("horizon", &mut self.horizon, 0.0..=100.0, "");
        visitor.vector("ground", &mut self.ground, 0.0..=100.0, "");
    }
}

impl Fields for Preset {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.number("time", &mut self.time, -1.0e5..=1.0e5, "s");
        visitor.group("camera", &mut self.camera);
        visitor.group("environment", &mut self.environment);
    }
}

impl Preset {
    /// Reads a preset from a file, or a built-in one by name.
    ///
    /// # Errors
    /// [`Error::Io`], [`Error::Json`] with line and column, or [`Error::JsonField`] with the field and its range.
    pub fn load(name_or_path: &str) -> Result<Self, Error> {
        if let Some(preset) = builtin::find(builtin::PRESETS, name_or_path) {
            return Self::parse(&builtin::path(preset.name), &String::from_utf8_lossy(preset.bytes));
        }
        let path = Path::new(name_or_path);
        let looks_like_a_name = path.extension().is_none() && path.components().count() == 1;
        if looks_like_a_name && !path.exists() {
            let names: Vec<_> = builtin::PRESETS.iter().map(|preset| preset.name).collect();
            let expected = format!("one of {}, or the path of a JSON file", names.join(", "));
            return Err(FieldError::new("preset", format!("{name_or_path:?}"), expected).into());
        }
        json::load(path, PRESET_VERSION, Self::validate)
    }

    /// Parses and checks a preset. `path` is only named in errors.
    ///
    /// # Errors
    /// As [`Preset::load`].
    pub fn parse(path: &Path, text: &str) -> Result<Self, Error> {
        let preset: Self = json::parse_versioned(path, text, PRESET_VERSION)?;
        preset.validate().map_err(|error| Error::JsonField { path: path.into(), error })?;
        Ok(preset)
    }

    /// Checks every number.
    ///
    /// # Errors
    /// The first field that is not valid.
    pub fn validate(&self) -> Result<(), FieldError> {
        validate(self, String::new)?;
        if self.camera.position.distance(self.camera.target) < 1.0e-3 {
            return Err(FieldError::new("camera.target", self.camera.target, "a point other than camera.position"));
        }
        validate_lights(&self.lights)?;
        if self.systems.len() > MAX_SYSTEMS {
            let expected = format!("at most {MAX_SYSTEMS} systems");
            return Err(FieldError::new("systems", format!("{} systems", self.systems.len()), expected));
        }
        for (index, system) in self.systems.iter().enumerate() {
            system.emitter.validate(|| format!("systems[{index}].emitter"))?;
            system.settings.validate(|| format!("systems[{index}].settings"))?;
        }
        Ok(())
    }
}

impl PresetSystem {
    /// The particles alive at `time`, seconds.
    pub fn particles(&self, time: f32, particles: &mut Vec<Particle>) {
        let mut emitter = self.emitter;
        if self.settings.sprite.freeze_animation {
            emitter.frame_rate = 0.0;
        }
        emitter.evaluate(time, particles);
    }

    /// The settings for a picture of this height: what presets give in pixels, they give for [`DESIGN_HEIGHT`].
    pub fn settings_for(&self, height: u32) -> Settings {
        let mut settings = self.settings;
        settings.specular_scatter.size = (settings.specular_scatter.size * height as f32 / DESIGN_HEIGHT).max(1.0);
        settings
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_builtin_preset_loads_with_its_assets() {
        for preset in builtin::PRESETS {
            let loaded = Preset::load(preset.name).unwrap();
            assert!(!loaded.description.is_empty() && !loaded.systems.is_empty(), "{}", preset.name);
            for system in &loaded.systems {
                system.material.load(Path::new("")).unwrap();
            }
        }
    }

    #[test]
    fn every_builtin_asset_decodes() {
        for ramp in builtin::RAMPS.iter().chain(builtin::MOTIFS) {
            ramp.ramp().unwrap();
        }
        for builtin in builtin::SPRITES {
            let (sprite, detail) = (builtin.sprite().unwrap(), builtin.detail().unwrap().unwrap());
            assert!(sprite.frame_count() > 1);
            assert_eq!((detail.size() * 4, detail.frame_count()), (sprite.size(), sprite.frame_count()));
        }
        for noise in builtin::NOISES {
            assert_eq!(noise.noise().unwrap().size(), 32);
        }
    }

    #[test]
    fn mistakes_name_the_file_and_the_field() {
        let parse = |text: &str| Preset::parse(Path::new("my.json"), text).unwrap_err().to_string();
        let range = parse(r#"{"version": 1, "name": "x", "camera": {"fov": 200}}"#);
        assert_eq!(range, "my.json: camera.fov: 200 is not valid; expected 1 to 150 degrees");
        let nested = parse(
            r#"{"version": 1, "name": "x", "systems": [{"name": "s", "settings": {"soft_fade": {"fade_scale": 0}}}]}"#,
        );
        assert!(nested.starts_with("my.json: systems[0].settings.soft_fade.fade_scale: 0 is not valid"), "{nested}");
        let unknown = Preset::load("colunm").unwrap_err().to_string();
        assert!(unknown.contains("column, backlit_fog"), "{unknown}");
    }
}
