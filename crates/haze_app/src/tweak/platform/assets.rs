//! What presets name, read from disk.

use std::path::{Path, PathBuf};

use glam::UVec2;
use haze::preset::{MaterialNames, PictureFolders, Preset, picture_file};
use haze::ramp::Ramp;
use haze::shader::Sources;
use haze::{Error, MaterialAssets};
use haze_author::particle_files::{Cache, load_caches};
use haze_author::ramp::bake::RampRecipe;
use haze_author::sprite::bake::SpriteRecipe;
use haze_demo::shot::Shot;

pub use crate::inputs::caches_of;

/// What the files hold that the systems of a preset name: pictures, and particles.
pub type Loaded = (Vec<MaterialAssets>, Vec<Option<Cache>>);

/// All that the preset of a path names.
pub fn all(preset: &Preset, path: &Path, folders: &PictureFolders) -> Result<Loaded, Error> {
    Ok((pictures(preset, path, folders)?, particles(preset, path, folders)?))
}

/// The pictures of every system.
pub fn pictures(preset: &Preset, path: &Path, folders: &PictureFolders) -> Result<Vec<MaterialAssets>, Error> {
    preset.load_materials_from(path, folders)
}

/// The particles of every system that has files of them.
pub fn particles(preset: &Preset, path: &Path, folders: &PictureFolders) -> Result<Vec<Option<Cache>>, Error> {
    load_caches(preset, path, folders)
}

/// The pictures of one material.
pub fn material(names: &MaterialNames, folder: &Path) -> Result<MaterialAssets, Error> {
    names.load(folder)
}

/// Where the picture of a name is, or would be; nowhere if it is built in.
pub fn place_of(name: &str, folders: &PictureFolders) -> PathBuf {
    let place = |file| folders.find(file).ok().or_else(|| folders.places(file).next());
    picture_file(name).and_then(place).unwrap_or_default()
}

pub fn ramp(path: &Path) -> Result<Ramp, Error> {
    Ramp::load(path)
}

pub fn ramp_recipe(path: &Path) -> Result<RampRecipe, Error> {
    RampRecipe::load(path)
}

pub fn sprite_recipe(path: &Path) -> Result<SpriteRecipe, Error> {
    SpriteRecipe::load(path)
}

/// A preset, built in or of a file, with all that it names.
pub fn shot(path: &Path, folders: &PictureFolders, size: UVec2) -> Result<Shot, Error> {
    Shot::from_folders(Preset::load(path)?, path, folders, size)
}

/// The shaders of a folder.
pub fn shaders(folder: &Path) -> Result<Sources, Error> {
    Sources::from_folder(folder)
}
