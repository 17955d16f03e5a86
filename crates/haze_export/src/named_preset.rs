//! Presets as a command line names them: a built-in one, a file, or a link.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use haze::FieldError;
use haze_author::ramp::RampRecipe;
use haze_core::error::Error;
use haze_preset::{AssetFolders, Preset, encode_baked_png};

use super::share_link::{Look, fragment_of_name};

/// Preset, and where its files are.
pub struct NamedPreset {
    /// The preset.
    pub preset: Preset,
    /// Its name in errors: a link is long.
    pub path: PathBuf,
    /// Folders of its files. They hold the ramps of a link.
    pub folders: AssetFolders,
    /// Recipes of the ramps that a link has, by the file names of their images.
    pub ramps: BTreeMap<String, RampRecipe>,
}

impl NamedPreset {
    /// Loads a preset by its name, its path or its link. `shared`: folder of files that presets share.
    ///
    /// # Errors
    /// As [`Preset::load`] and [`Look::from_fragment`].
    pub fn load(name: &Path, shared: Option<PathBuf>) -> Result<Self, Error> {
        let Some(fragment) = fragment_of_name(name) else {
            if name.to_str().is_some_and(|name| name.contains("://")) && !name.exists() {
                let problem = format!("{} has no look after #", name.display());
                return Err(FieldError::from_problem("link", problem, "a whole link, as it was copied").into());
            }
            let folders = AssetFolders::for_preset_file(name).with_shared(shared);
            return Ok(Self { preset: Preset::load(name)?, path: name.into(), folders, ramps: BTreeMap::new() });
        };
        let Look { preset, ramps, .. } = Look::from_fragment(fragment)?;
        let mut images = BTreeMap::new();
        for (name, recipe) in &ramps {
            let file = PathBuf::from(name);
            let bytes = encode_baked_png(&file, &recipe.bake()?)?;
            images.insert(file, bytes);
        }
        let folders = AssetFolders::new(Path::new("")).with_images(images).with_shared(shared);
        Ok(Self { preset, path: "link".into(), folders, ramps })
    }
}
