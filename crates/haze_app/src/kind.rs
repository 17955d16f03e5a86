//! What a file is that was handed to a command for another kind.

use std::ffi::OsStr;
use std::path::Path;

use haze::preset::Preset;
use haze::{Error, FieldError};
use haze_author::noise::NoiseRecipe;
use haze_author::ramp::bake::RampRecipe;
use haze_author::ramp::motif::MotifRecipe;
use haze_author::sprite::bake::SpriteRecipe;

struct Kind {
    /// As in `fire.ramp.json`.
    name: &'static str,
    what: &'static str,
    /// What takes it.
    command: &'static str,
    is_it: fn(&Path) -> bool,
}

const PRESET: Kind =
    Kind { name: "preset", what: "a preset", command: "haze preset check", is_it: |path| Preset::load(path).is_ok() };

const RECIPES: [Kind; 4] = [
    Kind {
        name: "ramp",
        what: "a ramp's recipe",
        command: "haze ramp check",
        is_it: |path| RampRecipe::load(path).is_ok(),
    },
    Kind {
        name: "motif",
        what: "a motif's recipe",
        command: "haze ramp bake",
        is_it: |path| MotifRecipe::load(path).is_ok(),
    },
    Kind {
        name: "sprite",
        what: "a sprite's recipe",
        command: "haze sprite bake",
        is_it: |path| SpriteRecipe::load(path).is_ok(),
    },
    Kind {
        name: "noise",
        what: "a noise's recipe",
        command: "haze sprite bake",
        is_it: |path| NoiseRecipe::load(path).is_ok(),
    },
];

/// The names of all kinds of recipes.
pub fn recipes() -> impl Iterator<Item = &'static str> {
    RECIPES.iter().map(|kind| kind.name)
}

/// Says of a file that `expected` could not be read from what it is instead, and which command takes it; else the same error.
/// `own` is the kind that was expected, by its name.
pub fn explain(error: Error, path: &Path, own: &str, expected: &str) -> Error {
    let named = |kind: &&Kind| {
        let stem = Path::new(path.file_stem().unwrap_or_default());
        stem.extension() == Some(OsStr::new(kind.name)) && path.extension() == Some(OsStr::new("json"))
    };
    let kinds = || std::iter::once(&PRESET).chain(&RECIPES);
    let by_name = kinds().find(named).filter(|_| path.is_file());
    let kind = by_name.or_else(|| kinds().find(|kind| (kind.is_it)(path)));
    match kind.filter(|kind| kind.name != own) {
        Some(Kind { what, command, .. }) => {
            let expected = format!("{expected}; it is {what}: `{command}` takes it");
            FieldError::new(own, path.display(), expected).into()
        }
        None => error,
    }
}
