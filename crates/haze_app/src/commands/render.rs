//! `haze render`: renders one image, one per frame of a range, a flipbook or a GIF.

use std::ops::RangeInclusive;

use clap::Args;
use glam::UVec2;
use haze::settings::DebugView;
use haze::{Error, FieldError};
use haze_demo::shot::Shot;
use haze_demo::tonemap_pass::tonemap;
use pollster::block_on;

use crate::frame_range::{FrameNames, parse_frames, parse_rate, parse_sheet};
use crate::image_export::{self, ExportProgress, Frames};
use crate::options::{ShotArguments, choices};
use crate::output::print_line;
use crate::recipe_files::has_extension;

#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    shot: ShotArguments,
    /// Stage of the shading to show.
    #[arg(long, default_value = "final", value_parser = choices::<DebugView>())]
    view: DebugView,
    /// Render frames A to B, both included: to one PNG per frame, with the frame number in its name as in `f_%04d.png`,
    /// or to one animated GIF, `f.gif`. Frame 0 is at the preset's time, or at --time.
    #[arg(long, value_name = "A..B", value_parser = parse_frames)]
    frames: Option<RangeInclusive<u32>>,
    /// Frames per second. Default: 60, or 25 for a GIF.
    #[arg(long, value_name = "N", value_parser = parse_rate, requires = "frames")]
    rate: Option<f32>,
    /// Put all frames on one sheet of R rows and C columns, a flipbook; --size is the size of a frame.
    #[arg(long, value_name = "RxC", value_parser = parse_sheet, requires = "frames")]
    sheet: Option<UVec2>,
}

pub fn run(arguments: &Arguments) -> Result<(), Error> {
    let is_gif = has_extension(&arguments.shot.output, "gif");
    let frames = arguments.frames.clone().map(|range| {
        let usual = if is_gif { 25.0 } else { 60.0 };
        Frames { range, rate: arguments.rate.unwrap_or(usual) }
    });
    match (&frames, arguments.sheet) {
        (Some(frames), None) if is_gif => gif(arguments, frames),
        (Some(frames), None) => sequence(arguments, frames),
        (Some(frames), Some(cells)) => flipbook(arguments, frames, cells),
        (None, _) => {
            let shot = Shot { debug_view: arguments.view, ..arguments.shot.load(&[])? };
            let backend = arguments.shot.run.backend()?;
            let picture = backend.render(&shot)?;
            arguments.shot.write(tonemap(&picture, &shot), &shot, &backend)
        }
    }
}

fn sequence(arguments: &Arguments, frames: &Frames) -> Result<(), Error> {
    let names = FrameNames::parse(&arguments.shot.output)?;
    let outputs: Vec<_> = frames.range.clone().map(|frame| ("--output", names.of(frame))).collect();
    let shot = Shot { debug_view: arguments.view, ..arguments.shot.load_for(&outputs, "png")? };
    let backend = arguments.shot.run.backend()?;
    let (effort, progress) = (arguments.shot.effort(), ExportProgress::terminal());
    block_on(image_export::write_sequence(&backend, &shot, frames, &names, effort, &progress))?;
    let (first, last) = (names.of(*frames.range.start()), names.of(*frames.range.end()));
    print_line!("{} to {}: {} on {}", first.display(), last.display(), shot.preset.name, backend.description())
}

fn flipbook(arguments: &Arguments, frames: &Frames, cells: UVec2) -> Result<(), Error> {
    let shot = Shot { debug_view: arguments.view, ..arguments.shot.load(&[])? };
    image_export::check_flipbook(shot.size, frames, cells)?;
    let backend = arguments.shot.run.backend()?;
    let (path, progress) = (&arguments.shot.output, ExportProgress::terminal());
    let sheet = block_on(image_export::render_flipbook(&backend, &shot, frames, cells, path, &progress))?;
    arguments.shot.write(sheet, &shot, &backend)
}

fn gif(arguments: &Arguments, frames: &Frames) -> Result<(), Error> {
    if frames.rate > image_export::MAX_GIF_RATE {
        let expected = format!("at most {} frames per second for a GIF", image_export::MAX_GIF_RATE);
        return Err(FieldError::new("--rate", frames.rate, expected).into());
    }
    let path = &arguments.shot.output;
    let outputs = [("--output", path.clone())];
    let shot = Shot { debug_view: arguments.view, ..arguments.shot.load_for(&outputs, "gif")? };
    let backend = arguments.shot.run.backend()?;
    block_on(image_export::write_gif(&backend, &shot, frames, path, &ExportProgress::terminal()))?;
    print_line!("{}: {} on {}", path.display(), shot.preset.name, backend.description())
}
