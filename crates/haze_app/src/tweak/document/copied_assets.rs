//! Copies the images, recipes and particle files of a preset when it is saved to another folder.

use std::path::Path;

use haze::Error;
use haze::preset::{AssetFolders, Preset};

use crate::inputs::relative_image_paths;
use crate::recipe_files::recipe_paths;
use crate::tweak::platform::asset_loading::particle_file_paths;
use crate::tweak::platform::file_io;

/// Copies the files that a preset names from one folder to another, under the same relative paths. Missing files are
/// skipped. No file is replaced: if a different file is in the way, the function returns an error before it writes
/// anything.
pub fn copy_assets(preset: &Preset, from: &Path, to: &Path) -> Result<(), Error> {
    let pictures = relative_image_paths(preset);
    let recipes: Vec<_> = pictures.iter().flat_map(|picture| recipe_paths(picture)).collect();
    let beside = pictures.into_iter().chain(recipes).map(|file| from.join(file));
    let sources = beside.chain(particle_file_paths(&AssetFolders::at(from), preset));
    let mut copies = Vec::new();
    for source in sources.filter(|source| file_io::exists(source)) {
        let Ok(file) = source.strip_prefix(from) else { continue };
        let target = to.join(file);
        if file_io::is_same(&source, &target) {
            continue;
        }
        let bytes = read(&source)?;
        if !file_io::is_taken(&target) {
            copies.push((source, target));
        } else if read(&target)? != bytes {
            let reason = format!("differs from {}; expected a folder without a file of this name", source.display());
            return Err(Error::Image { path: target, reason });
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
        () if ends_with("png") => file_io::read_picture(path),
        () if ends_with("json") => file_io::read_recipe(path),
        () => file_io::read_particles(path),
    }
}
