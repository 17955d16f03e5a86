//! Ramps of a preset that have recipes beside them: shown live during an edit, written when the step is complete.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use egui_gradient::GradientEditor;
use haze::MaterialAssets;
use haze_author::ramp::RampRecipe;
use haze_author::ramp::fit_stops::fit_image;
use haze_author::ramp::lint::{BANDING, lint_ramp};
use haze_core::assets::ramp::Ramp;
use haze_core::error::{Error, builtin_path};
use haze_core::settings::{FieldValue, field_values, set_field};
use haze_preset::{AssetFolders, MaterialSources, Preset, builtin};

use super::Document;
use crate::platform::file_io::{Stamp, read_color_png, write_baked_png};
use crate::platform::{asset_loading, file_io};

/// Ramps that panels have asked about, by their names in the preset.
#[derive(Default)]
pub struct RampEdits {
    /// Path of the preset that they belong to.
    preset: PathBuf,
    known: BTreeMap<String, EditedRamp>,
    /// Editor of each field, and the row of the ramp that it shows.
    editors: BTreeMap<&'static str, (GradientEditor, usize)>,
    /// Ramp that is to be copied beside the preset: index of the system, and field.
    wanted: Option<(usize, &'static str)>,
    /// The preset must first be saved to a file.
    pub needs_saved_preset: bool,
    /// Ramp whose image another program has replaced, so that its stops can no longer be edited. For a message.
    pub replaced: Option<String>,
}

/// Origin of a ramp, which decides whether it can be edited.
#[derive(Clone, Debug, PartialEq)]
pub enum RampOrigin {
    /// Embedded in the program.
    BuiltIn,
    /// Made from a recipe, whose stops can be edited.
    Recipe(RampRecipe),
    /// Painted: there is no recipe beside it that produces the image.
    Painted {
        /// A recipe is beside it and makes another image: another program has changed one of the two.
        has_recipe: bool,
        /// The gradient has visible steps.
        has_bands: bool,
    },
    /// Unreadable. The reason is reported elsewhere.
    Missing,
}

struct EditedRamp {
    image: PathBuf,
    /// Stamps of the image and of the recipe when they were last read or written.
    stamps: [Option<Stamp>; 2],
    source: RampOrigin,
    /// Recipe that the image on disk was baked from.
    written: Option<RampRecipe>,
    /// Recipe and ramp that are shown now.
    live: Option<(RampRecipe, Ramp)>,
    /// A file was written, so the stamps must be compared.
    is_stale: bool,
}

impl RampEdits {
    /// Marks all ramps, so that changed files are read again.
    pub fn mark_stale(&mut self) {
        self.known.values_mut().for_each(|known| known.is_stale = true);
    }

    /// Returns the origin of a ramp.
    pub fn source(&mut self, name: &str, folders: &AssetFolders) -> &RampOrigin {
        let known = self.known.entry(name.into()).or_insert_with(|| EditedRamp::read(name, folders));
        &known.source
    }

    /// Returns the editor of a field, and its row.
    pub fn editor(&mut self, field: &'static str) -> &mut (GradientEditor, usize) {
        self.editors.entry(field).or_default()
    }

    /// Returns true while an edit is in progress in one of the editors.
    pub fn is_editing(&self) -> bool {
        self.editors.values().any(|(editor, _)| editor.is_editing())
    }

    /// Returns true if pasted text goes to one of the editors.
    pub fn takes_paste(&self) -> bool {
        self.editors.values().any(|(editor, _)| editor.takes_paste())
    }

    /// Requests a copy of a built-in ramp. A built-in preset must be saved first.
    pub fn request_copy(&mut self, system: usize, field: &'static str, is_built_in: bool) {
        self.wanted = Some((system, field));
        self.needs_saved_preset = is_built_in;
    }

    /// Forgets the requested copy.
    pub fn cancel_copy(&mut self) {
        self.wanted = None;
    }

    /// Writes the requested copy and names it in the preset, as soon as the preset is a file.
    pub fn write_requested_copy(&mut self, document: &mut Document) -> Result<(), Error> {
        let Some((system, field)) = self.wanted.filter(|_| !document.is_built_in()) else { return Ok(()) };
        self.wanted = None;
        let Some(name) = ramp_name(&document.preset, system, field) else { return Ok(()) };
        let copy = copy_of(&name, document.path())?;
        set_field(&mut document.preset, &format!("systems[{system}].material.{field}"), &copy)?;
        Ok(())
    }

    /// Fits a recipe to a painted ramp. Returns the number of stops and the largest error of the fit in 1/255.
    pub fn fit(&mut self, name: &str) -> Result<(usize, f32), Error> {
        let Some(known) = self.known.get_mut(name) else { return Ok((0, 0.0)) };
        let fitted = fit_image(&read_color_png(&known.image)?, None)?;
        let count = fitted.recipe.rows.iter().map(|row| row.stops.len()).sum();
        // The image stays as it was painted until a stop is changed.
        known.written = Some(fitted.recipe.clone());
        known.source = RampOrigin::Recipe(fitted.recipe);
        Ok((count, fitted.error))
    }

    /// Fits a recipe to a painted ramp as [`fit`](Self::fit) does, and replaces the image by the smooth one that the recipe
    /// makes.
    pub fn import_and_bake(&mut self, name: &str) -> Result<(usize, f32), Error> {
        let fitted = self.fit(name)?;
        // `advance` writes it.
        if let Some(known) = self.known.get_mut(name) {
            known.written = None;
        }
        Ok(fitted)
    }

    /// Bakes recipes that have changed, and writes them unless a control is held. Call once a frame, after the panels.
    pub fn advance(&mut self, document: &mut Document, folders: &AssetFolders, is_held: bool) -> Result<(), Error> {
        if self.preset != document.path() {
            self.known.clear();
            self.preset = document.path().into();
        }
        for (name, known) in &mut self.known {
            if !is_held && (known.is_stale || known.is_to_be_written(document.recipes.ramps.get(name))) {
                known.is_stale = false;
                if known.stamps != stamps(&known.image) {
                    // A change by another program takes precedence.
                    let was_recipe = matches!(known.source, RampOrigin::Recipe(_));
                    *known = EditedRamp::read(name, folders);
                    document.recipes.ramps.forget(name);
                    if was_recipe && matches!(known.source, RampOrigin::Painted { .. }) {
                        self.replaced = Some(name.clone());
                    }
                }
            }
            let RampOrigin::Recipe(recipe) = &known.source else { continue };
            let recipe = document.recipes.ramps.get(name).unwrap_or(recipe);
            let has_live = known.live.as_ref().is_some_and(|(live, _)| live == recipe);
            if known.written.as_ref() == Some(recipe) && (known.live.is_none() || has_live) {
                continue;
            }
            let image = recipe.bake()?;
            if !has_live {
                known.live = Some((recipe.clone(), Ramp::from_image(&image)));
            }
            if !is_held && known.written.as_ref() != Some(recipe) {
                // A write error is reported once; the next step tries again.
                known.written = Some(recipe.clone());
                let done = write(&known.image, recipe, &image);
                known.stamps = stamps(&known.image);
                done?;
            }
        }
        Ok(())
    }

    /// Replaces loaded ramps by their edited versions.
    pub fn apply(&self, preset: &Preset, materials: &mut [MaterialAssets]) {
        for (system, assets) in preset.systems.iter().zip(materials) {
            for (_, name, ramp) in ramp_slots(&system.material, assets) {
                if let Some((_, live)) = self.known.get(name).and_then(|known| known.live.as_ref()) {
                    *ramp = live.clone();
                }
            }
        }
    }
}

impl EditedRamp {
    fn read(name: &str, folders: &AssetFolders) -> Self {
        let image = asset_loading::image_path(name, folders);
        // Stamps are taken before the files are read, so that a write in between counts as a change.
        let stamps = stamps(&image);
        let source = if builtin::find(builtin::RAMPS, name).is_some() {
            RampOrigin::BuiltIn
        } else {
            match (asset_loading::ramp(&image), asset_loading::ramp_recipe(&recipe_of(&image))) {
                (Err(_), _) => RampOrigin::Missing,
                (Ok(ramp), Ok(recipe)) if makes(&recipe, &ramp) => RampOrigin::Recipe(recipe),
                (Ok(_), recipe) => {
                    let findings = read_color_png(&image).map(|decoded| lint_ramp(&decoded, None)).unwrap_or_default();
                    let has_bands = findings.iter().any(|finding| finding.name == BANDING);
                    RampOrigin::Painted { has_recipe: recipe.is_ok(), has_bands }
                }
            }
        };
        let written = if let RampOrigin::Recipe(recipe) = &source { Some(recipe.clone()) } else { None };
        Self { image, stamps, source, written, live: None, is_stale: false }
    }

    /// Returns true if the current recipe differs from the one that was last written.
    fn is_to_be_written(&self, changed: Option<&RampRecipe>) -> bool {
        let RampOrigin::Recipe(recipe) = &self.source else { return false };
        self.written.as_ref() != Some(changed.unwrap_or(recipe))
    }
}

/// Field, name and image of a ramp.
pub type RampSlot<'a> = (&'static str, &'a String, &'a mut Ramp);

/// Returns the ramps of a material.
pub fn ramp_slots<'a>(names: &'a MaterialSources, assets: &'a mut MaterialAssets) -> [RampSlot<'a>; 9] {
    [
        ("diffuse_ramp", &names.diffuse_ramp, &mut assets.diffuse_ramp),
        ("backlight_ramp", &names.backlight_ramp, &mut assets.backlight_ramp),
        ("shadow_ramp", &names.shadow_ramp, &mut assets.shadow_ramp),
        ("soft_scatter_ramp", &names.soft_scatter_ramp, &mut assets.soft_scatter_ramp),
        ("specular_ramp", &names.specular_ramp, &mut assets.specular_ramp),
        ("coverage_ramp", &names.coverage_ramp, &mut assets.coverage_ramp),
        ("age_ramp", &names.age_ramp, &mut assets.age_ramp),
        ("heat_ramp", &names.heat_ramp, &mut assets.heat_ramp),
        ("fire_ramp", &names.fire_ramp, &mut assets.fire_ramp),
    ]
}

/// Name that a preset has for the ramp in a field of a system's material.
pub fn ramp_name(preset: &Preset, system: usize, field: &str) -> Option<String> {
    let path = format!("systems[{system}].material.{field}");
    match field_values(preset).into_iter().find(|(field, _)| *field == path) {
        Some((_, FieldValue::Text(name))) => Some(name),
        _ => None,
    }
}

fn makes(recipe: &RampRecipe, ramp: &Ramp) -> bool {
    recipe.bake().is_ok_and(|image| Ramp::from_image(&image) == *ramp)
}

/// Returns `mine.ramp.json` for `mine.png`.
fn recipe_of(image: &Path) -> PathBuf {
    image.with_extension("ramp.json")
}

fn stamps(image: &Path) -> [Option<Stamp>; 2] {
    [image, &recipe_of(image)].map(Stamp::of)
}

/// Writes the recipe first, because the image can be made again from it.
pub fn write(image: &Path, recipe: &RampRecipe, baked: &image::DynamicImage) -> Result<(), Error> {
    file_io::write(&recipe_of(image), recipe.to_json().as_bytes())?;
    Ok(write_baked_png(image, baked)?)
}

/// Writes a copy of a built-in ramp beside a preset under a free name, and returns the name.
fn copy_of(name: &str, preset: &Path) -> Result<String, Error> {
    let folder = preset.parent().unwrap_or(Path::new(""));
    let Some(builtin) = builtin::find(builtin::RAMPS, name) else { return Ok(name.into()) };
    let recipe = RampRecipe::parse(&builtin_path(name), builtin.recipe)?;
    let file = file_io::free_copy_name(name, |file| {
        let image = folder.join(file);
        !file_io::is_taken(&image) && !file_io::is_taken(&recipe_of(&image))
    });
    write(&folder.join(&file), &recipe, &recipe.bake()?)?;
    Ok(file)
}

#[cfg(test)]
mod tests;
