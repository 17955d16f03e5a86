//! `haze sheet`: renders one shot with several values of a field, side by side.

use clap::Args;
use glam::UVec2;
use haze_author::preset::no_effect_reason_of_set;
use haze_core::error::Error;
use pollster::block_on;

use haze_export::image_export::{ExportProgress, MAX_SHEET_CELLS, column_count, render_sheet};
use haze_export::options::{ShotArguments, VariedShot, parse_assignment};
use haze_export::output::print_error;

#[derive(Args)]
#[command(mut_arg("size", |size| size.help("Size of all images together in pixels, without margins; each image is this size divided by the number of columns")))]
pub struct Arguments {
    #[command(flatten)]
    shot: ShotArguments,
    /// Field, named by its path or the end of it, and its values: `accumulate.downscale=1,2,4`. Values of three numbers are
    /// separated by semicolons: `lights[0].color=1,0,0;0,1,0`.
    #[arg(long, value_name = "FIELD=A,B,C", value_parser = parse_variation)]
    vary: (String, Vec<String>),
}

fn parse_variation(text: &str) -> Result<(String, Vec<String>), String> {
    let (field, values) = parse_assignment(text)?;
    let separator = if values.contains(';') { ';' } else { ',' };
    let values: Vec<_> = values.split(separator).map(|value| value.trim().to_owned()).collect();
    if values.len() > MAX_SHEET_CELLS {
        return Err(format!("{} values are too many; expected at most {MAX_SHEET_CELLS}", values.len()));
    }
    Ok((field, values))
}

pub fn run(arguments: &Arguments) -> Result<(), Error> {
    let (field, values) = &arguments.vary;
    let base = arguments.shot.load(&[])?;
    let columns = column_count(values.len());
    let size = (arguments.shot.run.size / columns).max(UVec2::ONE);
    let mut name = String::new();
    let mut cells = Vec::new();
    let mut reasons = Vec::new();
    for value in values {
        let VariedShot { mut shot, name: varied } = arguments.shot.varied_shot("--vary", field, value)?;
        arguments.shot.check_outputs(&shot, &[("--output", arguments.shot.output.clone(), "png")])?;
        reasons.push(no_effect_reason_of_set(&shot.preset, field, &varied, size));
        name = varied;
        shot.size = size;
        cells.push((value.clone(), shot));
    }
    if let Some(&[Some(reason), ..]) = reasons.iter().all(Option::is_some).then_some(&reasons[..]) {
        print_error(format_args!("--vary {field} has no effect: {reason}"));
    }
    let backend = arguments.shot.run.backend()?;
    let mut sheet =
        block_on(render_sheet(&backend, &cells, columns, &arguments.shot.output, &ExportProgress::terminal()))?;
    sheet.add_footer(&format!("{name}; {}, {}x{}, {}", base.preset.name, size.x, size.y, backend.description()));
    arguments.shot.write(sheet.image, &base, &backend)
}
