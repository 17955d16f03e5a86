//! `haze ramp fit`: fits ramps to path-traced smoke.

use std::path::PathBuf;

use clap::Args;
use haze::image::{CompressionEffort, write_png};
use haze::ramp::Ramp;
use haze::{Error, builtin};
use haze_author::ramp::RampRecipe;
use haze_author::ramp::response::{DiffuseRamps, FitShape, FittedRamps, Puff, Response, light_angle};

use super::{check_output, write_recipe};
use crate::medium::{MediumArguments, PathTraceArguments, default_sprite, sprite_recipe};
use crate::output::{Files, say};
use crate::puffs::{Shown, compared, flip};
use crate::recipe::picture;

#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    medium: MediumArguments,
    /// Sprite that shapes the puff: a `*.sprite.json` file, or the name of a built-in sprite.
    #[arg(long, default_value_os_t = default_sprite())]
    sprite: PathBuf,
    #[command(flatten)]
    quality: PathTraceArguments,
    /// Stops per row.
    #[arg(long, value_parser = clap::value_parser!(u32).range(2..=64), default_value_t = FitShape::default().stops)]
    stops: u32,
    /// Rows along the amount axis; 1 for a ramp of one axis.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=16), default_value_t = FitShape::default().rows)]
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
    let Arguments { medium, sprite, quality, stops, rows, output, backlight, sheet } = arguments;
    let mut files = Files::read([sprite]);
    for recipe in [Some(output), backlight.as_ref()].into_iter().flatten() {
        check_output(&mut files, recipe)?;
        files.write("--output", &picture(recipe), "png")?;
    }
    if let Some(sheet) = sheet {
        files.write("--sheet", sheet, "png")?;
    }
    let (recipe, of, path_trace) = (sprite_recipe(sprite)?, medium.medium()?, quality.path_trace());
    let puff = quality.watched(medium.name(), |progress| Puff::trace(&recipe, &of, &path_trace, progress))?;
    let fitted = puff.fit(FitShape { stops: *stops, rows: *rows, backlight: backlight.is_some() });
    let FittedRamps { diffuse, backlight: against, exposure } = &fitted;
    let write = |path: &PathBuf, recipe: &RampRecipe| {
        let baked = recipe.bake()?;
        write_recipe(path, recipe)?;
        write_png(&picture(path), &baked, CompressionEffort::Small)?;
        Ok::<_, Error>(Ramp::from_image(&baked))
    };
    let diffuse = write(output, diffuse)?;
    let against = backlight.as_ref().zip(against.as_ref()).map(|(path, recipe)| write(path, recipe)).transpose()?;
    let ramps = DiffuseRamps { diffuse: &diffuse, backlight: against.as_ref() };
    let after = puff.response(ramps);
    if let Some(sheet) = sheet {
        let shown = Shown { light: &|light| puff.shown(ramps, light), exposure: after.exposure };
        write_png(sheet, &compared(&puff, "ramps", &shown).into(), CompressionEffort::Small)?;
    }
    if let Some(usual) = builtin::find(builtin::RAMPS, "diffuse_soft") {
        let usual = usual.ramp()?;
        let ramps = DiffuseRamps { diffuse: &usual, backlight: None };
        print_ramp_error("diffuse_soft", &puff, ramps)?;
    }
    print_ramp_error("fitted", &puff, ramps)?;
    say!(
        "{}: diffuse.intensity {exposure:.2} matches the brightness of {} relative to a white wall",
        output.display(),
        medium.name()
    )
}

/// Prints how far ramps are from path-traced smoke, in total and light by light.
pub fn print_ramp_error(name: &str, puff: &Puff, ramps: DiffuseRamps<'_>) -> Result<(), Error> {
    let response = puff.response(ramps);
    let shown = Shown { light: &|light| puff.shown(ramps, light), exposure: response.exposure };
    print_response_error(name, puff, &shown, &response)
}

/// Prints how far compared images are from path-traced smoke, in total and light by light.
pub fn print_response_error(name: &str, puff: &Puff, shown: &Shown<'_>, response: &Response) -> Result<(), Error> {
    let percent = |share: f32| 100.0 * share;
    say!(
        "{name}: brightness {:.1} % off on average, pixels {:.0} % off, FLIP {:.3}, at intensity {:.2}",
        percent(response.error),
        percent(response.pixel_error),
        flip(puff, shown),
        response.exposure,
    )?;
    for (index, light) in response.lights.iter().enumerate() {
        let off = percent(light.shown / light.truth.max(f32::MIN_POSITIVE) - 1.0);
        say!("{:7.1}°  traced {:.4}  shown {:.4}  {off:+.0} %", light_angle(index), light.truth, light.shown)?;
    }
    Ok(())
}
