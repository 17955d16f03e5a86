//! `haze sprite bake`: bakes sprite and noise recipes to PNGs, with `--six-way` also to six-way maps.

use std::path::PathBuf;

use clap::Args;
use haze_export::output::Failures;

use super::six_way::SixWayArguments;
use crate::bake_job::{OverwriteArguments, SPRITES, bake_all};

#[derive(Args)]
pub struct Arguments {
    /// `*.sprite.json` and `*.noise.json` files; with --six-way also names of built-in sprites.
    #[arg(required = true)]
    recipes: Vec<PathBuf>,
    #[command(flatten)]
    six_way: SixWayArguments,
    #[command(flatten)]
    overwrite: OverwriteArguments,
}

pub fn run(Arguments { recipes, six_way, overwrite }: &Arguments) -> Result<(), Failures> {
    let painted = overwrite.painted_png();
    six_way.check(recipes, painted)?;
    bake_all(&six_way.recipe_files(recipes), &SPRITES, painted)?;
    six_way.bake_all(recipes).map_err(Failures::from)
}
