//! Options shared by several subcommands: a preset and changes to it, an image size, a renderer.

use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::str::FromStr;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};
use glam::UVec2;
use haze::FieldError;
use haze::shader::Sources;
use haze_author::particle_files::unused_columns;
use haze_author::preset::no_effect_reason_of_set;
use haze_core::error::Error;
use haze_core::settings::{Choice, ParseChoiceError, RenderPath, ScaleMode, Technique};
use haze_demo::headless::Headless;
use haze_demo::shot::Shot;
use haze_preset::{AssetFolders, CompressionEffort, MAX_TIME, Preset, system_list, write_png};
use image::DynamicImage;

use super::backdrop_options::{BackdropArguments, BackdropShot, SKY_ROTATION};
use super::backend::Backend;
use super::inputs::image_paths;
use super::memory_check::{BYTES_PER_PIXEL, check_memory};
use super::named_preset::NamedPreset;
use super::output::{FileChecks, print_error, print_line};

/// Options of rendering that do not depend on the shot.
#[derive(Args)]
pub struct RunArguments {
    /// Image size in pixels.
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = parse_size, allow_hyphen_values = true)]
    pub size: UVec2,
    /// Rendering path of the smoke. Default: the preset's.
    #[arg(long, value_parser = choices::<RenderPath>())]
    pub path: Option<RenderPath>,
    /// Renderer.
    #[arg(long, value_enum, default_value = "auto")]
    backend: BackendName,
    /// Folder with WGSL files laid out as in haze's `shaders`. They replace the built-in files of the same names.
    #[arg(long, value_name = "DIR")]
    shaders: Option<PathBuf>,
}

/// A preset, and changes to it for this run.
#[derive(Args)]
pub struct ShotArguments {
    /// Name of a built-in preset (see `haze preset list`), path of a preset file (JSON), or link of a look.
    #[arg(default_value = "column")]
    preset: PathBuf,
    /// Size, path, renderer and shaders.
    #[command(flatten)]
    pub run: RunArguments,
    /// Seconds since the start of the emission. Default: the preset's.
    #[arg(long, value_name = "S", value_parser = parse_time, allow_hyphen_values = true)]
    time: Option<f64>,
    /// Pixels per texel of the accumulation target, 1 to 16; or `auto`: by the detail of the smoke. Default: the preset's.
    #[arg(long, value_name = "N", value_parser = parse_scale, allow_hyphen_values = true)]
    scale: Option<ScaleArgument>,
    /// Soft-particle technique. Default: the preset's.
    #[arg(long, value_name = "T", value_parser = choices::<Technique>())]
    pub technique: Option<Technique>,
    /// Seed of every emitter. Default: the preset's.
    #[arg(long, value_name = "N", value_parser = parse_seed, allow_hyphen_values = true)]
    seed: Option<u32>,
    /// Set a field of the preset, named by its path or the end of it: `accumulate.downscale=4`, `lights[0].intensity=30`.
    /// It replaces keyframes. May be given more than once.
    #[arg(long, value_name = "FIELD=VALUE", value_parser = parse_assignment)]
    set: Vec<(String, String)>,
    /// Draw only this particle system: its name, or its number, counted from 0.
    #[arg(long, value_name = "NAME|INDEX")]
    solo: Option<String>,
    /// PNG to write.
    #[arg(short, long, value_name = "FILE.png")]
    pub output: PathBuf,
    #[command(flatten)]
    assets: AssetsArguments,
    #[command(flatten)]
    backdrop: BackdropArguments,
    /// Compress more: takes one or two seconds longer, for a file that is a tenth smaller.
    #[arg(long)]
    small: bool,
}

/// A folder of files that presets share.
#[derive(Args, Clone, Debug, Default)]
pub struct AssetsArguments {
    /// Folder to search for images and particle files that are not beside the preset.
    #[arg(long, value_name = "DIR")]
    assets: Option<PathBuf>,
}

impl AssetsArguments {
    /// Returns the folder.
    ///
    /// # Errors
    /// If it is not a folder.
    pub fn folder(&self) -> Result<Option<PathBuf>, Error> {
        match &self.assets {
            Some(folder) if !folder.is_dir() => {
                Err(FieldError::new("--assets", folder.display(), "a folder that exists").into())
            }
            folder => Ok(folder.clone()),
        }
    }

    /// Returns the folders to search for the files of a preset.
    ///
    /// # Errors
    /// As [`AssetsArguments::folder`].
    pub fn folders(&self, preset: &std::path::Path) -> Result<AssetFolders, Error> {
        Ok(AssetFolders::for_preset_file(preset).with_shared(self.folder()?))
    }
}

/// Choice of a renderer.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum BackendName {
    /// The GPU if there is one, else the CPU.
    Auto,
    /// The GPU; fails if there is none.
    Gpu,
    /// The reference renderer on the CPU: slow, with the same result on every machine.
    Cpu,
}

impl ShotArguments {
    /// Loads the preset, applies the changes, and builds the shot. Refuses `--output`, and `others` (option and path),
    /// if they cannot be written.
    pub fn load(&self, others: &[(&str, PathBuf)]) -> Result<Shot, Error> {
        let output = ("--output", self.output.clone());
        self.load_for(&[&[output], others].concat(), "png")
    }

    /// Like [`Self::load`], with `outputs` instead of `--output`; their names end in `kind`.
    pub fn load_for(&self, outputs: &[(&str, PathBuf)], kind: &str) -> Result<Shot, Error> {
        let outputs: Vec<_> = outputs.iter().map(|(option, path)| (*option, path.clone(), kind)).collect();
        self.load_outputs(&outputs)
    }

    /// Like [`Self::load_for`], with the ending of each output. Says which parts of a scene file are not shown, which columns of
    /// particle files are not used, and which changes have no effect.
    pub fn load_outputs(&self, outputs: &[(&str, PathBuf, &str)]) -> Result<Shot, Error> {
        let ChangedShot { mut shot, names, solo } = self.changed_shot(None)?;
        // Errors come first: a refused command says one line.
        self.check_outputs(&shot, outputs)?;
        for note in shot.backdrop.notes(&shot.preset.environment) {
            print_error(note);
        }
        for (index, frames) in (0..).zip(&shot.caches) {
            let unused = frames.as_ref().map(|frames| unused_columns(&shot.preset, index, frames));
            unused.unwrap_or_default().iter().for_each(print_error);
        }
        for ((field, _), name) in self.set.iter().zip(&names) {
            let reason = self.backdrop.no_effect_reason(name);
            if let Some(reason) = reason.or_else(|| no_effect_reason_of_set(&shot.preset, field, name, self.run.size)) {
                print_error(format_args!("--set {field} has no effect: {reason}"));
            }
        }
        let is_turned = names.iter().any(|name| name == SKY_ROTATION);
        if let Some(line) = self.backdrop.sky_note(&shot, is_turned) {
            print_error(line);
        }
        // Last, because it renumbers the systems.
        if let Some(index) = solo {
            shot.keep_only_system(index);
        }
        Ok(shot)
    }

    /// Refuses outputs that cannot be written, or that the shot was read from.
    pub fn check_outputs(&self, shot: &Shot, outputs: &[(&str, PathBuf, &str)]) -> Result<(), Error> {
        let images = image_paths(&self.assets.folders(&self.preset)?, &shot.preset);
        let inputs = images.iter().map(PathBuf::as_path).chain(shot.backdrop.files()).chain([self.preset.as_path()]);
        let mut files = FileChecks::for_inputs(inputs);
        outputs.iter().try_for_each(|(option, path, kind)| files.check_output(option, path, kind))
    }

    /// Builds the shot with one more field set, as by `--set`.
    pub fn varied_shot(&self, option: &'static str, field: &str, value: &str) -> Result<VariedShot, Error> {
        let ChangedShot { mut shot, names, solo } = self.changed_shot(Some(Assignment { option, field, value }))?;
        if let Some(index) = solo {
            shot.keep_only_system(index);
        }
        Ok(VariedShot { shot, name: names.last().cloned().unwrap_or_default() })
    }

    /// Applies all changes. Fields that a scene file replaces are set once more afterwards: `--set` is the last word.
    fn changed_shot(&self, varied: Option<Assignment<'_>>) -> Result<ChangedShot, Error> {
        let NamedPreset { mut preset, path, folders, .. } = NamedPreset::load(&self.preset, self.assets.folder()?)?;
        let of_systems = [
            ("systems.emitter.seed", self.seed.map(|seed| seed.to_string())),
            ("systems.settings.accumulate.scale_mode", self.scale.map(|scale| scale.mode().name().into())),
            ("systems.settings.accumulate.downscale", self.scale.and_then(ScaleArgument::pixels)),
            ("systems.settings.path", self.run.path.map(|path| path.name().into())),
            ("systems.settings.technique", self.technique.map(|technique| technique.name().into())),
        ];
        let has_systems = !preset.systems.is_empty();
        for (field, value) in of_systems.into_iter().filter(|_| has_systems) {
            value.map_or(Ok(String::new()), |value| preset.set_field(field, &value))?;
        }
        preset.time = self.time.unwrap_or(preset.time);
        let of_option = self.set.iter().map(|(field, value)| Assignment { option: "--set", field, value });
        let assignments: Vec<_> = of_option.chain(varied).collect();
        let mut names = Vec::new();
        for assignment in &assignments {
            match assignment.apply(&mut preset) {
                Ok(name) => names.push(name),
                // It may be a field of a light that the scene file has.
                Err(_) if self.backdrop.replaces_settings() => names.push(String::new()),
                Err(error) => return Err(error.into()),
            }
        }
        preset.validate()?;
        let solo = self.solo.as_ref().map(|name| system_list::find(&preset, "--solo", name)).transpose()?;
        let load = |preset| Shot::from_folders(preset, &path, &folders, self.run.size);
        let BackdropShot { mut shot, replaced } = self.backdrop.apply(preset, load)?;
        for (assignment, name) in assignments.iter().zip(&mut names) {
            let is_replaced = replaced.iter().any(|group| name.strip_prefix(group).is_some_and(is_field_or_end));
            if name.is_empty() || is_replaced {
                *name = assignment.apply(&mut shot.preset)?;
            }
        }
        shot.preset.validate()?;
        Ok(ChangedShot { shot, names, solo })
    }

    /// Effort to compress PNGs.
    pub fn effort(&self) -> CompressionEffort {
        if self.small { CompressionEffort::Small } else { CompressionEffort::Quick }
    }

    /// Writes the image, and prints a line that says so.
    pub fn write(&self, image: impl Into<DynamicImage>, shot: &Shot, backend: &Backend) -> Result<(), Error> {
        write_png(&self.output, &image.into(), self.effort())?;
        print_line!("{}: {} on {}", self.output.display(), shot.preset.name, backend.description())
    }
}

/// A shot of a changed preset.
struct ChangedShot {
    shot: Shot,
    /// Full names of the fields of all assignments.
    names: Vec<String>,
    /// Index of the only system to draw.
    solo: Option<usize>,
}

/// A shot with one more field set.
pub struct VariedShot {
    /// The shot.
    pub shot: Shot,
    /// Full name of the field.
    pub name: String,
}

/// A field and its value, as an option gives them.
#[derive(Clone, Copy)]
struct Assignment<'a> {
    option: &'static str,
    field: &'a str,
    value: &'a str,
}

impl Assignment<'_> {
    /// Sets the field. Returns its full name.
    fn apply(&self, preset: &mut Preset) -> Result<String, FieldError> {
        preset.set_field(self.field, self.value).map_err(|error| with_option(self.option, error))
    }
}

/// True for the end of a name after that of its group.
fn is_field_or_end(rest: &str) -> bool {
    rest.is_empty() || rest.starts_with('.')
}

impl RunArguments {
    /// Opens the requested renderer.
    pub fn backend(&self) -> Result<Backend, Error> {
        check_memory("--size", self.size, BYTES_PER_PIXEL)?;
        let sources = self.shaders.as_ref().map(Sources::from_folder).transpose()?;
        if self.backend == BackendName::Cpu {
            return match sources {
                Some(_) => {
                    Err(FieldError::new("--backend", "cpu", "auto or gpu with --shaders: the CPU runs no shaders")
                        .into())
                }
                None => Ok(Backend::Cpu),
            };
        }
        match Headless::new() {
            Ok(gpu) => {
                let most = gpu.device.limits().max_texture_dimension_2d / 2;
                if self.size.max_element() > most {
                    let size = format!("{}x{}", self.size.x, self.size.y);
                    let expected = format!("at most {most}x{most} on {}", gpu.description());
                    return Err(FieldError::new("--size", size, expected).into());
                }
                Backend::on(gpu, sources.as_ref())
            }
            Err(error @ (Error::NoDevice(_) | Error::Device(_)))
                if self.backend == BackendName::Auto && sources.is_none() =>
            {
                print_error(format_args!("rendering on the CPU: {error}"));
                Ok(Backend::Cpu)
            }
            Err(error) => Err(error),
        }
    }
}

/// Adds the option to the field that an error names.
pub fn with_option(option: &str, mut error: FieldError) -> FieldError {
    error.field = format!("{option} {}", error.field);
    error
}

const MAX_SIDE: u32 = 8192;

/// Parses `WxH`, pixels.
///
/// # Errors
/// A line that says what is expected.
pub fn parse_size(text: &str) -> Result<UVec2, String> {
    let expected =
        || format!("{text:?} is not a size; expected WxH, each 1 to {MAX_SIDE} pixels, for example 1280x720");
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(expected)?;
    let side = |digits: &str| digits.parse::<u32>().ok().filter(|side| (1..=MAX_SIDE).contains(side));
    Ok(UVec2::new(side(width).ok_or_else(expected)?, side(height).ok_or_else(expected)?))
}

/// Parses `FIELD=VALUE`.
///
/// # Errors
/// A line that says what is expected.
pub fn parse_assignment(text: &str) -> Result<(String, String), String> {
    let (field, value) = text.split_once('=').ok_or_else(|| {
        format!("{text:?} is not an assignment; expected FIELD=VALUE, for example accumulate.downscale=4")
    })?;
    Ok((field.into(), value.into()))
}

fn parse_time(text: &str) -> Result<f64, String> {
    let time = text.parse().ok().filter(|time: &f64| time.abs() <= f64::from(MAX_TIME));
    time.ok_or_else(|| format!("{text:?} is not a time; expected seconds, -{MAX_TIME} to {MAX_TIME}"))
}

/// Value of `--scale`.
#[derive(Clone, Copy)]
enum ScaleArgument {
    Auto,
    Pixels(u32),
}

impl ScaleArgument {
    fn mode(self) -> ScaleMode {
        match self {
            Self::Auto => ScaleMode::Auto,
            Self::Pixels(_) => ScaleMode::Fixed,
        }
    }

    fn pixels(self) -> Option<String> {
        match self {
            Self::Auto => None,
            Self::Pixels(pixels) => Some(pixels.to_string()),
        }
    }
}

fn parse_scale(text: &str) -> Result<ScaleArgument, String> {
    if text == ScaleMode::Auto.name() {
        return Ok(ScaleArgument::Auto);
    }
    let scale = text.parse().ok().filter(|scale| (1..=16).contains(scale)).map(ScaleArgument::Pixels);
    scale.ok_or_else(|| format!("{text:?} is not a scale; expected 1 to 16 pixels per texel, or auto"))
}

/// Parses a seed.
///
/// # Errors
/// A line that says what is expected.
pub fn parse_seed(text: &str) -> Result<u32, String> {
    text.parse().map_err(|_| format!("{text:?} is not a seed; expected 0 to {}", u32::MAX))
}

/// Parser of a number in a range, which the error names.
pub fn number(range: RangeInclusive<f32>) -> impl TypedValueParser<Value = f32> {
    move |text: &str| {
        let value = text.parse().ok().filter(|value| range.contains(value));
        value.ok_or_else(|| format!("expected a number, {} to {}", range.start(), range.end()))
    }
}

/// Parser of a whole number in a range, which the error names.
pub fn whole_number(range: RangeInclusive<u32>) -> impl TypedValueParser<Value = u32> {
    move |text: &str| {
        let value = text.parse().ok().filter(|value| range.contains(value));
        value.ok_or_else(|| format!("expected a whole number, {} to {}", range.start(), range.end()))
    }
}

/// Parser of a setting enum, by its names in presets.
pub fn choices<T>() -> impl TypedValueParser<Value = T>
where
    T: Choice + Default + FromStr<Err = ParseChoiceError> + Clone + Send + Sync + 'static,
{
    PossibleValuesParser::new(T::default().names()).try_map(|name| name.parse::<T>())
}
