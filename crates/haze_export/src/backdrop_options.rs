//! Options for an own scene and sky around the smoke.

use std::path::{Path, PathBuf};

use clap::Args;
use haze::{Error, FieldError};
use haze_author::backdrop::Backdrop;
use haze_core::settings::BackdropKind;
use haze_demo::shot::Shot;
use haze_preset::{Preset, backdrop_kind};

/// Scene and sky from files, in place of those of the preset.
#[derive(Args, Clone, Debug, Default)]
pub struct BackdropArguments {
    /// Scene around the smoke: a glTF file, in any folder.
    #[arg(long, value_name = "FILE.glb")]
    scene: Option<PathBuf>,
    /// Sky behind the smoke: a panorama, in any folder. It lights scene and smoke.
    #[arg(long, value_name = "FILE.hdr")]
    sky: Option<PathBuf>,
    /// Use the camera of the scene file in place of the preset's.
    #[arg(long)]
    scene_camera: bool,
    /// Use the lights of the scene file in place of the preset's.
    #[arg(long)]
    scene_lights: bool,
}

impl BackdropArguments {
    fn named(&self) -> [(BackdropKind, &'static str, Option<&Path>); 2] {
        [(BackdropKind::Scene, "--scene", self.scene.as_deref()), (BackdropKind::Sky, "--sky", self.sky.as_deref())]
    }

    /// Builds a shot by `load`, with these files in place of those that the preset names, and takes camera and lights of the
    /// scene if they are asked for.
    ///
    /// # Errors
    /// Those of `load` and of the files; for a file of another kind; if camera or lights are asked for, but there are none.
    pub fn apply(&self, mut preset: Preset, load: impl FnOnce(Preset) -> Result<Shot, Error>) -> Result<Shot, Error> {
        for (kind, option, file) in self.named() {
            let Some(file) = file else { continue };
            if backdrop_kind(file) != Some(kind) {
                let expected = format!("a file that ends in .{}", kind.endings().join(" or ."));
                return Err(FieldError::new(option, file.display(), expected).into());
            }
            preset.environment.backdrop_name_mut(kind).clear();
        }
        let mut shot = load(preset)?;
        for (kind, option, file) in self.named() {
            let Some(file) = file else { continue };
            let named = |error| Error::Asset { named_by: option.into(), error: Box::new(error) };
            shot.backdrop.load_file(kind, file).map_err(named)?;
            let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
            *shot.preset.environment.backdrop_name_mut(kind) = name;
        }
        for (option, is_asked, take) in [
            ("--scene-camera", self.scene_camera, Backdrop::take_camera as fn(&Backdrop, &mut Preset) -> bool),
            ("--scene-lights", self.scene_lights, Backdrop::take_lights),
        ] {
            if is_asked && !take(&shot.backdrop, &mut shot.preset) {
                let what = option.trim_start_matches("--scene-");
                let problem = match shot.backdrop.scene {
                    Some(_) => format!("the scene file has no {what}"),
                    None => "there is no scene file".into(),
                };
                return Err(FieldError::from_problem(option, problem, format!("a scene file that has {what}")).into());
            }
        }
        shot.preset.validate()?;
        Ok(shot)
    }
}
