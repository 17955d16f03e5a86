//! Scenes and skies dropped on the window, or chosen: shown around the smoke from any folder.

use std::path::{Path, PathBuf};

use haze::FieldError;
use haze_author::backdrop::{BLENDER_SKY_ROTATION, Backdrop};
use haze_core::error::Error;
use haze_core::settings::BackdropKind;
use haze_preset::AssetFolders;

use super::dropped_image::location_of;
use crate::platform::{IS_PAGE, asset_loading, file_io};
use crate::session::Session;

/// Scene or sky that was loaded, and its name in the preset.
pub struct DroppedBackdrop {
    kind: BackdropKind,
    name: String,
    /// Folder that the name is relative to.
    folder: PathBuf,
    loaded: Backdrop,
}

impl DroppedBackdrop {
    /// Reads a file in any folder.
    ///
    /// # Errors
    /// Those of the file; if the preset's folders have another file of its name, which the name would stand for.
    pub fn read(kind: BackdropKind, path: &Path, folders: &AssetFolders) -> Result<Self, Error> {
        let elsewhere = || {
            let path = file_io::absolute(path);
            Some((path.parent()?.to_owned(), path.file_name()?.to_str()?.to_owned()))
        };
        let (folder, name) = location_of(path, folders).or_else(elsewhere).unwrap_or_default();
        if let Ok(other) = folders.find(Path::new(&name))
            && !file_io::is_same(&other, path)
        {
            let problem = format!("{} has the name of {}", path.display(), other.display());
            return Err(FieldError::from_problem("dropped file", problem, "another name").into());
        }
        Ok(Self { kind, name, folder, loaded: asset_loading::backdrop_file(kind, path)? })
    }

    /// Shows it around the smoke, as one step that can be undone.
    pub fn apply(self, session: &mut Session) {
        let Self { kind, name, folder, loaded } = self;
        if IS_PAGE {
            return session.messages.info("file", format!("A page does not show {name}; the program does"));
        }
        let is_known = session.folders().candidate_paths(Path::new("")).any(|known| file_io::is_same(&known, &folder));
        if !is_known {
            session.backdrop_folders.push(folder);
        }
        let beside = session.backdrop.of(&session.document.preset);
        let is_turned = kind == BackdropKind::Sky && beside.is_from_blender();
        let said = match (kind, &loaded.scene) {
            (BackdropKind::Scene, Some(scene)) => {
                let is_unturned = session.document.preset.environment.sky_rotation == 0.0;
                let hint = match scene.is_from_blender && beside.sky.is_some() && is_unturned {
                    true => "; if the sky is its world, press Sky from Blender",
                    false => "",
                };
                format!("{name} is now the scene: {}{hint}", scene.description())
            }
            _ => {
                let mut systems = session.document.preset.systems.iter();
                let is_dark = !systems.any(|system| system.settings.ambient.intensity > 0.0);
                let smoke =
                    if is_dark { ", but not the smoke, whose ambient intensity is 0" } else { " and the smoke" };
                let turned = if is_turned { ", turned as the world of a scene from Blender" } else { "" };
                format!("{name} is now the sky{turned}. It lights the scene{smoke}")
            }
        };
        if is_turned {
            session.document.preset.environment.sky_rotation = BLENDER_SKY_ROTATION;
        }
        session.backdrop.put(kind, &name, loaded);
        *session.document.preset.environment.backdrop_name_mut(kind) = name;
        session.messages.clear("backdrop");
        session.messages.info("file", said);
    }
}
