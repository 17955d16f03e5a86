//! Writes a copy of a preset, with the files that it names.

use std::collections::BTreeMap;
use std::path::Path;

use haze::FieldError;
use haze_author::ramp::RampRecipe;
use haze_core::error::Error;
use haze_export::named_preset::NamedPreset;
use haze_preset::directory::is_taken;
use haze_preset::{write_baked_png, write_file};
use haze_tweak::copy_assets;

/// Writes a preset that came from another, with its images beside it. `text`: the file; `named`: the preset, and where its files are.
pub fn write_preset(path: &Path, text: &str, named: &NamedPreset) -> Result<(), Error> {
    let folder = |path: &Path| path.parent().unwrap_or(Path::new("")).to_path_buf();
    write_ramps(&named.ramps, &folder(path))?;
    copy_assets(&named.preset, &folder(&named.path), &folder(path))?;
    Ok(write_file(path, text.as_bytes())?)
}

/// Writes the ramps of a link with their recipes. No file is replaced.
fn write_ramps(ramps: &BTreeMap<String, RampRecipe>, folder: &Path) -> Result<(), Error> {
    let files = |name: &String| [folder.join(name), folder.join(name).with_extension("ramp.json")];
    if let Some(taken) = ramps.keys().flat_map(files).find(|file| is_taken(file)) {
        let problem = format!("{} exists already", taken.display());
        return Err(FieldError::from_problem("FILE", problem, "a folder without the ramps of the link").into());
    }
    for (name, recipe) in ramps {
        let [image, file] = files(name);
        write_file(&file, recipe.to_json().as_bytes())?;
        write_baked_png(&image, &recipe.bake()?)?;
    }
    Ok(())
}
