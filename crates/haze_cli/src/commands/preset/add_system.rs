//! `haze preset add-system`: adds a layer of the shelf to a preset.

use std::path::{Path, PathBuf};

use clap::Args;
use glam::Vec3;
use haze::FieldError;
use haze_core::error::Error;
use haze_preset::layers::find_layer;
use haze_preset::{Preset, builtin};

use haze_export::named_preset::NamedPreset;
use haze_export::output::{FileChecks, print_line};
use haze_export::share_link::fragment_of_name;

use super::preset_copy::write_preset;

#[derive(Args)]
pub struct Arguments {
    /// Name of a built-in preset, path of a preset file (JSON), or link of a look.
    preset: PathBuf,
    /// Name of a layer: `haze preset layers` lists them.
    layer: String,
    /// Place of the layer, metres: where it would otherwise have the origin.
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_position, allow_hyphen_values = true)]
    at: Option<Vec3>,
    /// File to write; the images that the preset uses are copied beside it. Default: the preset's own file.
    #[arg(short, long, value_name = "FILE.json")]
    output: Option<PathBuf>,
}

pub fn run(arguments: &Arguments) -> Result<(), Error> {
    let source = &arguments.preset;
    let layer = find_layer("LAYER", &arguments.layer)?;
    let mut named = NamedPreset::load(source, None)?;
    let is_link = fragment_of_name(source).is_some();
    let is_builtin = source.to_str().is_some_and(|name| builtin::find(builtin::PRESETS, name).is_some());
    let (option, path) = match &arguments.output {
        Some(output) => ("--output", output),
        None if is_link || is_builtin => {
            let problem = format!("{} is no file", named.path.display());
            return Err(FieldError::from_problem("PRESET", problem, "--output FILE.json, or the path of a file").into());
        }
        None => ("PRESET", source),
    };
    layer.add_at(&mut named.preset, arguments.at.unwrap_or_default())?;
    FileChecks::for_inputs::<&Path>([]).check_output(option, path, "json")?;
    // Fields that the file has stay, even at their defaults.
    let old = if is_link { String::new() } else { Preset::load_with_source(source)?.1 };
    write_preset(path, &named.preset.to_json(&old), &named)?;
    let added = named.preset.systems.last().map_or("", |system| &system.name);
    let number = named.preset.systems.len() - 1;
    print_line!("{}: {} with the system {added:?}, systems[{number}]", path.display(), named.preset.name)
}

/// Parses `X,Y,Z`, metres.
fn parse_position(text: &str) -> Result<Vec3, String> {
    let numbers: Option<Vec<f32>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
    let position = numbers.and_then(|numbers| <[f32; 3]>::try_from(numbers).ok()).map(Vec3::from);
    position
        .filter(|position| position.is_finite())
        .ok_or_else(|| format!("{text:?} is not a position; expected X,Y,Z in metres, for example 1,0,-2.5"))
}
