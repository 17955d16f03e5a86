//! `haze preset`: list, check, show, new, layers, add-system, schema, settings.

mod add_system;
mod preset_copy;

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use glam::UVec2;
use haze::{FieldError, Light};
use haze_author::preset::{check_files, no_effect_reason};
use haze_core::error::Error;
use haze_core::settings::{FieldValue, field_values};
use haze_preset::layers::layers;
use haze_preset::{Preset, PresetSystem, Track, builtin};

use haze_export::file_kind::explain_wrong_kind;
use haze_export::named_preset::NamedPreset;
use haze_export::options::AssetsArguments;
use haze_export::output::{Failures, print_line, write_text};
use haze_export::recipe_files::has_extension;
use haze_export::share_link::fragment_of_name;

use preset_copy::write_preset;

#[derive(Args)]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
}

/// Image size that presets are checked for.
const SIZE: UVec2 = UVec2::new(1280, 720);

#[derive(Subcommand)]
enum Command {
    /// List the built-in presets.
    List,
    /// Load presets and their files, and report errors, doubtful values, the use of columns of particle files, and
    /// settings without effect.
    Check {
        /// Names, paths or links of presets.
        #[arg(required = true)]
        presets: Vec<PathBuf>,
        #[command(flatten)]
        assets: AssetsArguments,
    },
    /// Print every setting of a preset with its value, its default, and the reason if it has no effect.
    Show {
        /// Name, path or link of a preset.
        preset: PathBuf,
        /// Only settings that differ from their defaults.
        #[arg(long)]
        changed: bool,
    },
    /// Create a preset as a copy of another, with the images that it uses.
    New {
        /// File to write; .json is added to a name without extension.
        file: PathBuf,
        /// Preset to copy: a name, a path, or a link, whose ramps are written beside the file. Default: column.
        #[arg(long, value_name = "PRESET")]
        from: Option<PathBuf>,
    },
    /// List the layers that `add-system` adds.
    Layers,
    /// Add a particle system from the shelf of layers, such as sparks, to a preset.
    AddSystem(add_system::Arguments),
    /// Print the JSON schema of preset files.
    Schema,
    /// Print every setting with its range and default, as Markdown.
    Settings,
}

pub fn run(arguments: &Arguments) -> Result<(), Failures> {
    match &arguments.command {
        Command::List => {
            let mut lines = Vec::new();
            for builtin in builtin::PRESETS {
                let preset = Preset::load(builtin.name).map_err(Error::from)?;
                lines.push((builtin.name, preset.description));
            }
            print_descriptions(&lines)?;
        }
        Command::Check { presets, assets } => {
            let mut failures = Vec::new();
            for path in presets {
                let (wrong, notes) = check(path, assets).unwrap_or_else(|error| (vec![error], Vec::new()));
                if wrong.is_empty() || !notes.is_empty() {
                    print_line!("{}: {}", path.display(), if wrong.is_empty() { "good" } else { "bad" })?;
                }
                notes.iter().try_for_each(|note| print_line!("  {note}"))?;
                failures.extend(wrong);
            }
            return Failures::new(failures).into_result();
        }
        Command::Show { preset, changed } => show(&NamedPreset::load(preset, None)?.preset, *changed)?,
        Command::New { file, from } => new(file, from.as_deref())?,
        Command::Layers => {
            let lines: Vec<_> = layers().iter().map(|layer| (layer.name, layer.description.clone())).collect();
            print_descriptions(&lines)?;
        }
        Command::AddSystem(arguments) => add_system::run(arguments)?,
        Command::Schema => write_text(haze_author::preset::schema())?,
        Command::Settings => write_text(haze_author::preset::settings_page().trim_end())?,
    }
    Ok(())
}

/// Prints names, each with its description.
fn print_descriptions(lines: &[(&str, String)]) -> Result<(), Error> {
    let width = lines.iter().map(|(name, _)| name.len()).max().unwrap_or_default();
    lines.iter().try_for_each(|(name, description)| print_line!("{name:<width$}  {description}"))
}

/// Loads a preset and its files as rendering does. Returns all errors, and notes on values that may be unintended.
fn check(path: &Path, assets: &AssetsArguments) -> Result<(Vec<Error>, Vec<String>), Error> {
    let named = NamedPreset::load(path, assets.folder()?);
    let NamedPreset { preset, path, folders, .. } =
        named.map_err(|error| explain_wrong_kind(error, path, "preset", "a preset"))?;
    let (wrong, mut notes) = check_files(&preset, &path, &folders);
    let settings = settings(&preset);
    let changed = settings.iter().filter(|setting| !setting.is_default() || setting.track.is_some());
    let note = |setting: &Setting| Some(format!("{} has no effect: {}", setting.path, setting.no_effect_reason?));
    notes.extend(changed.filter_map(note));
    Ok((wrong.into_iter().map(Error::from).collect(), notes))
}

/// A setting of a preset.
struct Setting {
    path: String,
    value: FieldValue,
    default: FieldValue,
    /// Reason why it has no effect, at any time.
    no_effect_reason: Option<&'static str>,
    track: Option<Track>,
}

impl Setting {
    fn is_default(&self) -> bool {
        self.value == self.default
    }
}

fn settings(preset: &Preset) -> Vec<Setting> {
    let plain = Preset {
        lights: vec![Light::default(); preset.lights.len()],
        systems: vec![PresetSystem::default(); preset.systems.len()],
        ..Preset::default()
    };
    let moments = moments(preset);
    let size = SIZE;
    let pairs = field_values(preset).into_iter().zip(field_values(&plain));
    let setting = |((path, value), (_, default)): ((String, FieldValue), (String, FieldValue))| {
        let reasons = moments.iter().map(|moment| no_effect_reason(moment, &path, size));
        let no_effect_reason = reasons.collect::<Option<Vec<_>>>().and_then(|reasons| reasons.first().copied());
        let track = preset.animation.iter().find(|track| track.setting == path).cloned();
        Setting { path, value, default, no_effect_reason, track }
    };
    pairs.map(setting).collect()
}

/// Returns the preset at its own time and at those of its keyframes.
fn moments(preset: &Preset) -> Vec<Preset> {
    let keys = preset.animation.iter().flat_map(|track| &track.keys);
    let mut times: Vec<_> = keys.map(|key| f64::from(key.time)).collect();
    times.push(preset.time);
    times.sort_by(f64::total_cmp);
    times.dedup();
    times.into_iter().map(|time| preset.evaluate(time)).collect()
}

/// Describes a track: `keyframes at 0, 2.5 s; flickers`.
fn described(track: &Track) -> String {
    let times: Vec<_> = track.keys.iter().map(|key| key.time.to_string()).collect();
    let keys = if times.is_empty() { String::new() } else { format!("; keyframes at {} s", times.join(", ")) };
    keys + if track.flicker.amount > 0.0 { "; flickers" } else { "" }
}

fn show(preset: &Preset, changed: bool) -> Result<(), Error> {
    let settings = settings(preset);
    let wide = settings.iter().map(|setting| setting.path.len()).max().unwrap_or_default();
    for setting in settings.iter().filter(|setting| !(changed && setting.is_default() && setting.track.is_none())) {
        let text = |value: &FieldValue| match value {
            // JSON has no infinity.
            FieldValue::Number(number) if !number.is_finite() => number.to_string(),
            value => serde_json::to_string(value).unwrap_or_default(),
        };
        let mark = if setting.is_default() { "default".into() } else { format!("default {}", text(&setting.default)) };
        let no_effect = setting.no_effect_reason.map(|reason| format!("; no effect: {reason}")).unwrap_or_default();
        let track = setting.track.as_ref().map(described).unwrap_or_default();
        print_line!("{:<wide$}  {:<22} {mark}{track}{no_effect}", setting.path, text(&setting.value))?;
    }
    Ok(())
}

/// Writes a copy of a preset, and of its images beside it.
fn new(file: &Path, from: Option<&Path>) -> Result<(), Error> {
    if fragment_of_name(file).is_some() {
        let problem = "it is a link";
        return Err(FieldError::from_problem("FILE", problem, "a name that ends in .json, then --from LINK").into());
    }
    let path = if file.extension().is_none() { file.with_extension("json") } else { file.into() };
    if !has_extension(&path, "json") {
        return Err(FieldError::new("FILE", path.display(), "a name that ends in .json").into());
    }
    if path.symlink_metadata().is_ok() {
        let problem = format!("{} exists already", path.display());
        return Err(
            FieldError::from_problem("FILE", problem, "a name that does not exist yet: no file is replaced").into()
        );
    }
    let more = if from.is_none() { "; --from copies another" } else { "" };
    let from = from.unwrap_or(Path::new("column"));
    let mut named = NamedPreset::load(from, None)?;
    if let Some(name) = path.file_stem() {
        named.preset.name = name.to_string_lossy().into_owned();
    }
    write_preset(&path, &named.preset.to_json(""), &named)?;
    print_line!("{}: a copy of {}{more}; open it with `haze {0}`", path.display(), named.path.display())
}
