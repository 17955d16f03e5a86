//! `haze sprite bake`: bakes sprite and noise recipes to PNGs, with `--six-way` also to six-way maps.

use std::path::PathBuf;

use clap::Args;

use super::six_way::SixWayArguments;
use crate::bake_job::{SPRITES, bake_all};
use crate::output::Failures;

#[derive(Args)]
pub struct Arguments {
    /// `*.sprite.json` and `*.noise.json` files; with --six-way also names of built-in sprites.
    #[arg(required = true)]
    recipes: Vec<PathBuf>,
    #[command(flatten)]
    six_way: SixWayArguments,
}

pub fn run(Arguments { recipes, six_way }: &Arguments) -> Result<(), Failures> {
    six_way.check(recipes)?;
    bake_all(&six_way.recipe_files(recipes), &SPRITES)?;
    six_way.bake_all(recipes).map_err(Failures::from)
}
