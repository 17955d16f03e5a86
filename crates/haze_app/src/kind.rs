//! Recognizes a file that was passed to a command for another kind of file.

use std::ffi::OsStr;
use std::path::Path;

use haze::preset::Preset;
use haze::{Error, FieldError};
use haze_author::noise_recipe::NoiseRecipe;
use haze_author::ramp::RampRecipe;
use haze_author::ramp::motif::MotifRecipe;
use haze_author::sprite::bake::SpriteRecipe;

struct Kind {
    /// Part of the file name: `ramp` in `fire.ramp.json`.
    name: &'static str,
    what: &'static str,
    /// Command that reads this kind.
    command: &'static str,
    can_load: fn(&Path) -> bool,
}

const PRESET: Kind = Kind {
    name: "preset",
    what: "a preset",
    command: "haze preset check",
    can_load: |path| Preset::load(path).is_ok(),
};

const RECIPES: [Kind; 4] = [
    Kind {
        name: "ramp",
        what: "a ramp recipe",
        command: "haze ramp check",
        can_load: |path| RampRecipe::load(path).is_ok(),
    },
    Kind {
        name: "motif",
        what: "a motif recipe",
        command: "haze ramp bake",
        can_load: |path| MotifRecipe::load(path).is_ok(),
    },
    Kind {
        name: "sprite",
        what: "a sprite recipe",
        command: "haze sprite bake",
        can_load: |path| SpriteRecipe::load(path).is_ok(),
    },
    Kind {
        name: "noise",
        what: "a noise recipe",
        command: "haze sprite bake",
        can_load: |path| NoiseRecipe::load(path).is_ok(),
    },
];

/// Returns the names of all kinds of recipes.
pub fn recipes() -> impl Iterator<Item = &'static str> {
    RECIPES.iter().map(|kind| kind.name)
}

/// Explains an error of a file that could not be read as `expected`: if the file is of another kind, returns an error
/// that names the kind and the command that reads it, else the same error. `own` is the name of the expected kind.
pub fn explain(error: Error, path: &Path, own: &str, expected: &str) -> Error {
    let named = |kind: &&Kind| {
        let stem = Path::new(path.file_stem().unwrap_or_default());
        stem.extension() == Some(OsStr::new(kind.name)) && path.extension() == Some(OsStr::new("json"))
    };
    let kinds = || std::iter::once(&PRESET).chain(&RECIPES);
    let by_name = kinds().find(named).filter(|_| path.is_file());
    let kind = by_name.or_else(|| kinds().find(|kind| (kind.can_load)(path)));
    match kind.filter(|kind| kind.name != own) {
        Some(Kind { what, command, .. }) => {
            let expected = format!("{expected}, but it is {what}: use `{command}`");
            FieldError::new(own, path.display(), expected).into()
        }
        None => error,
    }
}
