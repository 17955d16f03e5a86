//! Reads the files that presets name.

use std::path::{Path, PathBuf};

use glam::UVec2;
use haze::MaterialAssets;
use haze::shader::Sources;
use haze_author::backdrop::Backdrop;
use haze_author::particle_files::{ParticleFrames, load_particle_files};
use haze_author::ramp::RampRecipe;
use haze_author::sprite::bake::SpriteRecipe;
use haze_core::assets::ramp::Ramp;
use haze_core::error::Error;
use haze_core::settings::BackdropKind;
use haze_demo::shot::Shot;
use haze_preset::{AssetFolders, ImageSource, MaterialSources, Preset, image_file_path};

pub use haze_export::inputs::particle_file_paths;

/// All files that a preset names.
pub struct LoadedAssets {
    /// Images of each system.
    pub materials: Vec<MaterialAssets>,
    /// Particles of each system that has particle files.
    pub particles: Vec<Option<ParticleFrames>>,
    pub backdrop: Backdrop,
}

/// Loads all files that the preset at a path names.
pub fn all(preset: &Preset, path: &Path, folders: &AssetFolders) -> Result<LoadedAssets, Error> {
    let materials = images(preset, path, folders)?;
    let particles = particles(preset, path, folders)?;
    Ok(LoadedAssets { materials, particles, backdrop: backdrop(preset, path, folders)? })
}

/// Loads the images of every system.
pub fn images(preset: &Preset, path: &Path, folders: &AssetFolders) -> Result<Vec<MaterialAssets>, Error> {
    Ok(preset.load_materials_from(path, folders)?)
}

/// Loads the particles of every system that has particle files.
pub fn particles(preset: &Preset, path: &Path, folders: &AssetFolders) -> Result<Vec<Option<ParticleFrames>>, Error> {
    Ok(load_particle_files(preset, path, folders)?)
}

/// Loads scene and sky. A page loads none.
pub fn backdrop(preset: &Preset, path: &Path, folders: &AssetFolders) -> Result<Backdrop, Error> {
    Ok(Backdrop::load(preset, path, folders)?)
}

/// Loads a scene or a sky. A page loads none.
pub fn backdrop_file(kind: BackdropKind, path: &Path) -> Result<Backdrop, Error> {
    let mut backdrop = Backdrop::default();
    backdrop.load_file(kind, path)?;
    Ok(backdrop)
}

/// Loads the images of one material.
pub fn material(names: &MaterialSources, folder: &Path) -> Result<MaterialAssets, Error> {
    Ok(names.load(ImageSource::folder(folder))?)
}

/// Returns the path of an image, or the path where it is expected; empty if it is built in.
pub fn image_path(name: &str, folders: &AssetFolders) -> PathBuf {
    let find = |file| folders.find(file).ok().or_else(|| folders.candidate_paths(file).next());
    image_file_path(name).and_then(find).unwrap_or_default()
}

pub fn ramp(path: &Path) -> Result<Ramp, Error> {
    Ok(Ramp::load(path)?)
}

pub fn ramp_recipe(path: &Path) -> Result<RampRecipe, Error> {
    Ok(RampRecipe::load(path)?)
}

pub fn sprite_recipe(path: &Path) -> Result<SpriteRecipe, Error> {
    Ok(SpriteRecipe::load(path)?)
}

/// Loads a preset, built-in or from a file, with all that it names.
pub fn shot(path: &Path, folders: &AssetFolders, size: UVec2) -> Result<Shot, Error> {
    Shot::from_folders(Preset::load(path)?, path, folders, size)
}

/// Loads the shaders of a folder.
pub fn shaders(folder: &Path) -> Result<Sources, Error> {
    Ok(Sources::from_folder(folder)?)
}
