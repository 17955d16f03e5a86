//! `haze sprite export`: converts six-way maps for other tools.

use std::path::PathBuf;

use clap::Args;
use haze_author::sprite::six_way::{Packing, unpack};
use haze_core::assets::image::read_png;
use haze_core::error::Error;
use haze_preset::{CompressionEffort, write_png};

use haze_export::options::choices;
use haze_export::output::{FileChecks, print_line};

#[derive(Args)]
pub struct Arguments {
    /// Six-way maps: a `*.six_way.png` file.
    maps: PathBuf,
    /// Order of the sides in the two PNGs.
    #[arg(long = "to", value_name = "PACKING", value_parser = choices::<Packing>(), default_value = "unity")]
    packing: Packing,
    /// The two PNGs to write. They hold linear light, not sRGB.
    #[arg(short, long, num_args = 2, required = true, value_names = ["FIRST.png", "SECOND.png"])]
    output: Vec<PathBuf>,
}

pub fn run(Arguments { maps, packing, output }: &Arguments) -> Result<(), Error> {
    let mut files = FileChecks::for_inputs([maps]);
    output.iter().try_for_each(|path| files.check_output("--output", path, "png"))?;
    let sheets = unpack(maps, &read_png(maps)?.to_rgba8(), *packing)?;
    for (path, sheet) in output.iter().zip(sheets) {
        write_png(path, &sheet.into(), CompressionEffort::Small)?;
        print_line!("{}", path.display())?;
    }
    Ok(())
}
