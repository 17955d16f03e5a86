//! `haze ramp import`: converts a PNG, or another program's gradient, to a recipe.

use std::path::PathBuf;

use clap::Args;
use haze_author::ramp::fit_stops::MAX_ERROR_RANGE;
use haze_author::ramp::import_gradient::{ImportedGradient, import_gradient};
use haze_core::error::Error;
use haze_export::options::number;
use haze_export::output::{FileChecks, print_error, print_line};
use haze_export::progress::with_progress;

use super::ramp_io::{check_recipe_output, write_recipe};

#[derive(Args)]
pub struct Arguments {
    /// A PNG, or a gradient: of GIMP (.ggr), Photoshop (.grd), Godot (.tres), Blender (.txt, as text), SVG, CSS or GMT (.cpt), or
    /// a palette (.gpl, .pal).
    file: PathBuf,
    /// Recipe to write.
    #[arg(short, long, value_name = "NAME.ramp.json")]
    output: PathBuf,
    /// Greatest error of a channel, in steps of 1/255, at least 1. A larger error gives fewer stops. Default: 1.5, and more for a
    /// PNG whose paint is noisy; rows that differ only by noise then become one row.
    #[arg(long, value_name = "STEPS", allow_hyphen_values = true, value_parser = number(MAX_ERROR_RANGE))]
    error: Option<f32>,
    /// Gradient to read of a file with several: its id in SVG, that of its sub-resource in Godot, its name in Photoshop. Without,
    /// the first.
    #[arg(long, value_name = "ID")]
    gradient: Option<String>,
}

pub fn run(Arguments { file, output, error, gradient }: &Arguments) -> Result<(), Error> {
    check_recipe_output(&mut FileChecks::for_inputs([file]), output)?;
    let ImportedGradient { fit: fitted, note } = with_progress(format!("haze: fitting {}", file.display()), || {
        import_gradient(file, *error, gradient.as_deref())
    })?;
    if let Some(note) = note {
        print_error(note);
    }
    write_recipe(output, &fitted.recipe)?;
    let rows = fitted.recipe.rows.len();
    let stops: usize = fitted.recipe.rows.iter().map(|row| row.stops.len()).sum();
    let rows = if rows > 1 { format!(" in {rows} rows") } else { String::new() };
    print_line!("{}: {stops} stops{rows}, at most {:.1}/255 off", output.display(), fitted.error)
}
