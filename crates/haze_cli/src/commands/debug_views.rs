//! `haze debug-views`: renders every stage of the shading on one sheet, as OTEE's slide "Shade tree" does.

use clap::Args;
use haze_core::error::Error;
use pollster::block_on;

use haze_export::debug_view_sheet::{COLUMNS, stages};
use haze_export::image_export::{ExportProgress, render_sheet};
use haze_export::options::ShotArguments;

#[derive(Args)]
#[command(mut_arg("size", |size| size.help("Size in pixels of a sheet of 4x4 images, without margins")))]
pub struct Arguments {
    #[command(flatten)]
    shot: ShotArguments,
}

pub fn run(arguments: &Arguments) -> Result<(), Error> {
    let mut shot = arguments.shot.load(&[])?;
    // The sheet then costs about as much as one image.
    shot.size = (arguments.shot.run.size / COLUMNS).max(glam::UVec2::ONE);
    let backend = arguments.shot.run.backend()?;
    let sheet =
        block_on(render_sheet(&backend, &stages(&shot), COLUMNS, &arguments.shot.output, &ExportProgress::terminal()))?;
    arguments.shot.write(sheet.image, &shot, &backend)
}
