//! Recognizes a file that was passed to a command for another kind of file.

use std::ffi::OsStr;
use std::path::Path;

use haze::preset::Preset;
use haze::{Error, FieldError};
use haze_author::noise_recipe::NoiseRecipe;
use haze_author::ramp::RampRecipe;
use haze_author::ramp::motif::MotifRecipe;
use haze_author::sprite::bake::SpriteRecipe;

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

const RECIPES: [FileKind; 4] = [
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
];

/// Returns the names of all kinds of recipes.
pub fn recipe_kinds() -> impl Iterator<Item = &'static str> {
    RECIPES.iter().map(|kind| kind.name)
}

/// Explains an error of a file that could not be read as `expected`: if the file is of another kind, returns an error
/// that names the kind and the command that reads it, else the same error. `own` is the name of the expected kind.
pub fn explain_wrong_kind(error: Error, path: &Path, own: &str, expected: &str) -> Error {
    let named = |kind: &&FileKind| {
        let stem = Path::new(path.file_stem().unwrap_or_default());
        stem.extension() == Some(OsStr::new(kind.name)) && path.extension() == Some(OsStr::new("json"))
    };
    let kinds = || std::iter::once(&PRESET).chain(&RECIPES);
    let by_name = kinds().find(named).filter(|_| path.is_file());
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
