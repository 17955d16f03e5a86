//! `haze ramp export`: writes the gradient of a recipe for other programs.

use std::path::PathBuf;

use clap::Args;
use haze_author::ramp::RampRecipe;
use haze_author::ramp::export_gradient::export_gradient;
use haze_core::error::Error;
use haze_export::output::{FileChecks, print_line};
use haze_preset::write_file;

#[derive(Args)]
pub struct Arguments {
    /// Recipe of a ramp of one row.
    recipe: PathBuf,
    /// Gradient to write: .svg, .css or .ggr (GIMP).
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
}

pub fn run(Arguments { recipe, output }: &Arguments) -> Result<(), Error> {
    let loaded = RampRecipe::load(recipe)?;
    let text = export_gradient(&loaded, output)?;
    let ending = output.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    FileChecks::for_inputs([recipe]).check_output("--output", output, ending)?;
    write_file(output, text.as_bytes())?;
    print_line!("{}", output.display())
}
