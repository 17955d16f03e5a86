//! `haze export material`: ramps and lighting formula of a system, for an engine.

use std::path::PathBuf;

use clap::Args;
use haze::FieldError;
use haze_core::error::Error;
use haze_preset::system_list;

use haze_export::engine::Engine;
use haze_export::inputs::image_paths;
use haze_export::material_export::MaterialExport;
use haze_export::named_preset::NamedPreset;
use haze_export::options::{AssetsArguments, parse_assignment, with_option};
use haze_export::output::{FileChecks, OutputFolder, print_line};

#[derive(Args)]
pub struct Arguments {
    /// Name of a built-in preset (see `haze preset list`), path of a preset file (JSON), or link of a look.
    #[arg(default_value = "column")]
    preset: PathBuf,
    /// Engine to write for.
    #[arg(long, value_enum)]
    engine: Engine,
    /// Name of the system, or its number, counted from 0. Default: the first.
    #[arg(long, value_name = "NAME")]
    system: Option<String>,
    /// Set a field of the preset, as in `haze render`. May be given more than once.
    #[arg(long, value_name = "FIELD=VALUE", value_parser = parse_assignment)]
    set: Vec<(String, String)>,
    /// Folder to write into; it is made if it does not exist.
    #[arg(short, long, value_name = "FOLDER")]
    output: PathBuf,
    #[command(flatten)]
    assets: AssetsArguments,
}

pub fn run(arguments: &Arguments) -> Result<(), Error> {
    let Arguments { preset: path, engine, system, set, output, assets } = arguments;
    let NamedPreset { mut preset, path: name, folders, .. } = NamedPreset::load(path, assets.folder()?)?;
    for (field, value) in set {
        preset.set_field(field, value).map_err(|error| with_option("--set", error))?;
    }
    preset.validate()?;
    let preset = preset.evaluate(preset.time);
    let index = system.as_ref().map_or(Ok(0), |name| system_list::find(&preset, "--system", name))?;
    let materials = preset.load_materials_from(&name, &folders)?;
    let Some((system, images)) = preset.systems.get(index).zip(materials.get(index)) else {
        return Err(FieldError::new("PRESET", path.display(), "a preset with a system").into());
    };
    let export = MaterialExport::new(&preset.name, index, system, images, *engine)?;
    let images = image_paths(&folders, &preset);
    let _made = OutputFolder::make("--output", output)?;
    let mut files = FileChecks::for_inputs(images.iter().map(PathBuf::as_path).chain([path.as_path()]));
    for name in export.files() {
        let file = output.join(name);
        let extension = file.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
        files.check_output("--output", &file, extension)?;
    }
    export.write(output)?;
    export.files().try_for_each(|name| print_line!("{}", output.join(name).display()))
}
