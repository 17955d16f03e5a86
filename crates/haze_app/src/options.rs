//! What several subcommands take: a preset and changes to it, a size, a backend.

use std::cell::RefCell;
use std::path::PathBuf;
use std::str::FromStr;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};
use glam::{UVec2, Vec4};
use haze::picture::Picture;
use haze::picture::{Effort, write_png};
use haze::preset::{PictureFolders, Preset};
use haze::settings::{Choice, Path, Technique, set_field};
use haze::shader::Sources;
use haze::{Error, FieldError};
use haze_demo::headless::Headless;
use haze_demo::shot::Shot;
use haze_demo::stage::{Stage, StageContext};
use image::RgbImage;

use super::inputs::pictures_of;
use super::memory::check_memory;
use super::output::{Files, complain, say};

/// How a picture is drawn, whatever it shows.
#[derive(Args)]
pub struct RunArguments {
    /// Size of the picture, pixels.
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = parse_size, allow_hyphen_values = true)]
    pub size: UVec2,
    /// How smoke reaches the picture; the preset's own if not given.
    #[arg(long, value_parser = choices::<Path>())]
    pub path: Option<Path>,
    /// Which renderer.
    #[arg(long, value_enum, default_value = "auto")]
    backend: BackendName,
    /// A folder like haze's own `shaders`: its files take the place of those of the same names that the program has in it.
    #[arg(long, value_name = "DIR")]
    shaders: Option<PathBuf>,
}

/// A preset, and what is changed about it for this run.
#[derive(Args)]
pub struct ShotArguments {
    /// A built-in preset's name (see `haze preset list`), or the path of a JSON file.
    #[arg(default_value = "column")]
    preset: PathBuf,
    #[command(flatten)]
    pub run: RunArguments,
    /// Seconds into the emission; the preset's own if not given.
    #[arg(long, value_name = "S", value_parser = parse_time, allow_hyphen_values = true)]
    time: Option<f32>,
    /// Pixels per texel of the accumulation target, 1 to 16; the preset's own if not given.
    #[arg(long, value_name = "N", value_parser = parse_scale, allow_hyphen_values = true)]
    scale: Option<u32>,
    /// How sprites meet the scene; the preset's own if not given.
    #[arg(long, value_name = "T", value_parser = choices::<Technique>())]
    pub technique: Option<Technique>,
    /// Seed of every emitter; the preset's own if not given.
    #[arg(long, value_name = "N", value_parser = parse_seed, allow_hyphen_values = true)]
    seed: Option<u32>,
    /// Sets a field of the preset, by its name or the end of it: `accumulate.scale=4`, `lights[0].intensity=30`. May be given
    /// more than once.
    #[arg(long, value_name = "FIELD=VALUE", value_parser = parse_assignment)]
    set: Vec<(String, String)>,
    /// The PNG to write.
    #[arg(short, long, value_name = "FILE.png")]
    pub output: PathBuf,
    #[command(flatten)]
    assets: AssetsArguments,
    /// Take a second more to make the file a tenth smaller.
    #[arg(long)]
    small: bool,
}

/// A folder of files that presets share.
#[derive(Args, Clone, Debug, Default)]
pub struct AssetsArguments {
    /// A folder in which pictures and particle files are looked for that are not beside the preset.
    #[arg(long, value_name = "DIR")]
    assets: Option<PathBuf>,
}

impl AssetsArguments {
    /// The folder.
    ///
    /// # Errors
    /// Where it is none.
    pub fn folder(&self) -> Result<Option<PathBuf>, Error> {
        match &self.assets {
            Some(folder) if !folder.is_dir() => {
                Err(FieldError::new("--assets", folder.display(), "a folder that exists").into())
            }
            folder => Ok(folder.clone()),
        }
    }

    /// Where the files of a preset are looked for.
    ///
    /// # Errors
    /// As [`AssetsArguments::folder`].
    pub fn folders(&self, preset: &std::path::Path) -> Result<PictureFolders, Error> {
        Ok(PictureFolders::beside(preset).and_shared(self.folder()?))
    }
}

/// The renderers.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum BackendName {
    /// The GPU where there is one, else the CPU.
    Auto,
    /// The GPU, or fail.
    Gpu,
    /// The reference renderer: slow, and the same everywhere.
    Cpu,
}

/// The renderer in use.
pub enum Backend {
    Gpu(Box<Gpu>),
    Cpu,
}

/// A device, and what draws on it, from picture to picture.
pub struct Gpu {
    pub headless: Headless,
    pub context: StageContext,
    stage: RefCell<Stage>,
}

impl ShotArguments {
    /// Loads the preset, or the default, and applies the changes. Refuses an output that cannot be written, `--output` or
    /// another that comes with the option which asks for it.
    pub fn load(&self, others: &[(&str, PathBuf)]) -> Result<Shot, Error> {
        let output = ("--output", self.output.clone());
        self.load_for(&[&[output], others].concat(), "png")
    }

    /// The same for outputs in place of `--output`, whose names end in `kind`.
    pub fn load_for(&self, outputs: &[(&str, PathBuf)], kind: &str) -> Result<Shot, Error> {
        let mut preset = Preset::load(&self.preset)?;
        for system in &mut preset.systems {
            system.emitter.seed = self.seed.unwrap_or(system.emitter.seed);
            system.settings.accumulate.scale = self.scale.unwrap_or(system.settings.accumulate.scale);
            system.settings.path = self.run.path.unwrap_or(system.settings.path);
            system.settings.technique = self.technique.unwrap_or(system.settings.technique);
        }
        preset.time = self.time.unwrap_or(preset.time);
        for (field, value) in &self.set {
            set_field(&mut preset, field, value).map_err(|error| in_option("--set", error))?;
        }
        let shot = self.shot(preset)?;
        let pictures = pictures_of(&self.assets.folders(&self.preset)?, &shot.preset);
        let mut files = Files::read(pictures.iter().map(PathBuf::as_path).chain([self.preset.as_path()]));
        outputs.iter().try_for_each(|(option, path)| files.write(option, path, kind))?;
        Ok(shot)
    }

    /// A shot of the preset, changed.
    pub fn shot(&self, preset: Preset) -> Result<Shot, Error> {
        preset.validate()?;
        Shot::from_folders(preset, &self.preset, &self.assets.folders(&self.preset)?, self.run.size)
    }

    /// How much work the size of files is worth.
    pub fn effort(&self) -> Effort {
        if self.small { Effort::Small } else { Effort::Quick }
    }

    /// Writes the picture, and says so.
    pub fn write(&self, picture: RgbImage, shot: &Shot, backend: &Backend) -> Result<(), Error> {
        write_png(&self.output, &picture.into(), self.effort())?;
        say!("{}: {} on {}", self.output.display(), shot.preset.name, backend.description())
    }
}

impl RunArguments {
    /// Opens the renderer that was asked for.
    pub fn backend(&self) -> Result<Backend, Error> {
        check_memory("--size", self.size)?;
        let sources = self.shaders.as_ref().map(Sources::from_folder).transpose()?;
        if self.backend == BackendName::Cpu {
            return match sources {
                Some(_) => {
                    Err(FieldError::new("--shaders", "with --backend cpu", "a GPU: the CPU runs no shaders").into())
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
            Err(Error::NoDevice(reason)) if self.backend == BackendName::Auto && sources.is_none() => {
                complain(format_args!("rendering on the CPU: {reason}"));
                Ok(Backend::Cpu)
            }
            Err(error) => Err(error),
        }
    }
}

impl Backend {
    /// The GPU where there is one, else the CPU, which draws without an author's shaders only.
    pub fn open(sources: Option<&Sources>) -> Result<Self, Error> {
        match Headless::new() {
            Ok(gpu) => Self::on(gpu, sources),
            Err(Error::NoDevice(_)) if sources.is_none() => Ok(Self::Cpu),
            Err(error) => Err(error),
        }
    }

    fn on(gpu: Headless, sources: Option<&Sources>) -> Result<Self, Error> {
        let mut context = StageContext::new(&gpu.adapter, &gpu.device, &gpu.queue);
        if let Some(sources) = sources {
            context = context.with_shaders(sources)?;
        }
        let stage = RefCell::new(Stage::new(&context, false)?);
        Ok(Self::Gpu(Box::new(Gpu { headless: gpu, context, stage })))
    }

    /// Renders, linear HDR.
    pub fn render(&self, shot: &Shot) -> Result<Picture<Vec4>, Error> {
        match self {
            Self::Gpu(gpu) => {
                let mut stage = gpu.stage.borrow_mut();
                stage.warm_up(shot)?;
                stage.draw(&gpu.headless, shot)?;
                stage.read(&gpu.headless, shot)
            }
            Self::Cpu => shot.render_on_cpu(),
        }
    }

    /// What renders, in one line.
    pub fn description(&self) -> String {
        match self {
            Self::Gpu(gpu) => gpu.headless.description(),
            Self::Cpu => "the CPU renderer".into(),
        }
    }
}

/// A mistake in what an option sets.
pub fn in_option(option: &str, mut error: FieldError) -> FieldError {
    error.field = format!("{option} {}", error.field);
    error
}

const LARGEST: u32 = 8192;

pub fn parse_size(text: &str) -> Result<UVec2, String> {
    let expected = || format!("{text:?} is not a size; expected WxH, each 1 to {LARGEST} pixels, for example 1280x720");
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(expected)?;
    let side = |digits: &str| digits.parse::<u32>().ok().filter(|side| (1..=LARGEST).contains(side));
    Ok(UVec2::new(side(width).ok_or_else(expected)?, side(height).ok_or_else(expected)?))
}

pub fn parse_assignment(text: &str) -> Result<(String, String), String> {
    let (field, value) = text.split_once('=').ok_or_else(|| {
        format!("{text:?} sets nothing; expected a field and its value, for example accumulate.scale=4")
    })?;
    Ok((field.into(), value.into()))
}

fn parse_time(text: &str) -> Result<f32, String> {
    let limit = 1.0e5;
    let time = text.parse().ok().filter(|time: &f32| time.abs() <= limit);
    time.ok_or_else(|| format!("{text:?} is not a time; expected seconds, -{limit} to {limit}"))
}

fn parse_scale(text: &str) -> Result<u32, String> {
    let scale = text.parse().ok().filter(|scale| (1..=16).contains(scale));
    scale.ok_or_else(|| format!("{text:?} is not a scale; expected 1 to 16 pixels"))
}

fn parse_seed(text: &str) -> Result<u32, String> {
    text.parse().map_err(|_| format!("{text:?} is not a seed; expected 0 to {}", u32::MAX))
}

/// A setting enum by the names that it has in presets.
pub fn choices<T>() -> impl TypedValueParser<Value = T>
where
    T: Choice + Default + FromStr<Err = FieldError> + Clone + Send + Sync + 'static,
{
    PossibleValuesParser::new(T::default().names()).try_map(|name| name.parse::<T>())
}
