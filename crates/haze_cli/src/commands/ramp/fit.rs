//! `haze ramp fit`: fits ramps to path-traced smoke.

use std::path::PathBuf;

use clap::Args;
use haze_author::ramp::RampRecipe;
use haze_author::ramp::response::{DiffuseRamps, FitShape, FittedRamps, Puff};
use haze_core::assets::ramp::Ramp;
use haze_core::error::Error;
use haze_export::options::whole_number;
use haze_export::output::{FileChecks, print_line};
use haze_export::puff_sheet::{ComparedImages, comparison_sheet};
use haze_export::recipe_files::image_path;
use haze_export::sprite_by_name::sprite_recipe;
use haze_preset::{CompressionEffort, builtin, write_baked_png, write_png};

use super::ramp_io::{check_recipe_output, write_recipe};
use crate::bake_job::{PaintedPng, check_not_painted};
use crate::medium_options::PuffArguments;
use crate::puff_error::print_ramp_error;

#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    puff: PuffArguments,
    /// Stops per row.
    #[arg(long, default_value_t = FitShape::default().stops, allow_hyphen_values = true)]
    #[arg(value_parser = whole_number(2..=64))]
    stops: u32,
    /// Rows along the amount axis; 1 for a ramp of one axis.
    #[arg(long, default_value_t = FitShape::default().rows, allow_hyphen_values = true)]
    #[arg(value_parser = whole_number(1..=16))]
    rows: u32,
    /// Recipe to write, with its PNG beside it: the ramp for light from all sides, or with --backlight only from the
    /// viewer's side.
    #[arg(short, long, value_name = "NAME.ramp.json")]
    output: PathBuf,
    /// Recipe to write of the ramp for light from behind, `backlight_ramp`.
    #[arg(long, value_name = "NAME.ramp.json")]
    backlight: Option<PathBuf>,
    /// Image to write of the puff: path-traced, with the ramps, and the difference.
    #[arg(long, value_name = "FILE.png")]
    sheet: Option<PathBuf>,
}

pub fn run(arguments: &Arguments) -> Result<(), Error> {
    let Arguments { puff: PuffArguments { medium, sprite, quality }, stops, rows, output, backlight, sheet } =
        arguments;
    let mut files = FileChecks::for_inputs([sprite]);
    for recipe in [Some(output), backlight.as_ref()].into_iter().flatten() {
        check_recipe_output(&mut files, recipe)?;
        files.check_output("--output", &image_path(recipe), "png")?;
        check_not_painted(&image_path(recipe), PaintedPng::Keep)?;
    }
    if let Some(sheet) = sheet {
        files.check_output("--sheet", sheet, "png")?;
    }
    let recipe = sprite_recipe(sprite)?;
    let of = medium.medium()?;
    let path_trace = quality.path_trace();
    let puff = quality.with_progress(medium.name(), |progress| Puff::trace(&recipe, &of, &path_trace, progress))?;
    let fitted = puff.fit(FitShape { stops: *stops, rows: *rows, backlight: backlight.is_some() });
    let FittedRamps { diffuse, backlight: against, exposure } = &fitted;
    let write = |path: &PathBuf, recipe: &RampRecipe| {
        let baked = recipe.bake()?;
        write_recipe(path, recipe)?;
        write_baked_png(&image_path(path), &baked)?;
        Ok::<_, Error>(Ramp::from_image(&baked))
    };
    let diffuse = write(output, diffuse)?;
    let against = backlight.as_ref().zip(against.as_ref()).map(|(path, recipe)| write(path, recipe)).transpose()?;
    let ramps = DiffuseRamps { diffuse: &diffuse, backlight: against.as_ref() };
    let after = puff.response(ramps);
    if let Some(sheet) = sheet {
        let shown = ComparedImages { light: &|light| puff.shown(ramps, light), exposure: after.exposure };
        write_png(sheet, &comparison_sheet(&puff, "ramps", &shown).into(), CompressionEffort::Small)?;
    }
    if let Some(usual) = builtin::find(builtin::RAMPS, "diffuse_soft") {
        let usual = usual.ramp()?;
        let ramps = DiffuseRamps { diffuse: &usual, backlight: None };
        print_ramp_error("diffuse_soft", &puff, ramps)?;
    }
    print_ramp_error("fitted", &puff, ramps)?;
    print_line!(
        "{}: diffuse.intensity {exposure:.2} matches the brightness of {} relative to a white wall",
        output.display(),
        medium.name()
    )
}
