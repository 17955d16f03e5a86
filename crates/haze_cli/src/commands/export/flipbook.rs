//! `haze export flipbook`: sheets of color, normals, motion vectors, fire and six-way light, for an engine.

use std::ops::RangeInclusive;

use clap::Args;
use glam::UVec2;
use haze_core::error::Error;
use pollster::block_on;

use haze_export::engine::Engine;
use haze_export::flipbook_export::{FILES, FlipbookExport, FlipbookOptions};
use haze_export::frame_range::{parse_frames, parse_rate, parse_sheet};
use haze_export::image_export::{ExportProgress, Frames};
use haze_export::image_format::{Alpha, Emission, ImageFormat};
use haze_export::options::{ShotArguments, whole_number};
use haze_export::output::{OutputFolder, check_folder, print_error, print_line};

#[derive(Args)]
#[command(
    mut_arg("size", |size| size.help("Size of a frame in pixels").default_value("256x256")),
    mut_arg("output", |output| output.help("Folder to write into; it is made if it does not exist").value_name("FOLDER")),
)]
pub struct Arguments {
    #[command(flatten)]
    shot: ShotArguments,
    /// Engine to write for.
    #[arg(long, value_enum)]
    engine: Engine,
    /// Frames A to B, both included. Frame 0 is at the preset's time, or at --time.
    #[arg(long, value_name = "A..B", value_parser = parse_frames, allow_hyphen_values = true)]
    frames: RangeInclusive<u32>,
    /// Frames per second.
    #[arg(long, value_name = "N", value_parser = parse_rate, allow_hyphen_values = true, default_value = "24")]
    rate: f32,
    /// Rows and columns of the sheets.
    #[arg(long, value_name = "RxC", value_parser = parse_sheet, allow_hyphen_values = true)]
    sheet: UVec2,
    /// Color of color.png: the smoke's own, or multiplied by alpha. Default: premultiplied if it contains fire, because straight
    /// color has no glow where alpha is low; straight otherwise.
    #[arg(long, value_enum)]
    alpha: Option<Alpha>,
    /// Light of fire: part of color.png, or in emission.png alone, to be added.
    #[arg(long, value_enum, default_value_t)]
    emission: Emission,
    /// Fade as many frames after the last into the first ones, so that the flipbook loops.
    #[arg(long = "loop", value_name = "N", value_parser = whole_number(0..=1000), allow_hyphen_values = true, default_value = "0")]
    loop_fade: u32,
    /// Add two maps of the smoke's light from six sides.
    #[arg(long)]
    six_way: bool,
    /// Widen the camera's field of view until it holds the smoke of all frames.
    #[arg(long)]
    fit: bool,
}

pub fn run(arguments: &Arguments) -> Result<(), Error> {
    let folder = &arguments.shot.output;
    check_folder("--output", folder)?;
    let mut shot = arguments.shot.load_outputs(&[])?;
    let frames = Frames { range: arguments.frames.clone(), rate: arguments.rate, format: ImageFormat::default() };
    let options = FlipbookOptions {
        engine: arguments.engine,
        cells: arguments.sheet,
        alpha: arguments.alpha,
        emission: arguments.emission,
        loop_fade: arguments.loop_fade,
        has_six_way: arguments.six_way,
        effort: arguments.shot.effort(),
    };
    options.check(&shot, &frames)?;
    let backend = arguments.shot.run.backend()?;
    let progress = ExportProgress::terminal();
    if arguments.fit {
        block_on(options.fit(&backend, &mut shot, &frames, &progress))?;
    }
    // The folder is made when all else is known to be right.
    let _made = OutputFolder::make("--output", folder)?;
    let outputs = FILES.map(|name| ("--output", folder.join(name), name.rsplit('.').next().unwrap_or_default()));
    arguments.shot.check_outputs(&shot, &outputs)?;
    let export = block_on(FlipbookExport::render(&backend, &shot, &frames, options, &progress, folder))?;
    export.write(folder)?;
    if let Some(cut_smoke) = &export.cut_smoke {
        print_error(cut_smoke);
    }
    export.files().try_for_each(|name| print_line!("{}", folder.join(name).display()))
}
