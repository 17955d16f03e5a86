//! `haze sprite light`: path-traces a sprite of a medium under lights from all sides.

use std::path::{Path, PathBuf};

use clap::Args;
use haze_author::path_trace::PathTrace;
use haze_author::ramp::response::{LIGHTS, Puff, light_angle};
use haze_author::sprite::bake::SpriteRecipe;
use haze_core::error::Error;
use haze_core::formula::color::luminance;
use haze_export::output::{FileChecks, print_line};
use haze_export::puff_sheet::{ComparedImages, comparison_sheet, traced_sheet};
use haze_export::sprite_by_name::{default_sprite, sprite_recipe};
use haze_preset::{CompressionEffort, write_file, write_png};

use crate::medium_options::{MediumArguments, PathTraceArguments};
use crate::puff_error::print_response_error;

#[derive(Args)]
pub struct Arguments {
    /// A `*.sprite.json` file, or the name of a built-in sprite.
    #[arg(default_value_os_t = default_sprite())]
    sprite: PathBuf,
    #[command(flatten)]
    medium: MediumArguments,
    #[command(flatten)]
    quality: PathTraceArguments,
    /// PNG to write: the puff under nine lights, from the viewer's side to straight behind it.
    #[arg(short, long, value_name = "FILE.png")]
    output: PathBuf,
    /// Also write the densities, as a grid that Mitsuba 3 reads.
    #[arg(long, value_name = "FILE.vol")]
    volume: Option<PathBuf>,
    /// Bake six-way maps as `haze sprite bake --six-way` does, add their images and the differences to the sheet, and
    /// print their errors.
    #[arg(long)]
    six_way: bool,
}

pub fn run(Arguments { sprite, medium, quality, output, volume, six_way }: &Arguments) -> Result<(), Error> {
    let mut files = FileChecks::for_inputs([sprite]);
    files.check_output("--output", output, "png")?;
    if let Some(volume) = volume {
        files.check_output("--volume", volume, "vol")?;
    }
    let recipe = sprite_recipe(sprite)?;
    let of = medium.medium()?;
    let path_trace = quality.path_trace();
    let puff = quality.with_progress(medium.name(), |progress| Puff::trace(&recipe, &of, &path_trace, progress))?;
    if let Some(path) = volume {
        let recipe = SpriteRecipe { size: path_trace.size, ..recipe };
        write_file(path, &recipe.volume(0.0).to_mitsuba())?;
    }
    if *six_way {
        return compare_six_way(&puff, &recipe, medium, quality, output);
    }
    write_png(output, &traced_sheet(&puff).into(), CompressionEffort::Small)?;
    print_line!(
        "{}: {} under {LIGHTS} lights; brightness by angle in degrees, 1 is a white wall:",
        output.display(),
        medium.name()
    )?;
    for light in 0..LIGHTS as usize {
        print_line!("{:6.1} {:.6}", light_angle(light), luminance(puff.traced().mean(light)))?;
    }
    Ok(())
}

fn compare_six_way(
    puff: &Puff,
    recipe: &SpriteRecipe,
    medium: &MediumArguments,
    quality: &PathTraceArguments,
    output: &Path,
) -> Result<(), Error> {
    let PathTrace { size, samples, .. } = quality.path_trace();
    let recipe = SpriteRecipe { size, columns: 1, rows: 1, tolerance: 0, ..recipe.clone() };
    let of = medium.medium()?;
    let what = format!("six-way {}", medium.name());
    let maps = quality.with_progress(&what, |progress| recipe.bake_six_way(&of, samples, |_, path| progress(path)))?;
    let light = |light| puff.shown_six_way(&maps, light);
    let response = puff.compare_images(light);
    let shown = ComparedImages { light: &light, exposure: response.exposure };
    write_png(output, &comparison_sheet(puff, "six-way", &shown).into(), CompressionEffort::Small)?;
    print_response_error(
        &format!("{}: six-way maps against {}", output.display(), medium.name()),
        puff,
        &shown,
        &response,
    )
}
