//! `haze render`: renders one image, one per frame of a range, a flipbook or a GIF.

use std::ops::RangeInclusive;

use clap::Args;
use glam::UVec2;
use haze::FieldError;
use haze_core::error::Error;
use haze_core::settings::DebugView;
use haze_demo::shot::Shot;
use pollster::block_on;

use haze_export::exr_export::{self, ExrOptions};
use haze_export::frame_range::{FrameNames, parse_frames, parse_rate, parse_sheet};
use haze_export::image_export::{self, ExportProgress, Frames, SCENE, USUAL_RATE};
use haze_export::image_format::{Alpha, Background, BitDepth, ImageFormat};
use haze_export::options::{ShotArguments, choices};
use haze_export::output::print_line;
use haze_export::recipe_files::has_extension;

#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    shot: ShotArguments,
    /// Stage of the shading to show.
    #[arg(long, default_value = "final", value_parser = choices::<DebugView>())]
    view: DebugView,
    /// Render frames A to B, both included: to one PNG per frame, with the frame number in its name as in `f_%04d.png`,
    /// or to one animated GIF, `f.gif`. Frame 0 is at the preset's time, or at --time.
    #[arg(long, value_name = "A..B", value_parser = parse_frames, allow_hyphen_values = true)]
    frames: Option<RangeInclusive<u32>>,
    /// Frames per second. Default: 60, or 25 for a GIF.
    #[arg(long, value_name = "N", value_parser = parse_rate, allow_hyphen_values = true, requires = "frames")]
    rate: Option<f32>,
    /// Put all frames on one sheet of R rows and C columns, a flipbook; --size is the size of a frame.
    #[arg(long, value_name = "RxC", value_parser = parse_sheet, allow_hyphen_values = true, requires = "frames")]
    sheet: Option<UVec2>,
    /// Background of the image: `auto` leaves it out if the scene is `empty`. Without it, the smoke is alone, with its
    /// opacity in alpha; a name that ends in .exr is linear, premultiplied, and has layers.
    #[arg(long, value_enum, default_value_t)]
    background: Background,
    /// The same as `--background transparent`.
    #[arg(long, conflicts_with = "background")]
    transparent: bool,
    /// Color of a PNG without background: the smoke's own, or multiplied by alpha.
    #[arg(long, value_enum, default_value_t)]
    alpha: Alpha,
    /// Bits per channel of a PNG.
    #[arg(long, value_enum, default_value_t)]
    bits: BitDepth,
}

pub fn run(arguments: &Arguments) -> Result<(), Error> {
    let is_gif = has_extension(&arguments.shot.output, "gif");
    let frames = arguments.frames.clone().map(|range| {
        let usual = if is_gif { 25.0 } else { USUAL_RATE };
        Frames { range, rate: arguments.rate.unwrap_or(usual), format: arguments.format() }
    });
    arguments.check_format(is_gif)?;
    match (&frames, arguments.sheet) {
        (Some(frames), None) if is_gif => gif(arguments, frames),
        (Some(frames), None) => sequence(arguments, frames),
        (Some(frames), Some(cells)) => flipbook(arguments, frames, cells),
        (None, _) => image(arguments),
    }
}

impl Arguments {
    fn format(&self) -> ImageFormat {
        let background = if self.transparent { Background::Transparent } else { self.background };
        ImageFormat { background, alpha: self.alpha, bits: self.bits }
    }

    /// Refuses choices that the kind of file or the view does not have.
    fn check_format(&self, is_gif: bool) -> Result<(), FieldError> {
        let format = self.format();
        let option = if self.transparent { "--transparent" } else { "--background" };
        if format.background == Background::Transparent && is_gif {
            return Err(FieldError::from_problem(option, "a GIF has no partial opacity", "a PNG or EXR"));
        }
        if format.background == Background::Transparent && self.view != DebugView::Final {
            let problem = format!("--view {} shows no scene", self.view.name());
            return Err(FieldError::from_problem(option, problem, "--view final"));
        }
        if format.bits == BitDepth::Sixteen && (is_gif || self.kind() == "exr") {
            let problem = format!("{} is no PNG", self.shot.output.display());
            return Err(FieldError::from_problem("--bits", problem, "a name that ends in .png"));
        }
        if format.alpha == Alpha::Premultiplied && (is_gif || self.kind() == "exr") {
            let problem = format!("{} is no PNG", self.shot.output.display());
            return Err(FieldError::from_problem("--alpha", problem, "a name that ends in .png; EXR is premultiplied"));
        }
        Ok(())
    }

    /// Returns the kind of file to write.
    fn kind(&self) -> &'static str {
        if has_extension(&self.shot.output, "exr") { "exr" } else { "png" }
    }
}

fn image(arguments: &Arguments) -> Result<(), Error> {
    let path = &arguments.shot.output;
    let outputs = [("--output", path.clone())];
    let shot = Shot { debug_view: arguments.view, ..arguments.shot.load_for(&outputs, arguments.kind())? };
    let backend = arguments.shot.run.backend()?;
    if arguments.kind() == "exr" {
        let options = ExrOptions::of_image(&shot, arguments.format().background);
        block_on(exr_export::write(&backend, &shot, options, path))?;
        return print_line!("{}: {} on {}", path.display(), shot.preset.name, backend.description());
    }
    let one = Frames { range: 0..=0, rate: 1.0, format: arguments.format() };
    let progress = ExportProgress::Callback(&|_, _| true);
    let image = block_on(image_export::render_flipbook(&backend, &shot, &one, UVec2::ONE, path, &progress))?;
    arguments.shot.write(image, &shot, &backend)
}

fn sequence(arguments: &Arguments, frames: &Frames) -> Result<(), Error> {
    let names = FrameNames::parse(&arguments.shot.output)?;
    let outputs: Vec<_> = frames.range.clone().map(|frame| ("--output", names.of(frame))).collect();
    let shot = Shot { debug_view: arguments.view, ..arguments.shot.load_for(&outputs, arguments.kind())? };
    let backend = arguments.shot.run.backend()?;
    let effort = arguments.shot.effort();
    let progress = ExportProgress::terminal();
    if arguments.kind() == "exr" {
        block_on(exr_export::write_sequence(&backend, &shot, frames, &names, &progress))?;
    } else {
        block_on(image_export::write_sequence(&backend, &shot, frames, &names, effort, &progress))?;
    }
    let first = names.of(*frames.range.start());
    let last = names.of(*frames.range.end());
    print_line!("{} to {}: {} on {}", first.display(), last.display(), shot.preset.name, backend.description())
}

fn flipbook(arguments: &Arguments, frames: &Frames, cells: UVec2) -> Result<(), Error> {
    let shot = Shot { debug_view: arguments.view, ..arguments.shot.load(&[])? };
    image_export::check_flipbook(shot.size, frames, cells)?;
    let backend = arguments.shot.run.backend()?;
    let path = &arguments.shot.output;
    let progress = ExportProgress::terminal();
    let sheet = block_on(image_export::render_flipbook(&backend, &shot, frames, cells, path, &progress))?;
    arguments.shot.write(sheet, &shot, &backend)
}

fn gif(arguments: &Arguments, frames: &Frames) -> Result<(), Error> {
    if frames.rate > image_export::MAX_GIF_RATE {
        let expected = format!("at most {} frames per second for a GIF", image_export::MAX_GIF_RATE);
        return Err(FieldError::new("--rate", frames.rate, expected).into());
    }
    // An empty scene shows its sky.
    let frames = &Frames { range: frames.range.clone(), rate: frames.rate, format: SCENE };
    let path = &arguments.shot.output;
    let outputs = [("--output", path.clone())];
    let shot = Shot { debug_view: arguments.view, ..arguments.shot.load_for(&outputs, "gif")? };
    let backend = arguments.shot.run.backend()?;
    block_on(image_export::write_gif(&backend, &shot, frames, path, &ExportProgress::terminal()))?;
    print_line!("{}: {} on {}", path.display(), shot.preset.name, backend.description())
}
