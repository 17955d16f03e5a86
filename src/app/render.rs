//! `haze render`: one picture, or one for every frame of a stretch of time.

use std::ops::RangeInclusive;

use clap::Args;
use glam::UVec2;
use haze::demo::develop::develop;
use haze::demo::shot::Shot;
use haze::picture::write_png;
use haze::settings::ShadeTree;
use haze::{Error, FieldError};
use image::{RgbImage, imageops};

use super::frames::{FrameNames, parse_frames, parse_rate, parse_sheet};
use super::memory::check_memory;
use super::options::{Backend, ShotArguments, choices};
use super::output::say;
use super::progress::watched;

#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    shot: ShotArguments,
    /// Which stage of the shading is shown.
    #[arg(long, default_value = "final", value_parser = choices::<ShadeTree>())]
    view: ShadeTree,
    /// Render frames A to B, both included, into files of their own: the name has the number in it, as in `f_%04d.png`. Frame 0
    /// is at the preset's time, or at --time.
    #[arg(long, value_name = "A..B", value_parser = parse_frames)]
    frames: Option<RangeInclusive<u32>>,
    /// Frames in a second.
    #[arg(long, value_name = "N", default_value = "60", value_parser = parse_rate, requires = "frames")]
    rate: f32,
    /// Put all frames on one sheet of so many rows and columns, a flipbook; --size is the size of a frame.
    #[arg(long, value_name = "RxC", value_parser = parse_sheet, requires = "frames")]
    sheet: Option<UVec2>,
}

pub fn run(arguments: &Arguments) -> Result<(), Error> {
    match (&arguments.frames, arguments.sheet) {
        (Some(frames), None) => sequence(arguments, frames),
        (Some(frames), Some(cells)) => flipbook(arguments, frames, cells),
        (None, _) => {
            let shot = Shot { shade_tree: arguments.view, ..arguments.shot.load(&[])? };
            let backend = arguments.shot.run.backend()?;
            let picture = backend.render(&shot)?;
            arguments.shot.write(develop(&picture, &shot), &shot, &backend)
        }
    }
}

fn sequence(arguments: &Arguments, frames: &RangeInclusive<u32>) -> Result<(), Error> {
    let names = FrameNames::parse(&arguments.shot.output)?;
    let outputs: Vec<_> = frames.clone().map(|frame| ("--output", names.of(frame))).collect();
    let shot = Shot { shade_tree: arguments.view, ..arguments.shot.load_for(&outputs)? };
    let backend = arguments.shot.run.backend()?;
    for (frame, (_, path)) in frames.clone().zip(&outputs) {
        let picture = render_frame(arguments, &backend, &shot, frame)?;
        write_png(path, &picture.into(), arguments.shot.effort())?;
    }
    let (first, last) = (names.of(*frames.start()), names.of(*frames.end()));
    say!("{} to {}: {} on {}", first.display(), last.display(), shot.preset.name, backend.description())
}

/// Most pixels along a side of a flipbook.
const MOST_PIXELS: u32 = 32_768;

fn flipbook(arguments: &Arguments, frames: &RangeInclusive<u32>, cells: UVec2) -> Result<(), Error> {
    let count = frames.clone().count();
    if count > cells.element_product() as usize {
        let expected = format!("room for {count} frames");
        return Err(FieldError::new("--sheet", format!("{}x{}", cells.x, cells.y), expected).into());
    }
    let shot = Shot { shade_tree: arguments.view, ..arguments.shot.load(&[])? };
    let (rows, columns) = (cells.x, cells.y);
    let size = shot.size * UVec2::new(columns, rows);
    if size.max_element() > MOST_PIXELS {
        let expected = format!("at most {MOST_PIXELS} pixels along a side, not {}x{}", size.x, size.y);
        return Err(FieldError::new("--sheet", format!("{rows}x{columns}"), expected).into());
    }
    check_memory("--sheet", size)?;
    let backend = arguments.shot.run.backend()?;
    let mut sheet = RgbImage::new(size.x, size.y);
    for (index, frame) in (0..).zip(frames.clone()) {
        let picture = render_frame(arguments, &backend, &shot, frame)?;
        let corner = UVec2::new(index % columns, index / columns) * shot.size;
        imageops::replace(&mut sheet, &picture, i64::from(corner.x), i64::from(corner.y));
    }
    arguments.shot.write(sheet, &shot, &backend)
}

fn render_frame(arguments: &Arguments, backend: &Backend, shot: &Shot, frame: u32) -> Result<RgbImage, Error> {
    let mut shot = shot.clone();
    shot.preset.time += frame as f32 / arguments.rate;
    let picture = watched(format!("haze: frame {frame}"), || backend.render(&shot))?;
    Ok(develop(&picture, &shot))
}
