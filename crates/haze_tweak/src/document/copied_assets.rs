//! Copies the images, recipes, particle files, scene and sky of a preset when it is saved to another folder.

use std::path::{Path, PathBuf};

use haze_author::backdrop::{backdrop_names, companion_files};
use haze_core::error::{AssetError, Error};
use haze_export::inputs::relative_image_paths;
use haze_export::recipe_files::recipe_paths;
use haze_preset::{AssetFolders, Preset, backdrop_file_path};

use crate::platform::asset_loading::particle_file_paths;
use crate::platform::file_io;

/// Copies the files that a preset names from one folder to another, under the same relative paths. Missing files are
/// skipped. No file is replaced: if a different file is in the way, the function returns an error before it writes
/// anything.
pub fn copy_assets(preset: &Preset, from: &Path, to: &Path) -> Result<(), Error> {
    let images = relative_image_paths(preset);
    let recipes: Vec<_> = images.iter().flat_map(|image| recipe_paths(image)).collect();
    let beside = images.into_iter().chain(recipes).map(|file| from.join(file));
    let sources = beside.chain(particle_file_paths(&AssetFolders::new(from), preset));
    let relative = |source: PathBuf| Some((source.clone(), to.join(source.strip_prefix(from).ok()?)));
    copy(sources.filter_map(relative))
}

/// Copies scene and sky of a preset, with the files beside a scene that it names. As [`copy_assets`].
pub fn copy_backdrop(preset: &Preset, folders: &AssetFolders, to: &Path) -> Result<(), Error> {
    let mut pairs = Vec::new();
    for (kind, _, name) in backdrop_names(&preset.environment) {
        let Some(file) = backdrop_file_path(name, kind) else { continue };
        let (Ok(source), target) = (folders.find(file), to.join(file)) else { continue };
        let [from, beside] = [&source, &target].map(|path| path.parent().unwrap_or(Path::new("")).to_owned());
        let companions = companion_files(&source).into_iter();
        pairs.extend(companions.filter_map(|file| Some((file.clone(), beside.join(file.strip_prefix(&from).ok()?)))));
        pairs.push((source, target));
    }
    copy(pairs.into_iter())
}

/// Copies files that exist. If a different file is in the way of one, none is written.
fn copy(pairs: impl Iterator<Item = (PathBuf, PathBuf)>) -> Result<(), Error> {
    let mut copies = Vec::new();
    for (source, target) in pairs.filter(|(source, _)| file_io::exists(source)) {
        if file_io::is_same(&source, &target) {
            continue;
        }
        let bytes = read(&source)?;
        if !file_io::is_taken(&target) {
            copies.push((source, target));
        } else if read(&target)? != bytes {
            let reason = format!("differs from {}; expected a folder without a file of this name", source.display());
            return Err(Error::from(AssetError::Image { path: target, reason }));
        }
    }
    for (source, target) in copies {
        target.parent().map_or(Ok(()), file_io::make_folder)?;
        file_io::write(&target, &read(&source)?)?;
    }
    Ok(())
}

fn read(path: &Path) -> Result<Vec<u8>, Error> {
    let ends_with = |end: &str| path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case(end));
    match () {
        () if ends_with("png") => file_io::read_image(path),
        () if ends_with("json") => file_io::read_recipe(path),
        () if ends_with("csv") || ends_with("ply") => file_io::read_particles(path),
        () => file_io::read_backdrop(path),
    }
}
