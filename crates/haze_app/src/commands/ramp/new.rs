//! `haze ramp new`: writes a recipe from a template, or a blank image to paint over.

use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser};
use glam::UVec2;
use haze::image::{CompressionEffort, write_png};
use haze::ramp::{Ramp, RampRole};
use haze::{Error, FieldError};
use haze_author::ramp::template::{TEMPLATES, Template};
use image::Rgb;

use super::ramp_image::ramp_image;
use super::ramp_io::{check_recipe_output, write_recipe};
use crate::options::choices;
use crate::output::{FileChecks, print_line};
use crate::text_drawing::{draw_text, text_width};

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
const TEXT_HEIGHT: f32 = 16.0;

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
    let mut picture = ramp_image(&Ramp::from_image(&template.recipe().bake()?), size);
    let mut write = |x: f32, y: f32, text: &str| {
        // White text with a black shadow is legible on any background.
        draw_text(&mut picture, x + 1.0, y + 1.0, TEXT_HEIGHT, Rgb([0; 3]), text);
        draw_text(&mut picture, x, y, TEXT_HEIGHT, Rgb([255; 3]), text);
    };
    let middle = size.y as f32 / 2.0 - TEXT_HEIGHT / 2.0;
    let [left, right] = [format!("< {}", across[0]), format!("{} >", across[1])];
    write(8.0, middle, &left);
    write(size.x as f32 - 8.0 - text_width(TEXT_HEIGHT, &right), middle, &right);
    if has_two_axes {
        let [top, bottom] = match role {
            RampRole::Shadow => ["top: light behind the smoke", "bottom: light on the viewer's side"],
            RampRole::Specular => ["top: thick smoke", "bottom: no smoke: black"],
            _ => ["top: thick smoke", "bottom: thin smoke"],
        };
        write(180.0, 4.0, top);
        write(180.0, size.y as f32 - TEXT_HEIGHT - 6.0, bottom);
    }
    write_png(output, &picture.into(), CompressionEffort::Small)?;
    print_line!("{}: a {} ramp to paint over, {}x{}", output.display(), role.name(), size.x, size.y)
}
