//! Names of recipes and of the images that are baked from them.

use std::path::{Path, PathBuf};

use super::file_kind::recipe_kinds;

/// Returns the possible recipes of an image: `fire.ramp.json`, and so on, for `fire.png`.
pub fn recipe_paths(image: &Path) -> impl Iterator<Item = PathBuf> {
    recipe_kinds().map(|kind| image.with_extension(format!("{kind}.json")))
}

/// Name without `.json`: `fire.ramp` for `fire.ramp.json`.
pub fn recipe_stem(path: &Path) -> &Path {
    Path::new(path.file_stem().unwrap_or_default())
}

/// Returns the path of the image of a ramp or motif recipe.
pub fn image_path(path: &Path) -> PathBuf {
    path.with_file_name(recipe_stem(path).with_extension("png"))
}

/// Returns the path of a sprite's six-way maps: `smoke.six_way.png` for `smoke.png`.
pub fn six_way_path(image: &Path) -> PathBuf {
    image.with_extension("six_way.png")
}

/// True if the path has this extension, in any case.
pub fn has_extension(path: &Path, expected: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(expected))
}
