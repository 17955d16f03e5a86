//! `haze ramp new`: writes a recipe from a template, or a blank image to paint over.

use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser};
use glam::{UVec2, Vec2, Vec3};
use haze::FieldError;
use haze_author::ramp::lint::lint_ramp;
use haze_author::ramp::template::{TEMPLATES, Template};
use haze_core::assets::ramp::{Ramp, RampRole};
use haze_core::error::Error;
use haze_core::formula::texture::Texture2d as _;
use haze_export::options::choices;
use haze_export::output::{FileChecks, print_line};
use haze_export::text_drawing::{draw_text, text_width};
use haze_preset::{CompressionEffort, write_png};
use image::{DynamicImage, ImageBuffer, Rgb, RgbImage};

use super::ramp_image::{fraction, srgb_code_at};
use super::ramp_io::{check_recipe_output, write_recipe};

#[derive(Args)]
pub struct Arguments {
    /// Template to start from.
    #[arg(long, value_name = "NAME", default_value = "neutral", value_parser = template_names())]
    template: String,
    /// Write an image with labelled axes to paint over instead, for ramps of this role.
    #[arg(long, value_name = "ROLE", value_parser = choices::<RampRole>(), conflicts_with = "template")]
    blank: Option<RampRole>,
    /// File to write: a recipe, `NAME.ramp.json`, or with --blank an image, `NAME.png`. It must not exist yet.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
}

fn template_names() -> PossibleValuesParser {
    let about = |template: &Template| format!("{}: {}", template.role.name(), template.description);
    TEMPLATES.iter().map(|template| PossibleValue::new(template.name).help(about(template))).collect::<Vec<_>>().into()
}

pub fn run(Arguments { template, blank, output }: &Arguments) -> Result<(), Error> {
    let mut files = FileChecks::for_inputs::<PathBuf>([]);
    match blank {
        Some(_) => files.check_output("--output", output, "png")?,
        None => check_recipe_output(&mut files, output)?,
    }
    // A template never replaces an existing file.
    if output.exists() {
        let problem = format!("{} exists already", output.display());
        return Err(FieldError::from_problem("--output", problem, "a name that does not exist yet").into());
    }
    if let Some(role) = blank {
        return write_blank(output, *role);
    }
    let Some(template) = Template::find(template) else { return Ok(()) };
    write_recipe(output, &template.recipe())?;
    print_line!("{}: {}, for {} ramps", output.display(), template.description, template.role.name())
}

/// Height of the text on a blank, pixels.
const TEXT_HEIGHT: f32 = 20.0;
/// Blur of the text, as a standard deviation in pixels, and the factor that gives thin strokes their ink back.
const TEXT_BLUR: f32 = 1.3;
const TEXT_GAIN: f32 = 2.0;
/// Factor between two attempts at the strength of the text.
const FAINTER: f32 = 0.9;

fn write_blank(output: &Path, role: RampRole) -> Result<(), Error> {
    let across = match role {
        RampRole::Diffuse | RampRole::Backlight => ["away from the light", "facing it"],
        RampRole::Shadow => ["in full light", "behind thick smoke"],
        RampRole::Scatter => ["thin", "thick"],
        RampRole::Specular => ["at the light", "far from it: black"],
        RampRole::Coverage => ["thin; black hides nothing", "thick; white hides all"],
        RampRole::Age => ["born", "dies"],
        RampRole::Heat => ["born; white is hottest", "dies; black is cold"],
        RampRole::Fire => ["cold: black", "hottest"],
    };
    let has_two_axes = matches!(role, RampRole::Specular | RampRole::Backlight | RampRole::Shadow);
    let size = UVec2::new(512, if has_two_axes { 256 } else { 64 });
    // The first template of the role is the background.
    let Some(template) = TEMPLATES.iter().find(|template| template.role == role) else { return Ok(()) };
    let ramp = Ramp::from_image(&template.recipe().bake()?);
    let middle = size.y as f32 / 2.0 - TEXT_HEIGHT / 2.0;
    let [left, right] = [format!("< {}", across[0]), format!("{} >", across[1])];
    let right_edge = size.x as f32 - 12.0 - text_width(TEXT_HEIGHT, &right);
    let mut labels = vec![(12.0, middle, left.as_str()), (right_edge, middle, right.as_str())];
    if has_two_axes {
        let [top, bottom] = match role {
            RampRole::Shadow => ["top: light behind the smoke", "bottom: light on the viewer's side"],
            RampRole::Specular => ["top: thick smoke", "bottom: no smoke: black"],
            _ => ["top: thick smoke", "bottom: thin smoke"],
        };
        labels.extend([(180.0, 8.0, top), (180.0, size.y as f32 - TEXT_HEIGHT - 12.0, bottom)]);
    }
    let image = labelled(&ramp, size, role, &labels);
    write_png(output, &image, CompressionEffort::Small)?;
    print_line!("{}: a {} ramp to paint over, {}x{}", output.display(), role.name(), size.x, size.y)
}

/// Returns the ramp with labels, as strong as `haze ramp check` allows: a blank passes as it is. Labels are given with
/// their upper left corners.
fn labelled(ramp: &Ramp, size: UVec2, role: RampRole, labels: &[(f32, f32, &str)]) -> DynamicImage {
    let code = |x: u32, y: u32| interpolated_code(ramp, fraction(x, size.x), fraction(size.y - 1 - y, size.y));
    // White ink on dark smoke, black ink on bright smoke, for each label as a whole.
    let mut inks = [RgbImage::new(size.x, size.y), RgbImage::new(size.x, size.y)];
    for &(x, y, text) in labels {
        let middle = UVec2::new((x + 0.5 * text_width(TEXT_HEIGHT, text)) as u32, (y + 0.5 * TEXT_HEIGHT) as u32);
        let middle = middle.min(size - 1);
        let is_bright = code(middle.x, middle.y).element_sum() > 1.5;
        draw_text(&mut inks[usize::from(is_bright)], x, y, TEXT_HEIGHT, Rgb([255; 3]), text);
    }
    let [white, black] = inks.map(|ink| blurred(&ink));
    let draw = |strength: f32| {
        DynamicImage::ImageRgb16(ImageBuffer::from_fn(size.x, size.y, |x, y| {
            let index = (y * size.x + x) as usize;
            let code = code(x, y).lerp(Vec3::ONE, strength * white[index]) * (1.0 - strength * black[index]);
            Rgb(code.to_array().map(|channel| (channel.clamp(0.0, 1.0) * 65535.0).round() as u16))
        }))
    };
    let strengths = std::iter::successors(Some(1.0), |strength| Some(strength * FAINTER));
    let mut images = strengths.take_while(|strength| *strength > 0.05).map(draw);
    images.find(|image| lint_ramp(image, Some(role)).is_empty()).unwrap_or_else(|| draw(0.0))
}

/// Returns the sRGB code at `u` and `v`, both 0 to 1, interpolated between texels.
fn interpolated_code(ramp: &Ramp, u: f32, v: f32) -> Vec3 {
    let size = ramp.dimensions();
    let steps = (size - 1).as_vec2().max(Vec2::ONE);
    let at = Vec2::new(u, v) * steps;
    let low = at.floor();
    let fraction = at.fract();
    let code = |x: f32, y: f32| srgb_code_at(ramp, ((low.x + x) / steps.x).min(1.0), ((low.y + y) / steps.y).min(1.0));
    let row = |y: f32| code(0.0, y).lerp(code(1.0, y), fraction.x);
    row(0.0).lerp(row(1.0), fraction.y)
}

/// Returns the coverage of white text, blurred by a Gaussian first along rows, then along columns.
fn blurred(text: &RgbImage) -> Vec<f32> {
    let width = text.width() as usize;
    let height = text.height() as usize;
    let reach = (3.0 * TEXT_BLUR).ceil() as isize;
    let weights: Vec<f32> = (-reach..=reach).map(|at| (-0.5 * (at as f32 / TEXT_BLUR).powi(2)).exp()).collect();
    let sum: f32 = weights.iter().sum();
    // `step` is the distance of neighbours in the list, `at` the position along the axis.
    let along = |mask: &[f32], step: usize, count: usize, at: &dyn Fn(usize) -> usize| -> Vec<f32> {
        let value = |index: usize| {
            let start = index - at(index) * step;
            let weighted = (-reach..=reach).zip(&weights).filter_map(|(offset, weight)| {
                let other = at(index).checked_add_signed(offset).filter(|other| *other < count)?;
                Some(mask[start + other * step] * weight)
            });
            weighted.sum::<f32>() / sum
        };
        (0..mask.len()).map(value).collect()
    };
    let coverage: Vec<f32> = text.pixels().map(|pixel| f32::from(pixel.0[0]) / 255.0).collect();
    let rows = along(&coverage, 1, width, &|index| index % width.max(1));
    let columns = along(&rows, width, height, &|index| index / width.max(1));
    columns.into_iter().map(|fraction| 1.0 - (-TEXT_GAIN * fraction).exp()).collect()
}
