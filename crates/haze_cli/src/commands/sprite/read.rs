//! `haze sprite read`: reads sheets of smoke of any origin.

use std::path::{Path, PathBuf};

use clap::Args;
use glam::UVec2;
use haze::FieldError;
use haze_author::sprite::lint::lint_sprite;
use haze_author::sprite::read::{
    AlphaMode, CodeSpace, DepthWhite, FrameOrder, MAX_FILES, MotionAxes, Observation, Playback, ReadOptions,
    ReadSprite, Role, SecondAlpha, SheetFile, SheetReading, SideOrder, read_sheets,
};
use haze_core::assets::image::read_png;
use haze_core::error::{AssetError, Error};
use haze_export::file_kind::explain_wrong_kind;
use haze_export::options::{choices, number, whole_number};
use haze_export::output::{FileChecks, print_line};
use haze_export::progress::with_progress;
use haze_export::recipe_files::{has_extension, six_way_path};
use haze_preset::write_baked_png;
use image::DynamicImage;

use crate::bake_job::{OverwriteArguments, check_not_painted};

#[derive(Args)]
pub struct Arguments {
    /// PNGs of one flipbook, each a sheet of the same grid: light maps, opacity, normals, motion, emission, depth … Their
    /// contents are found; --role gives them.
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// PNG to write: NAME.png, with NAME.detail.png and, if there are light maps or fire, NAME.six_way.png and
    /// NAME.heat.png.
    #[arg(short, long, value_name = "NAME")]
    output: PathBuf,
    /// Contents of a file: opacity, normals, six_way (two files), motion, emission, heat, depth or color. May be given more
    /// than once.
    #[arg(long, value_name = "ROLE=FILE", value_parser = parse_role)]
    role: Vec<(Role, PathBuf)>,
    /// Columns and rows of frames.
    #[arg(long, value_name = "CxR", value_parser = parse_grid, allow_hyphen_values = true)]
    grid: Option<UVec2>,
    /// Number of frames.
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = whole_number(1..=256))]
    frames: Option<u32>,
    /// Order of frames.
    #[arg(long, value_parser = choices::<FrameOrder>())]
    order: Option<FrameOrder>,
    /// Relation of color to the amount, in light maps or normals.
    #[arg(long, value_parser = choices::<AlphaMode>())]
    alpha: Option<AlphaMode>,
    /// Codes of light maps or normals.
    #[arg(long, value_parser = choices::<CodeSpace>())]
    codes: Option<CodeSpace>,
    /// Green of the normals points down, true or false.
    #[arg(long, num_args = 0..=1, default_missing_value = "true", value_name = "IS_DOWN")]
    y_down: Option<bool>,
    /// Sides in red, green and blue of the first light map and of the second: right,left,top,bottom,back,front in any order.
    #[arg(long, value_name = "SIDES", value_parser = |text: &str| text.parse::<SideOrder>())]
    sides: Option<SideOrder>,
    /// Contents of alpha of the second light map.
    #[arg(long, value_parser = choices::<SecondAlpha>())]
    second_alpha: Option<SecondAlpha>,
    /// Directions of full red and full green of motion vectors: right,down and so on.
    #[arg(long, value_name = "RED,GREEN", value_parser = |text: &str| text.parse::<MotionAxes>())]
    motion: Option<MotionAxes>,
    /// Way of full red or green of motion vectors, as a fraction of a frame's width or height.
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = number(0.0001..=1.0))]
    motion_scale: Option<f32>,
    /// Meaning of white in the depth.
    #[arg(long, value_parser = choices::<DepthWhite>())]
    depth_white: Option<DepthWhite>,
    /// Loop, or a flipbook that plays once.
    #[arg(long, value_parser = choices::<Playback>())]
    playback: Option<Playback>,
    /// Strength of the relief of normals made from alpha or light maps.
    #[arg(long, default_value_t = 1.0, allow_hyphen_values = true, value_parser = number(0.01..=100.0))]
    strength: f32,
    #[command(flatten)]
    overwrite: OverwriteArguments,
}

pub fn run(arguments: &Arguments) -> Result<(), Error> {
    let files = arguments.all_files();
    if files.len() > MAX_FILES {
        let problem = format!("{} files are too many", files.len());
        return Err(FieldError::from_problem("files", problem, format!("at most {MAX_FILES}")).into());
    }
    let output = Outputs::new(&arguments.output);
    let mut checks = FileChecks::for_inputs(&files);
    for path in output.all() {
        checks.check_output("--output", path, "png")?;
    }
    let sheets = files.iter().map(|path| {
        let image = read_png(path).map_err(|error| explain_wrong_kind(error.into(), path, "image", "a PNG"))?;
        Ok(SheetFile::new(path, image.to_rgba8()))
    });
    let sheets = sheets.collect::<Result<Vec<_>, Error>>()?;
    let options = arguments.options(&files);
    let what = format!("haze: reading {}", arguments.output.display());
    let SheetReading { answers, sprite, unread } = with_progress(what, || read_sheets(&sheets, &options))?;
    let observations = answers.observations();
    arguments.check_used(&observations)?;
    check_visible(&output.image, &sprite)?;
    output.write(&sprite, arguments)?;
    for observation in &observations {
        print_line!("  {}", line(observation))?;
    }
    for file in &unread {
        print_line!("  not read: {file}")?;
    }
    for change in &sprite.mended {
        print_line!("  mended: {change}")?;
    }
    if answers.playback.value == Playback::Once {
        print_line!("  it plays once: set sprite.animation to volume")?;
    }
    Ok(())
}

/// Line of a report.
fn line(observation: &Observation) -> String {
    let Observation { text, confidence, option } = observation;
    match confidence {
        None => format!("{text}, as {option} says"),
        Some(confidence) => {
            let percent = (confidence * 100.0).round();
            let advice = if observation.is_sure() { "" } else { " (unsure: look at the result)" };
            format!("{text}, {percent} % sure{advice}; {option} overrides it")
        }
    }
}

/// Refuses sheets that make no sprite, so that nothing is written that `haze sprite check` refuses.
fn check_visible(output: &Path, sprite: &ReadSprite) -> Result<(), Error> {
    let findings = lint_sprite(output, &sprite.image, sprite.layout)?;
    match findings.into_iter().find(|finding| ["empty", "opaque"].contains(&finding.name)) {
        Some(finding) => Err(AssetError::Image { path: output.into(), reason: finding.description }.into()),
        None => Ok(()),
    }
}

/// Files of one sprite.
struct Outputs {
    image: PathBuf,
    detail: PathBuf,
    six_way: PathBuf,
    heat: PathBuf,
}

impl Outputs {
    /// Names the files; `.png` may be left out.
    fn new(name: &Path) -> Self {
        let mut image = name.to_path_buf();
        if !has_extension(name, "png") {
            image.as_mut_os_string().push(".png");
        }
        let with = |extension| image.with_extension(extension);
        Self { detail: with("detail.png"), heat: with("heat.png"), six_way: six_way_path(&image), image }
    }

    fn all(&self) -> [&Path; 4] {
        [&self.image, &self.detail, &self.six_way, &self.heat]
    }

    /// Writes the images, with a line for each, unless one of the files was painted.
    fn write(&self, sprite: &ReadSprite, arguments: &Arguments) -> Result<(), Error> {
        let ReadSprite { image, detail, six_way, heat, layout, side, .. } = sprite;
        let images = [
            (&self.image, Some(DynamicImage::from(image.clone()))),
            (&self.detail, Some(detail.clone().into())),
            (&self.six_way, six_way.clone().map(DynamicImage::from)),
            (&self.heat, heat.clone().map(DynamicImage::from)),
        ];
        let images: Vec<_> = images.into_iter().filter_map(|(path, image)| Some((path, image?))).collect();
        for (path, _) in &images {
            check_not_painted(path, arguments.overwrite.painted_png())?;
        }
        for (path, image) in &images {
            with_progress(format!("haze: writing {}", path.display()), || write_baked_png(path, image))?;
            print_line!("{}: {}x{}", path.display(), image.width(), image.height())?;
        }
        let frames = layout.columns * layout.rows;
        print_line!("  {frames} frames of {side}x{side}, {} columns and {} rows", layout.columns, layout.rows)
    }
}

impl Arguments {
    /// Returns the files, and those that only --role names.
    fn all_files(&self) -> Vec<PathBuf> {
        let mut files = self.files.clone();
        for (_, file) in &self.role {
            if !files.contains(file) {
                files.push(file.clone());
            }
        }
        files
    }

    fn options(&self, files: &[PathBuf]) -> ReadOptions {
        let role = |file: &PathBuf| self.role.iter().rev().find(|(_, named)| named == file).map(|(role, _)| *role);
        ReadOptions {
            roles: files.iter().map(role).collect(),
            cells: self.grid,
            frames: self.frames,
            order: self.order,
            alpha: self.alpha,
            space: self.codes,
            y_down: self.y_down,
            sides: self.sides,
            second_alpha: self.second_alpha,
            motion: self.motion,
            motion_scale: self.motion_scale,
            depth_white: self.depth_white,
            playback: self.playback,
            strength: self.strength,
        }
    }

    /// Refuses options about what the files do not have.
    ///
    /// # Errors
    /// Names the option.
    fn check_used(&self, observations: &[Observation]) -> Result<(), Error> {
        let given = [
            ("--alpha", self.alpha.is_some(), "light maps or normals"),
            ("--codes", self.codes.is_some(), "light maps or normals"),
            ("--y-down", self.y_down.is_some(), "normals"),
            ("--sides", self.sides.is_some(), "two light maps"),
            ("--second-alpha", self.second_alpha.is_some(), "a second light map with alpha"),
            ("--motion", self.motion.is_some(), "motion vectors"),
            ("--motion-scale", self.motion_scale.is_some(), "motion vectors"),
            ("--depth-white", self.depth_white.is_some(), "depth"),
        ];
        let is_unused = |option: &str| observations.iter().all(|observation| observation.option != option);
        match given.into_iter().find(|(option, is_given, _)| *is_given && is_unused(option)) {
            Some((option, _, what)) => {
                let problem = format!("has no effect: no file has {what}");
                Err(FieldError::from_problem(option, problem, format!("such files, or no {option}")).into())
            }
            None => Ok(()),
        }
    }
}

fn parse_grid(text: &str) -> Result<UVec2, String> {
    let count = |digits: &str| digits.parse().ok().filter(|count| (1..=64).contains(count));
    let grid = text.split_once(['x', 'X']).and_then(|(columns, rows)| Some(UVec2::new(count(columns)?, count(rows)?)));
    grid.ok_or_else(|| format!("{text:?} is no grid; expected CxR, columns and rows of 1 to 64, for example 8x8"))
}

fn parse_role(text: &str) -> Result<(Role, PathBuf), String> {
    let expected = || {
        let names = Role::NAMES.join(", ");
        format!("{text:?} is no role of a file; expected ROLE=FILE with one of {names}")
    };
    let (role, file) = text.split_once('=').filter(|(_, file)| !file.is_empty()).ok_or_else(expected)?;
    Ok((role.parse().map_err(|_| expected())?, file.into()))
}
