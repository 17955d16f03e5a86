//! `haze ramp show`: prints a ramp and its luminance curve, or writes them as an image.

use std::fmt::Write as _;
use std::io::IsTerminal as _;
use std::path::PathBuf;

use clap::Args;
use glam::{UVec2, Vec3};
use haze_author::ramp::RampRecipe;
use haze_core::assets::ramp::Ramp;
use haze_core::error::Error;
use haze_core::formula::color::{linear_from_srgb, luminance, srgb_from_linear};
use haze_export::contact_sheet::BACKGROUND;
use haze_export::output::{FileChecks, one_line, print_line, write_text};
use haze_preset::{CompressionEffort, write_png};
use image::{Rgb, RgbImage, imageops};

use super::ramp_image::{fraction, ramp_image, srgb_code_at};
use super::ramp_io::load_ramp_image;
use crate::plot::{Curve, LEFT, RIGHT, plot};

#[derive(Args)]
pub struct Arguments {
    /// A PNG or a `*.ramp.json` file.
    ramp: PathBuf,
    /// Write an image instead of text.
    #[arg(short, long, value_name = "FILE.png")]
    output: Option<PathBuf>,
}

/// Characters per line.
const COLUMNS: u32 = 64;
/// Lines of a ramp with two axes, of two texels each; also lines of the curve.
const LINES: u32 = 12;
/// Size of the ramp in the image, pixels.
const SIZE: UVec2 = UVec2::new(512, 256);
/// Most stops that are listed.
const MAX_LISTED_STOPS: usize = 32;
const EIGHTHS: [char; 9] = [' ', '▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];

pub fn run(Arguments { ramp: path, output }: &Arguments) -> Result<(), Error> {
    if let Some(output) = output {
        FileChecks::for_inputs([path]).check_output("--output", output, "png")?;
    }
    let (image, recipe) = load_ramp_image(path)?;
    let ramp = Ramp::from_image(&image);
    let size = ramp.size();
    if let Some(output) = output {
        write_png(output, &ramp_with_curves(&ramp).into(), CompressionEffort::Quick)?;
        return print_line!("{}: {}, {}x{}", output.display(), path.display(), size.x, size.y);
    }
    let is_plain = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    let mut text = format!("{}: {}x{}\n", one_line(path.display()), size.x, size.y);
    if !is_plain && std::io::stdout().is_terminal() {
        text += &colored_text(&ramp);
    }
    text += &luminance_curve(&ramp);
    text += &recipe.as_ref().map(stop_list).unwrap_or_default();
    write_text(text.trim_end())
}

/// Draws two texels per character: the upper one in the foreground color, the lower one in the background color.
fn colored_text(ramp: &Ramp) -> String {
    let up = if ramp.size().y > 1 { LINES } else { 2 };
    let mut text = String::new();
    for line in (0..up).rev() {
        for x in 0..COLUMNS {
            let [upper, lower] = [2 * line + 1, 2 * line].map(|y| {
                let color = srgb_code_at(ramp, fraction(x, COLUMNS), fraction(y, 2 * up)) * 255.0;
                let [r, g, b] = color.to_array().map(|channel| channel.round() as u8);
                format!("2;{r};{g};{b}")
            });
            let _ = write!(text, "\x1b[38;{upper};48;{lower}m▀");
        }
        text += "\x1b[0m\n";
    }
    text
}

/// Returns the luminance of an sRGB code, as sRGB code.
fn brightness(code: Vec3) -> f32 {
    srgb_from_linear(luminance(code.map(linear_from_srgb)))
}

/// Draws the luminance along the middle of the ramp.
fn luminance_curve(ramp: &Ramp) -> String {
    let heights: Vec<u32> = (0..COLUMNS)
        .map(|x| (brightness(srgb_code_at(ramp, fraction(x, COLUMNS), 0.5)) * (8 * LINES) as f32).round() as u32)
        .collect();
    let mut text = String::new();
    for line in (0..LINES).rev() {
        let eighth = |height: &u32| EIGHTHS[height.saturating_sub(8 * line).min(8) as usize];
        let cells: String = heights.iter().map(eighth).collect();
        text += cells.trim_end();
        text.push('\n');
    }
    text
}

fn stop_list(recipe: &RampRecipe) -> String {
    let mut text = String::new();
    let all = recipe.rows.iter().flat_map(|row| row.stops.iter().map(move |stop| (row.at, stop)));
    let count = all.clone().count();
    for (at, stop) in all.take(MAX_LISTED_STOPS) {
        let row = if recipe.rows.len() > 1 { format!("{at:5.3}  ") } else { String::new() };
        let _ = writeln!(text, "{row}{:5.3}  {}  {}", stop.at, String::from(stop.color), stop.curve.name());
    }
    if count > MAX_LISTED_STOPS {
        let _ = writeln!(text, "and {} more stops", count - MAX_LISTED_STOPS);
    }
    text
}

/// Draws the ramp above the curves of its channels and its luminance.
fn ramp_with_curves(ramp: &Ramp) -> RgbImage {
    let sample = |channel: fn(Vec3) -> f32| -> Box<dyn Fn(f32) -> f32> {
        let ramp = ramp.clone();
        Box::new(move |u| channel(srgb_code_at(&ramp, u, 0.5)))
    };
    let curve = |name, color, channel| Curve { name, color: Rgb(color), function: sample(channel) };
    let curves = [
        curve("red", [235, 90, 80], |code| code.x),
        curve("green", [90, 200, 100], |code| code.y),
        curve("blue", [90, 140, 245], |code| code.z),
        curve("luminance", [225, 225, 220], brightness),
    ];
    let axis = if ramp.size().y > 1 { "across, at the middle of the other axis" } else { "across" };
    let below = plot(SIZE + UVec2::new((LEFT + RIGHT) as u32, 60), 0.0, 1.0, axis, &curves);
    let up = if ramp.size().y > 1 { SIZE.y } else { SIZE.y / 4 };
    let strip = ramp_image(ramp, UVec2::new(SIZE.x, up));
    let mut image = RgbImage::from_pixel(below.width(), up + below.height() + 16, BACKGROUND);
    imageops::replace(&mut image, &strip, LEFT as i64, 16);
    imageops::replace(&mut image, &below, 0, i64::from(up) + 16);
    image
}
