//! `haze sprite light`: a sprite as smoke of a medium truly looks, from every side.

use std::path::PathBuf;

use clap::Args;
use haze::Error;
use haze::formula::colour::luminance;
use haze::picture::{Effort, write_file, write_png};
use haze::ramp::response::{LIGHTS, Puff, angle};
use haze::sprite::bake::SpriteRecipe;

use crate::app::medium::{MediumArguments, PathTraceArguments, sprite_recipe, usual_sprite};
use crate::app::output::{Files, say};
use crate::app::puffs::traced;

#[derive(Args)]
pub struct Arguments {
    /// A `*.sprite.json` file, or a built-in sprite.
    #[arg(default_value_os_t = usual_sprite())]
    sprite: PathBuf,
    #[command(flatten)]
    medium: MediumArguments,
    #[command(flatten)]
    quality: PathTraceArguments,
    /// The picture to write: the puff under nine lights, from the viewer's side to straight behind it.
    #[arg(short, long, value_name = "FILE.png")]
    output: PathBuf,
    /// Write the densities, too: a grid that Mitsuba 3 reads.
    #[arg(long, value_name = "FILE.vol")]
    volume: Option<PathBuf>,
}

pub fn run(Arguments { sprite, medium, quality, output, volume }: &Arguments) -> Result<(), Error> {
    let mut files = Files::read([sprite]);
    files.write("--output", output, "png")?;
    if let Some(volume) = volume {
        files.write("--volume", volume, "vol")?;
    }
    let (recipe, of, path_trace) = (sprite_recipe(sprite)?, medium.medium()?, quality.path_trace());
    let puff = quality.watched(medium.name(), |progress| Puff::trace(&recipe, &of, &path_trace, progress))?;
    if let Some(path) = volume {
        let recipe = SpriteRecipe { size: path_trace.size, ..recipe };
        write_file(path, &recipe.volume(0.0).to_mitsuba())?;
    }
    write_png(output, &traced(&puff).into(), Effort::Small)?;
    say!("{}: {} under {LIGHTS} lights; brightness, 1 is a white wall:", output.display(), medium.name())?;
    for light in 0..LIGHTS as usize {
        say!("{:6.1} {:.6}", angle(light), luminance(puff.traced().mean(light)))?;
    }
    Ok(())
}
