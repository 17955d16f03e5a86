//! Recognizes a file that was passed to a command for another kind of file, and the file to open among several.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use haze::FieldError;
use haze_author::noise_recipe::NoiseRecipe;
use haze_author::ramp::RampRecipe;
use haze_author::ramp::motif::MotifRecipe;
use haze_author::simulation::SimRecipe;
use haze_author::sprite::bake::SpriteRecipe;
use haze_core::error::Error;
use haze_preset::Preset;

struct FileKind {
    /// Part of the file name: `ramp` in `fire.ramp.json`.
    name: &'static str,
    description: &'static str,
    /// Command that reads this kind.
    command: &'static str,
    can_load: fn(&Path) -> bool,
}

const PRESET: FileKind = FileKind {
    name: "preset",
    description: "a preset",
    command: "haze preset check",
    can_load: |path| Preset::load(path).is_ok(),
};

const RECIPES: [FileKind; 5] = [
    FileKind {
        name: "ramp",
        description: "a ramp recipe",
        command: "haze ramp check",
        can_load: |path| RampRecipe::load(path).is_ok(),
    },
    FileKind {
        name: "motif",
        description: "a motif recipe",
        command: "haze ramp bake",
        can_load: |path| MotifRecipe::load(path).is_ok(),
    },
    FileKind {
        name: "sprite",
        description: "a sprite recipe",
        command: "haze sprite bake",
        can_load: |path| SpriteRecipe::load(path).is_ok(),
    },
    FileKind {
        name: "noise",
        description: "a noise recipe",
        command: "haze sprite bake",
        can_load: |path| NoiseRecipe::load(path).is_ok(),
    },
    FileKind {
        name: "sim",
        description: "a recipe of a simulation",
        command: "haze sprite simulate",
        can_load: |path| SimRecipe::load(path).is_ok(),
    },
];

/// Returns the names of all kinds of recipes.
pub fn recipe_kinds() -> impl Iterator<Item = &'static str> {
    RECIPES.iter().map(|kind| kind.name)
}

impl FileKind {
    /// Returns true for `fire.ramp.json` if this is the kind of ramp recipes.
    fn is_in_name(&self, path: &Path) -> bool {
        let stem = Path::new(path.file_stem().unwrap_or_default());
        stem.extension() == Some(OsStr::new(self.name)) && path.extension() == Some(OsStr::new("json"))
    }
}

/// Returns which of the files that a user gives together are to be opened, judged by their names: the preset, which may
/// come with all that it names; else all but the recipes, which belong to images.
pub fn files_to_open(files: Vec<PathBuf>) -> Vec<PathBuf> {
    let is_recipe = |path: &PathBuf| RECIPES.iter().any(|kind| kind.is_in_name(path));
    let is_preset = |path: &PathBuf| path.extension() == Some(OsStr::new("json")) && !is_recipe(path);
    if let Some(preset) = files.iter().find(|path| is_preset(path)) {
        return vec![preset.clone()];
    }
    let (recipes, others): (Vec<_>, Vec<_>) = files.into_iter().partition(is_recipe);
    if others.is_empty() { recipes } else { others }
}

/// Explains an error of a file that could not be read as `expected`: if the file is of another kind, returns an error
/// that names the kind and the command that reads it, else the same error. `own` is the name of the expected kind.
pub fn explain_wrong_kind(error: Error, path: &Path, own: &str, expected: &str) -> Error {
    let kinds = || std::iter::once(&PRESET).chain(&RECIPES);
    let by_name = kinds().find(|kind| kind.is_in_name(path)).filter(|_| path.is_file());
    let kind = by_name.or_else(|| kinds().find(|kind| (kind.can_load)(path)));
    match kind.filter(|kind| kind.name != own) {
        Some(FileKind { description, command, .. }) => {
            let problem = format!("{} is {description}", path.display());
            let expected = format!("{expected}, or `{command}` for this file");
            FieldError::from_problem(own, problem, expected).into()
        }
        None => error,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_preset_is_opened_before_what_it_names_and_an_image_before_its_recipe() {
        let opened = |names: &[&str]| -> Vec<_> {
            let files = names.iter().map(PathBuf::from).collect();
            files_to_open(files).into_iter().map(|path| path.display().to_string()).collect()
        };
        assert_eq!(opened(&["a.png", "a.sprite.json", "mine.json", "b.ramp.json"]), ["mine.json"]);
        assert_eq!(opened(&["a.png", "a.sprite.json", "b.png", "smoke.csv"]), ["a.png", "b.png", "smoke.csv"]);
        assert_eq!(opened(&["a.png", "a.sim.json"]), ["a.png"]);
        assert_eq!(opened(&["a.sprite.json"]), ["a.sprite.json"]);
        assert!(opened(&[]).is_empty());
    }
}
