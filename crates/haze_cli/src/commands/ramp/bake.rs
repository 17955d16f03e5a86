//! `haze ramp bake`: bakes ramp and motif recipes to PNGs.

use std::path::PathBuf;

use clap::Args;
use haze_export::output::Failures;

use crate::bake_job::{OverwriteArguments, RAMPS, bake_all};

#[derive(Args)]
pub struct Arguments {
    /// `*.ramp.json` and `*.motif.json` files.
    #[arg(required = true)]
    recipes: Vec<PathBuf>,
    #[command(flatten)]
    overwrite: OverwriteArguments,
}

pub fn run(arguments: &Arguments) -> Result<(), Failures> {
    bake_all(&arguments.recipes, &RAMPS, arguments.overwrite.painted_png())
}
