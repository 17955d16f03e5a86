//! Presets as Bevy assets.

use std::collections::HashMap;
use std::io;
use std::path::{Path, PathBuf};
use std::string::FromUtf8Error;

use bevy::asset::io::Reader;
use bevy::asset::{AssetLoader, AssetPath, LoadContext};
use bevy::prelude::*;
use bevy::reflect::TypePath;
use haze::MaterialAssets;
use haze::preset::{Preset, PresetSystem, Track};

/// Smoke as a preset describes it: emitters, settings, images and keyframes. A program loads it from a `*.smoke.json` file,
/// takes a built-in one, or makes it from haze's own types.
///
/// The preset's lights, camera and surroundings are not used, nor are their keyframes: the scene's take their place.
#[derive(Asset, TypePath, Clone, Debug)]
pub struct SmokeAsset {
    /// Particle systems, at most [`MAX_SYSTEMS`](haze::preset::MAX_SYSTEMS).
    pub systems: Vec<SmokeSystem>,
    /// Settings that change over the time of the entity's [`SmokeClock`](crate::SmokeClock), by keyframes and flicker. Each
    /// has the full name of a setting, such as `systems[0].settings.boost`; tracks of unknown settings and keyframes of
    /// another type do nothing.
    pub animation: Vec<Track>,
}

/// One particle system of a [`SmokeAsset`].
#[derive(Clone, Debug)]
pub struct SmokeSystem {
    /// Emitter and settings. Its positions are in the entity's local space.
    pub preset: PresetSystem,
    /// Ramps and sprites.
    pub images: MaterialAssets,
}

impl SmokeAsset {
    /// Built-in preset, such as `column` or `campfire`.
    ///
    /// # Errors
    /// The names of all built-in presets, if this one does not exist.
    pub fn builtin(name: &str) -> Result<Self, haze::AssetError> {
        let preset = Preset::load(name)?;
        let images = preset.load_materials(Path::new(name))?;
        Ok(Self::from_parts(preset, images))
    }

    fn from_parts(preset: Preset, images: Vec<MaterialAssets>) -> Self {
        let systems = preset.systems.into_iter().zip(images);
        let systems = systems.map(|(preset, images)| SmokeSystem { preset, images }).collect();
        let is_of_system = |track: &Track| track.setting.starts_with("systems[");
        Self { systems, animation: preset.animation.into_iter().filter(is_of_system).collect() }
    }
}

/// Error of a preset file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SmokeAssetError {
    /// The file could not be read.
    #[error("could not be read: {0}")]
    Io(#[from] io::Error),
    /// The file is not text.
    #[error("is not UTF-8 text: {0}")]
    Text(#[from] FromUtf8Error),
    /// The preset or one of its images is not valid. The message names file, line, field and range.
    #[error(transparent)]
    Preset(#[from] haze::AssetError),
    /// A system takes its particles from files, which this plugin does not read.
    #[error("systems[{0}].particle_files.path: particle files are not supported; expected an emitter")]
    ParticleFiles(usize),
}

/// Loads presets. Images that a preset names are built into haze, or PNG files in the preset's folder or below. Bevy's asset
/// server reads them, so they may be in any asset source, and a change of one of them reloads the preset.
#[derive(Default, TypePath)]
pub(crate) struct SmokeLoader;

impl AssetLoader for SmokeLoader {
    type Asset = SmokeAsset;
    type Settings = ();
    type Error = SmokeAssetError;

    async fn load(
        &self,
        reader: &mut dyn Reader,
        _settings: &(),
        context: &mut LoadContext<'_>,
    ) -> Result<SmokeAsset, SmokeAssetError> {
        let mut bytes = Vec::new();
        reader.read_to_end(&mut bytes).await?;
        let path = context.path().clone();
        let preset = Preset::parse(path.path(), &String::from_utf8(bytes)?)?;
        if let Some(index) = preset.systems.iter().position(|system| system.particle_files.is_used()) {
            return Err(SmokeAssetError::ParticleFiles(index));
        }
        let images = load_images(&preset, &path, context).await?;
        Ok(SmokeAsset::from_parts(preset, images))
    }

    fn extensions(&self) -> &[&str] {
        &["smoke.json"]
    }
}

/// Loads the images that the preset names. haze asks for files by a function that cannot wait: files that are not there yet
/// are noted, read, and the images loaded again.
async fn load_images(
    preset: &Preset,
    path: &AssetPath<'static>,
    context: &mut LoadContext<'_>,
) -> Result<Vec<MaterialAssets>, SmokeAssetError> {
    let mut files: HashMap<PathBuf, Result<Vec<u8>, String>> = HashMap::new();
    loop {
        let mut missing = Vec::new();
        let loaded = preset.load_materials_with(path.path(), |name| match files.get(name) {
            Some(Ok(bytes)) => Ok(bytes.clone()),
            Some(Err(reason)) => Err(io::Error::other(reason.clone())),
            None => {
                missing.push(name.to_path_buf());
                Err(io::ErrorKind::NotFound.into())
            }
        });
        match loaded {
            Err(_) if !missing.is_empty() => {}
            loaded => return Ok(loaded?),
        }
        for name in missing {
            let beside = path.resolve_embed(&AssetPath::from_path(&name));
            let bytes = context.read_asset_bytes(beside).await.map_err(|error| error.to_string());
            files.insert(name, bytes);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn builtin_presets_load_and_unknown_names_list_them() {
        assert_eq!(SmokeAsset::builtin("column").unwrap().systems.len(), 1);
        let error = SmokeAsset::builtin("colunm").unwrap_err().to_string();
        assert!(error.contains("column"), "{error}");
    }
}
