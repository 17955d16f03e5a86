//! `haze sprite import`: makes a sprite from an image of another kind.

use std::path::{Path, PathBuf};

use clap::Args;
use glam::UVec2;
use haze::FieldError;
use haze_author::finding::Finding;
use haze_author::sprite::import_sprite::{ImportSource, ImportedSprite, arrange_sheet, import_sprite};
use haze_author::sprite::lint::lint_sprite;
use haze_author::sprite::y_direction::MIN_CONFIDENCE;
use haze_core::assets::image::read_png;
use haze_core::assets::sprite::SpriteLayout;
use haze_core::error::{AssetError, Error};
use haze_preset::{CompressionEffort, write_png};

use haze_export::options::{choices, number, whole_number};
use haze_export::output::{FileChecks, print_line};
use haze_export::recipe_files::six_way_path;

#[derive(Args)]
pub struct Arguments {
    /// PNGs: one sheet, one file per frame in their order, or the two sheets of six-way light maps, with a third, gray, if
    /// neither has the opacity in alpha. Files whose names differ only by a number are sorted by it.
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// PNG to write.
    #[arg(short, long, value_name = "FILE.png")]
    output: PathBuf,
    /// Contents of the files.
    #[arg(long = "from", value_name = "SOURCE", value_parser = choices::<ImportSource>(), default_value = "normals")]
    source: ImportSource,
    /// Frames per row of the sheet.
    #[arg(long, default_value_t = 1, allow_hyphen_values = true, value_parser = whole_number(1..=256))]
    columns: u32,
    /// Rows of frames of the sheet.
    #[arg(long, default_value_t = 1, allow_hyphen_values = true, value_parser = whole_number(1..=256))]
    rows: u32,
    /// Green of the normals points down, true or false. Default: guessed from the image.
    #[arg(long, num_args = 0..=1, default_missing_value = "true", value_name = "IS_DOWN")]
    y_down: Option<bool>,
    /// Strength of the relief of normals made from heights, alpha or light maps.
    #[arg(long, default_value_t = 1.0, allow_hyphen_values = true, value_parser = number(0.01..=100.0))]
    strength: f32,
}

pub fn run(arguments: &Arguments) -> Result<(), Error> {
    let Arguments { files, output, source, columns, rows, y_down, strength } = arguments;
    let mut read = FileChecks::for_inputs(files);
    read.check_output("--output", output, "png")?;
    if source.needs_two_images() {
        read.check_output("--output", &six_way_path(output), "png")?;
    }
    if y_down.is_some() && *source != ImportSource::Normals {
        let problem = format!("has no effect with --from {}", source.name());
        let expected = "--from normals: other sources have no green direction";
        return Err(FieldError::from_problem("--y-down", problem, expected).into());
    }
    if files.len() > 1 && !source.needs_two_images() && (*columns, *rows) != (1, 1) {
        let problem = format!("{columns}x{rows} is given for {} files", files.len());
        let expected = "1x1: each of several files is one frame";
        return Err(FieldError::from_problem("--columns and --rows", problem, expected).into());
    }
    let files = by_number(files);
    let images = files.iter().map(|&path| Ok((path, read_png(path)?.to_rgba8())));
    let images = images.collect::<Result<Vec<_>, Error>>()?;
    let path = files.first().copied().unwrap_or(Path::new(""));
    let (sheets, grid) = if images.len() > 1 && !source.needs_two_images() {
        let (sheet, grid) = arrange_sheet(&images)?;
        (vec![sheet], grid)
    } else {
        (images.into_iter().map(|(_, image)| image).collect(), UVec2::new(*columns, *rows))
    };
    let layout = SpriteLayout { columns: grid.x, rows: grid.y, y_down: false };
    let ImportedSprite { image, six_way, y_direction, emission, not_normals, border } =
        import_sprite(path, &sheets, *source, layout, *y_down, *strength)?;
    let findings = lint_sprite(output, &image, layout)?;
    if let Some(reason) = refusal(*source, not_normals, &findings) {
        return Err(Error::from(AssetError::Image { path: path.into(), reason }));
    }
    write_png(output, &image.into(), CompressionEffort::Small)?;
    print_line!("{}: {}x{} frames", output.display(), grid.x, grid.y)?;
    if let Some(maps) = six_way {
        let path = six_way_path(output);
        write_png(&path, &maps.into(), CompressionEffort::Small)?;
        print_line!("{}: the light maps, for lighting six_way", path.display())?;
    }
    if let Some(emission) = emission {
        print_line!(
            "  alpha of the second map, up to {emission}, is not the amount and was left out: a sprite has no place for \
             emission; a system glows by its settings `fire`"
        )?;
    }
    if let Some((frame, alpha)) = border {
        print_line!("  border: alpha up to {alpha} in frame {frame} was cleared; leave more room around the smoke")?;
    }
    for Finding { description, .. } in findings.iter().filter(|finding| !["y_down", "normals"].contains(&finding.name))
    {
        print_line!("  {description}")?;
    }
    let direction = |is_down| if is_down { "down and was flipped" } else { "up" };
    match (y_down, y_direction) {
        (Some(is_down), _) => print_line!("  green points {}, as --y-down says", direction(*is_down)),
        (None, Some(found)) if found.confidence >= MIN_CONFIDENCE => {
            let sure = (found.confidence * 100.0).round();
            print_line!(
                "  green points {}: a guess, {sure} % sure; set --y-down if it is wrong",
                direction(found.is_down)
            )
        }
        (None, Some(_)) => {
            print_line!("  green is assumed to point up, because the image does not tell; set --y-down if it is wrong")
        }
        (None, None) => Ok(()),
    }
}

/// Returns the reason why an image makes no sprite, so that nothing is written that `haze sprite check` refuses.
fn refusal(source: ImportSource, not_normals: Option<&str>, findings: &[Finding]) -> Option<String> {
    // Normals from light maps lean to the sides that were lit, which the check takes for colors.
    let kinds: &[&str] = if source.needs_two_images() { &["empty"] } else { &["normals", "empty"] };
    let useless = findings.iter().find(|finding| kinds.contains(&finding.name));
    let opaque = findings.iter().find(|finding| finding.name == "opaque");
    if let (None, None, Some(opaque)) = (not_normals, useless, opaque) {
        return Some(opaque.description.clone());
    }
    let found = not_normals.or(useless.map(|finding| finding.description.as_str()))?;
    let problem = found.split("; ").next().unwrap_or(found);
    Some(match source {
        ImportSource::Normals => {
            format!(
                "{problem}; expected normals, or --from with the contents of the image: height, alpha or light maps"
            )
        }
        ImportSource::Height => {
            "these heights make no puff; expected a puff that is highest in its middle, or --from alpha".into()
        }
        ImportSource::Alpha | ImportSource::SixWayUnity | ImportSource::SixWayRltBbf => {
            format!("{problem}; expected a puff in the middle of each frame")
        }
    })
}

/// Sorts frames by number if their names differ by nothing else: shells put `smoke_10.png` before `smoke_9.png`.
fn by_number(files: &[PathBuf]) -> Vec<&Path> {
    let split = |path: &Path| {
        let stem = path.file_stem()?.to_str()?;
        let name = stem.trim_end_matches(|c: char| c.is_ascii_digit());
        Some((path.with_file_name(name), stem[name.len()..].parse::<u64>().ok()?))
    };
    let name = |path| split(path).map(|(name, _)| name);
    let mut frames: Vec<_> = files.iter().map(PathBuf::as_path).collect();
    if frames.iter().all(|frame| name(frame).is_some() && name(frame) == name(frames[0])) {
        frames.sort_by_key(|frame| split(frame).map(|(_, number)| number));
    }
    frames
}
