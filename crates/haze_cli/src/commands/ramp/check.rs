//! `haze ramp check`: reports visible flaws of ramps.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use clap::Args;
use haze_author::finding::Finding;
use haze_author::ramp::lint::{BANDING, lint_ramp};
use haze_author::ramp::response::{DiffuseRamps, Puff};
use haze_core::assets::image::color_conversion_notes;
use haze_core::assets::ramp::{Ramp, RampRole};
use haze_core::error::{AssetError, Error};
use haze_export::file_kind::explain_wrong_kind;
use haze_export::options::choices;
use haze_export::output::{Failures, one_line};
use haze_export::recipe_files::has_extension;
use haze_export::sprite_by_name::{default_sprite, sprite_recipe};

use super::ramp_io::{load_ramp_image, refuse_gradient};
use crate::findings::report_findings;
use crate::medium_options::{PathTraceArguments, medium_by_name, medium_names};
use crate::puff_error::print_ramp_error;

#[derive(Args)]
pub struct Arguments {
    /// PNGs and `*.ramp.json` files to check.
    #[arg(required = true)]
    ramps: Vec<PathBuf>,
    /// Role of the ramps. Default: the beginning of each file name.
    #[arg(long = "as", value_name = "ROLE", value_parser = choices::<RampRole>())]
    role: Option<RampRole>,
    /// Also compare a diffuse ramp with path-traced smoke of this medium, light by light.
    #[arg(long, value_name = "MEDIUM", value_parser = medium_names())]
    truth: Option<String>,
    /// With --truth: the backlight ramp that belongs to the diffuse ramp.
    #[arg(long, value_name = "RAMP", requires = "truth")]
    backlight: Option<PathBuf>,
}

pub fn run(Arguments { ramps, role, truth, backlight }: &Arguments) -> Result<(), Failures> {
    if let Some(medium) = truth {
        print_truth_error(ramps, medium, backlight.as_deref())?;
    }
    report_findings(ramps, |path| findings(path, *role))
}

/// Prints how far ramps are from path-traced smoke.
fn print_truth_error(ramps: &[PathBuf], medium: &str, backlight: Option<&Path>) -> Result<(), Error> {
    let load = |path: &Path| Ok::<_, Error>(Ramp::from_image(&load_ramp_image(path)?.0));
    let ramps = ramps.iter().map(|path| Ok((path, load(path)?))).collect::<Result<Vec<_>, Error>>()?;
    let backlight = backlight.map(load).transpose()?;
    let recipe = sprite_recipe(&default_sprite())?;
    let quality = PathTraceArguments::default();
    let path_trace = quality.path_trace();
    let puff = quality
        .with_progress(medium, |progress| Puff::trace(&recipe, &medium_by_name(medium), &path_trace, progress))?;
    for (path, diffuse) in &ramps {
        let ramps = DiffuseRamps { diffuse, backlight: backlight.as_ref() };
        let name = format!("{} against {medium}", path.display());
        print_ramp_error(&name, &puff, ramps)?;
    }
    Ok(())
}

/// Returns the commands that replace a PNG of visible steps by a smooth one.
fn import_and_bake(path: &Path) -> String {
    let image = one_line(path.display());
    let recipe = path.with_extension("ramp.json");
    let recipe = one_line(recipe.display());
    format!("`haze ramp import {image} -o {recipe}`, then `haze ramp bake --overwrite {recipe}`")
}

fn findings(path: &Path, role: Option<RampRole>) -> Result<Vec<Finding>, Error> {
    let name = path.file_name().and_then(OsStr::to_str).unwrap_or_default();
    let role = role.or_else(|| RampRole::from_name(name));
    refuse_gradient(path)?;
    let mut findings = Vec::new();
    if !has_extension(path, "json") {
        let notes = color_conversion_notes(path)?;
        let found = |description| Finding { name: "color_space", description, is_warning: false };
        findings.extend(notes.into_iter().map(found));
    }
    match load_ramp_image(path) {
        Ok((image, recipe)) => {
            findings.extend(lint_ramp(&image, role));
            let cure = if recipe.is_some() { "set bits to 16 in the recipe".into() } else { import_and_bake(path) };
            let banding = findings.iter_mut().filter(|finding| finding.name == BANDING);
            banding.for_each(|finding| finding.description += &format!(": {cure}"));
        }
        // A color space that is refused has been noted already.
        Err(Error::Asset(AssetError::Image { .. })) if !findings.is_empty() => {}
        Err(error) => return Err(explain_wrong_kind(error, path, "ramp", "a PNG or a *.ramp.json file")),
    }
    Ok(findings)
}
