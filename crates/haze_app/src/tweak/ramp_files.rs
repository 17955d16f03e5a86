//! The ramps of a preset that have a recipe beside them: seen while they are changed, written when a step is done.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use egui_gradient::GradientEditor;
use haze::preset::{PictureFolders, Preset};
use haze::ramp::Ramp;
use haze::settings::{Value, set_field, values};
use haze::{Error, MaterialAssets, builtin};
use haze_author::ramp::bake::RampRecipe;
use haze_author::ramp::fit::{USUAL_ERROR, fit};

use super::document::document::Document;
use super::platform::assets;
use super::platform::files::{self, Effort, Stamp, read_colour_png, write_png};

/// Those that panels have asked about, by the names that the preset has for them.
#[derive(Default)]
pub struct RampFiles {
    /// The preset that they are of.
    preset: PathBuf,
    known: BTreeMap<String, Known>,
    /// An editor for each field, and the row that it shows.
    editors: BTreeMap<&'static str, (GradientEditor, usize)>,
    /// The ramp that is to have a copy beside the preset: a field of a system.
    wanted: Option<(usize, &'static str)>,
    /// The preset has no place yet for it.
    pub wants_place: bool,
}

/// What a ramp is to who wants to change it.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// It comes with the program.
    BuiltIn,
    /// Its stops can be changed.
    Recipe(RampRecipe),
    /// There is a picture that no recipe beside it makes: it was painted.
    Painted,
    /// It cannot be read; why is said elsewhere.
    Missing,
}

struct Known {
    picture: PathBuf,
    /// The picture's file and the recipe's, as they were when they were read or written.
    stamps: [Option<Stamp>; 2],
    source: Source,
    /// What the picture on disk is made by.
    written: Option<RampRecipe>,
    /// What it is baked to now.
    live: Option<(RampRecipe, Ramp)>,
    /// Something was written: its files may be others.
    is_stale: bool,
}

impl RampFiles {
    /// Something was written: files that are others are read again.
    pub fn look_again(&mut self) {
        self.known.values_mut().for_each(|known| known.is_stale = true);
    }

    /// What a ramp is.
    pub fn source(&mut self, name: &str, folders: &PictureFolders) -> &Source {
        let known = self.known.entry(name.into()).or_insert_with(|| Known::read(name, folders));
        &known.source
    }

    /// The editor of a field, and its row.
    pub fn editor(&mut self, field: &'static str) -> &mut (GradientEditor, usize) {
        self.editors.entry(field).or_default()
    }

    /// A step is being made in one of the editors.
    pub fn is_editing(&self) -> bool {
        self.editors.values().any(|(editor, _)| editor.is_editing())
    }

    /// What is pasted is for one of them.
    pub fn takes_paste(&self) -> bool {
        self.editors.values().any(|(editor, _)| editor.takes_paste())
    }

    /// A copy of a built-in ramp is wanted; where the preset is built in, that is saved first.
    pub fn want_own(&mut self, system: usize, field: &'static str, is_built_in: bool) {
        (self.wanted, self.wants_place) = (Some((system, field)), is_built_in);
    }

    /// Writes the copy that is wanted, and names it in the preset, once that is a file.
    pub fn make_own(&mut self, document: &mut Document) -> Result<(), Error> {
        let Some((system, field)) = self.wanted.filter(|_| !document.is_built_in()) else { return Ok(()) };
        self.wanted = None;
        let field = format!("systems[{system}].material.{field}");
        let named = values(&document.preset).into_iter().find(|(path, _)| *path == field);
        let Some((_, Value::Text(name))) = named else { return Ok(()) };
        let copy = copy_of(&name, document.path())?;
        set_field(&mut document.preset, &field, &copy)?;
        Ok(())
    }

    /// Puts stops fitted to its picture in the place of a recipe, and gives how many there are and how far they are off.
    pub fn fit(&mut self, name: &str) -> Result<(usize, f32), Error> {
        let Some(known) = self.known.get_mut(name) else { return Ok((0, 0.0)) };
        let fitted = fit(&read_colour_png(&known.picture)?, USUAL_ERROR)?;
        let count = fitted.recipe.rows.iter().map(|row| row.stops.len()).sum();
        // The picture stays as it was painted until a stop is changed.
        known.written = Some(fitted.recipe.clone());
        known.source = Source::Recipe(fitted.recipe);
        Ok((count, fitted.error))
    }

    /// Once a frame, after the panels: bakes what was changed, and writes it unless a control is held.
    pub fn advance(&mut self, document: &mut Document, folders: &PictureFolders, is_held: bool) -> Result<(), Error> {
        if self.preset != document.path() {
            self.known.clear();
            self.preset = document.path().into();
        }
        for (name, known) in &mut self.known {
            if !is_held && (known.is_stale || known.is_to_be_written(document.recipes.ramps.get(name))) {
                known.is_stale = false;
                if known.stamps != stamps(&known.picture) {
                    // Another program has the last word.
                    *known = Known::read(name, folders);
                    document.recipes.ramps.forget(name);
                }
            }
            let Source::Recipe(recipe) = &known.source else { continue };
            let recipe = document.recipes.ramps.get(name).unwrap_or(recipe);
            let has_live = known.live.as_ref().is_some_and(|(live, _)| live == recipe);
            if known.written.as_ref() == Some(recipe) && (known.live.is_none() || has_live) {
                continue;
            }
            let picture = recipe.bake()?;
            if !has_live {
                known.live = Some((recipe.clone(), Ramp::from_picture(&picture)));
            }
            if !is_held && known.written.as_ref() != Some(recipe) {
                // Said once where it cannot be written; the next step tries again.
                known.written = Some(recipe.clone());
                let done = write(&known.picture, recipe, &picture);
                known.stamps = stamps(&known.picture);
                done?;
            }
        }
        Ok(())
    }

    /// Puts ramps as they are now in the place of those that were loaded.
    pub fn apply(&self, preset: &Preset, materials: &mut [MaterialAssets]) {
        for (system, assets) in preset.systems.iter().zip(materials) {
            let names = &system.material;
            for (name, ramp) in [
                (&names.diffuse_ramp, &mut assets.diffuse_ramp),
                (&names.backlight_ramp, &mut assets.backlight_ramp),
                (&names.soft_scatter_ramp, &mut assets.soft_scatter_ramp),
                (&names.specular_ramp, &mut assets.specular_ramp),
                (&names.coverage_ramp, &mut assets.coverage_ramp),
                (&names.age_ramp, &mut assets.age_ramp),
            ] {
                if let Some((_, live)) = self.known.get(name).and_then(|known| known.live.as_ref()) {
                    *ramp = live.clone();
                }
            }
        }
    }
}

impl Known {
    fn read(name: &str, folders: &PictureFolders) -> Self {
        let picture = assets::place_of(name, folders);
        // Before they are read: written in between, they are found to have changed.
        let stamps = stamps(&picture);
        let source = if builtin::find(builtin::RAMPS, name).is_some() {
            Source::BuiltIn
        } else {
            match (assets::ramp(&picture), assets::ramp_recipe(&recipe_of(&picture))) {
                (Err(_), _) => Source::Missing,
                (Ok(ramp), Ok(recipe)) if makes(&recipe, &ramp) => Source::Recipe(recipe),
                _ => Source::Painted,
            }
        };
        let written = if let Source::Recipe(recipe) = &source { Some(recipe.clone()) } else { None };
        Self { picture, stamps, source, written, live: None, is_stale: false }
    }

    /// Another recipe makes it than the one that was written last.
    fn is_to_be_written(&self, changed: Option<&RampRecipe>) -> bool {
        let Source::Recipe(recipe) = &self.source else { return false };
        self.written.as_ref() != Some(changed.unwrap_or(recipe))
    }
}

fn makes(recipe: &RampRecipe, ramp: &Ramp) -> bool {
    recipe.bake().is_ok_and(|picture| Ramp::from_picture(&picture) == *ramp)
}

/// `mine.ramp.json` of `mine.png`.
fn recipe_of(picture: &Path) -> PathBuf {
    picture.with_extension("ramp.json")
}

fn stamps(picture: &Path) -> [Option<Stamp>; 2] {
    [picture, &recipe_of(picture)].map(Stamp::of)
}

/// The recipe first: of the two the picture can be made again.
fn write(picture: &Path, recipe: &RampRecipe, baked: &image::DynamicImage) -> Result<(), Error> {
    files::write(&recipe_of(picture), recipe.to_text().as_bytes())?;
    write_png(picture, baked, Effort::Small)
}

/// Writes a copy of a built-in ramp beside a preset, under a name that is free, and gives that.
fn copy_of(name: &str, preset: &Path) -> Result<String, Error> {
    let folder = preset.parent().unwrap_or(Path::new(""));
    let Some(builtin) = builtin::find(builtin::RAMPS, name) else { return Ok(name.into()) };
    let recipe = RampRecipe::parse(&builtin::path(name), builtin.recipe)?;
    let file = files::own_name(name, |file| {
        let picture = folder.join(file);
        !files::exists(&picture) && !files::exists(&recipe_of(&picture))
    });
    write(&folder.join(&file), &recipe, &recipe.bake()?)?;
    Ok(file)
}

#[cfg(test)]
mod tests;
