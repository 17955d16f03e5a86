//! Options for an own scene and sky around the smoke.

use std::path::{Path, PathBuf};

use clap::Args;
use haze::FieldError;
use haze_author::backdrop::{BLENDER_SKY_ROTATION, Backdrop};
use haze_core::error::{AssetError, Error};
use haze_core::settings::BackdropKind;
use haze_demo::shot::Shot;
use haze_preset::{Preset, backdrop_endings, backdrop_kind};

/// Scene and sky from files, instead of those of the preset.
#[derive(Args, Clone, Debug, Default)]
pub struct BackdropArguments {
    /// Scene around the smoke: a glTF file, in any folder.
    #[arg(long, value_name = "FILE.glb")]
    scene: Option<PathBuf>,
    /// Sky behind the smoke: a panorama, in any folder. It lights scene and smoke.
    #[arg(long, value_name = "FILE.hdr")]
    sky: Option<PathBuf>,
    /// The sky is the world of a Blender scene: sets `environment.sky_rotation` to 90. Beside a scene file of Blender, --sky
    /// alone does so too.
    #[arg(long, requires = "sky")]
    sky_from_blender: bool,
    /// Use a camera of the scene file instead of the preset's: that of this name, or the first.
    #[arg(long, value_name = "NAME", num_args = 0..=1, default_missing_value = "")]
    scene_camera: Option<String>,
    /// Use the lights of the scene file instead of the preset's.
    #[arg(long)]
    scene_lights: bool,
}

/// A shot with a backdrop of the command line.
pub struct BackdropShot {
    /// The shot.
    pub shot: Shot,
    /// Groups of settings that files have replaced, or single settings.
    pub replaced: Vec<&'static str>,
}

/// Setting that turns the sky.
pub const SKY_ROTATION: &str = "environment.sky_rotation";

impl BackdropArguments {
    fn named(&self) -> [(BackdropKind, &'static str, Option<&Path>); 2] {
        [(BackdropKind::Scene, "--scene", self.scene.as_deref()), (BackdropKind::Sky, "--sky", self.sky.as_deref())]
    }

    /// True if settings of the preset are replaced by those of a file.
    pub fn replaces_settings(&self) -> bool {
        self.scene_camera.is_some() || self.scene_lights
    }

    /// Builds a shot by `load`, with these files instead of those that the preset names, and takes camera and lights of the
    /// scene if they are asked for.
    ///
    /// # Errors
    /// Those of `load` and of the files; for a file of another kind; if camera or lights are asked for, but there are none.
    pub fn apply(
        &self,
        mut preset: Preset,
        load: impl FnOnce(Preset) -> Result<Shot, Error>,
    ) -> Result<BackdropShot, Error> {
        for (kind, option, file) in self.named() {
            let Some(file) = file else { continue };
            if backdrop_kind(file) != Some(kind) {
                let expected = format!("a file that ends in .{}", backdrop_endings(kind).join(" or ."));
                return Err(FieldError::new(option, file.display(), expected).into());
            }
            preset.environment.backdrop_name_mut(kind).clear();
        }
        let mut shot = load(preset)?;
        for (kind, option, file) in self.named() {
            let Some(file) = file else { continue };
            let named = |error| AssetError::Named { named_by: option.into(), error: Box::new(error) };
            shot.backdrop.load_file(kind, file).map_err(named)?;
            let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
            *shot.preset.environment.backdrop_name_mut(kind) = name;
        }
        let mut replaced = Vec::new();
        if self.sky_from_blender || self.sky.is_some() && shot.backdrop.is_from_blender() {
            shot.preset.environment.sky_rotation = BLENDER_SKY_ROTATION;
            replaced.push(SKY_ROTATION);
        }
        if let Some(name) = &self.scene_camera {
            let backdrop = shot.backdrop.clone();
            if !backdrop.take_camera(Some(name.as_str()).filter(|name| !name.is_empty()), &mut shot.preset) {
                return Err(missing_camera(&backdrop, name).into());
            }
            replaced.push("camera");
        }
        if self.scene_lights {
            let backdrop = shot.backdrop.clone();
            if !backdrop.take_lights(&mut shot.preset) {
                let expected = "a scene file that has lights";
                return Err(FieldError::from_problem("--scene-lights", missing(&backdrop, "lights"), expected).into());
            }
            replaced.push("lights");
        }
        Ok(BackdropShot { shot, replaced })
    }

    /// Reason why a field that `--set` names has no effect beside these options.
    pub fn no_effect_reason(&self, name: &str) -> Option<&'static str> {
        match name {
            "environment.scene_file" if self.scene.is_some() => Some("--scene names the file"),
            "environment.sky_file" if self.sky.is_some() => Some("--sky names the file"),
            _ => None,
        }
    }

    /// Line about the rotation of the sky, if it is not what the options seem to say. `is_set`: `--set` gives the rotation.
    pub fn sky_note(&self, shot: &Shot, is_set: bool) -> Option<String> {
        let sky = self.sky.as_ref()?.display();
        match (self.sky_from_blender, is_set) {
            (true, true) => Some(format!("--sky-from-blender has no effect: --set gives {SKY_ROTATION}")),
            (false, false) if shot.backdrop.is_from_blender() => Some(format!(
                "{sky}: turned by {BLENDER_SKY_ROTATION} degrees, as the world of a scene from Blender; if it is not, \
                 --set {SKY_ROTATION}=0"
            )),
            _ => None,
        }
    }
}

fn missing(backdrop: &Backdrop, part: &str) -> String {
    match backdrop.mesh() {
        Some(_) => format!("the scene file has no {part}"),
        None => "there is no scene file".into(),
    }
}

fn missing_camera(backdrop: &Backdrop, name: &str) -> FieldError {
    let cameras = backdrop.mesh().map(|scene| scene.cameras.as_slice()).unwrap_or_default();
    let names: Vec<_> = cameras.iter().map(|camera| format!("{:?}", camera.name)).collect();
    let (part, expected) = match names.is_empty() {
        true => ("perspective camera".into(), "a scene file that has a perspective camera".into()),
        false => (format!("perspective camera {name:?}"), format!("one of {}", names.join(", "))),
    };
    FieldError::from_problem("--scene-camera", missing(backdrop, &part), expected)
}
