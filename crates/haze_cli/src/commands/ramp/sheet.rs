//! `haze ramp sheet`: renders one shot with every ramp.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;
use glam::UVec2;
use haze::{FieldError, MaterialAssets};
use haze_core::assets::ramp::{Ramp, RampRole};
use haze_core::error::{AssetError, Error};
use haze_core::settings::{Backlight, CoverageMode, DiffuseMode, RenderPath, SoftScatterMode};
use haze_demo::shot::Shot;
use haze_export::image_export::{ExportProgress, MAX_SHEET_CELLS, column_count, render_sheet};
use haze_export::options::{ShotArguments, choices};
use haze_export::output::{Failures, FileChecks, print_error};
use haze_export::recipe_files::{has_extension, image_path};
use haze_preset::builtin;
use pollster::block_on;

use super::ramp_image::ramp_image;
use super::ramp_io::{is_recipe, load_ramp_image};

#[derive(Args)]
#[command(mut_arg("size", |size| size.help("Size of all images together in pixels, without margins; each image is this size divided by the number of columns")))]
pub struct Arguments {
    #[command(flatten)]
    shot: ShotArguments,
    /// Folder of ramps: PNGs, and recipes without a PNG. Default: the built-in ramps.
    #[arg(long, value_name = "DIR")]
    ramps: Option<PathBuf>,
    /// Also show the built-in ramps.
    #[arg(long)]
    builtin: bool,
    /// Only ramps of this role, and ramps whose names do not tell their role.
    #[arg(long, value_name = "ROLE", value_parser = choices::<RampRole>())]
    role: Option<RampRole>,
}

/// Divisor of an image's sides that gives the size of a ramp with two axes.
const INSET_DIVISOR: u32 = 4;
/// Divisor of an image's height that gives the height of a ramp with one axis.
const STRIP_DIVISOR: u32 = 10;

/// A ramp on the sheet.
struct Cell {
    name: String,
    role: RampRole,
    source: Source,
}

enum Source {
    File(PathBuf),
    Builtin(&'static builtin::Builtin),
}

pub fn run(arguments: &Arguments) -> Result<(), Failures> {
    let cells = arguments.cells()?;
    let base = arguments.shot.load(&[])?;
    let read = cells.iter().filter_map(|cell| match &cell.source {
        Source::File(path) => Some(path),
        Source::Builtin(_) => None,
    });
    FileChecks::for_inputs(read).check_output("--output", &arguments.shot.output, "png")?;
    let (ramps, left_out) = Failures::of_each(&cells, |cell| Ok((cell, cell.ramp()?)));
    if ramps.is_empty() {
        return left_out.into_result();
    }
    left_out.errors().iter().for_each(print_error);
    let columns = column_count(ramps.len());
    let size = (arguments.shot.run.size / columns).max(UVec2::ONE);
    let mut shots = Vec::new();
    for (cell, ramp) in &ramps {
        let mut shot = Shot { size, ..base.at_its_time().into_owned() };
        apply_ramp(&mut shot, cell.role, ramp);
        shots.push((cell.name.clone(), shot));
    }
    let backend = arguments.shot.run.backend()?;
    let mut sheet =
        block_on(render_sheet(&backend, &shots, columns, &arguments.shot.output, &ExportProgress::terminal()))?;
    for (index, (cell, ramp)) in (0..).zip(&ramps) {
        let has_two_axes = matches!(cell.role, RampRole::Specular | RampRole::Shadow);
        let inset = if has_two_axes { size / INSET_DIVISOR } else { UVec2::new(size.x, size.y / STRIP_DIVISOR) };
        sheet.inset(index, &ramp_image(ramp, inset));
    }
    sheet.add_footer(&format!("{}, {}x{}, {}", base.preset.name, size.x, size.y, backend.description()));
    arguments.shot.write(sheet.image, &base, &backend)?;
    // Ramps that were left out have been reported.
    if left_out.errors().is_empty() { Ok(()) } else { Err(Failures::default()) }
}

impl Arguments {
    /// Returns the requested ramps: built-in ones, then files, sorted by name.
    fn cells(&self) -> Result<Vec<Cell>, Error> {
        let mut cells = Vec::new();
        let mut unnamed = Vec::new();
        let mut add = |name: &str, source| {
            // A motif is another kind of image.
            let named = RampRole::from_name(name).or(self.role.filter(|_| !name.starts_with("motif_")));
            if let Some(role) = named.filter(|role| self.role.is_none_or(|wanted| wanted == *role)) {
                cells.push(Cell { name: name.into(), role, source });
            } else if let (None, false, Source::File(path)) = (named, name.starts_with("motif_"), source) {
                unnamed.push(path);
            }
        };
        if self.ramps.is_none() || self.builtin {
            builtin::RAMPS.iter().for_each(|ramp| add(ramp.name, Source::Builtin(ramp)));
        }
        for path in self.ramps.iter().map(|folder| ramp_files(folder)).collect::<Result<Vec<_>, _>>()?.concat() {
            let name = path.file_name().map(OsStr::to_string_lossy).unwrap_or_default();
            let name = name.split('.').next().unwrap_or_default();
            add(name, Source::File(path.clone()));
        }
        for path in &unnamed {
            let roles: Vec<_> = RampRole::ALL.iter().map(|role| format!("{}_", role.name())).collect();
            print_error(format!(
                "{}: left out, because its name tells no role of a ramp; expected a name that begins with {}, or --role",
                path.display(),
                roles.join(", ")
            ));
        }
        if cells.is_empty() || cells.len() > MAX_SHEET_CELLS {
            let folder = self.ramps.as_ref().map_or("the built-in set".into(), |folder| folder.display().to_string());
            let named = "whose names begin with their role, such as diffuse_";
            let which = self.role.map_or(named.into(), |role| format!("for {}", role.name()));
            let problem = format!("{folder} has {} ramps {which}", cells.len());
            return Err(FieldError::from_problem("--ramps", problem, format!("1 to {MAX_SHEET_CELLS}")).into());
        }
        Ok(cells)
    }
}

/// Returns the PNGs in a folder, and the recipes without a PNG, sorted by name.
fn ramp_files(folder: &Path) -> Result<Vec<PathBuf>, Error> {
    if folder.is_file() {
        return Err(FieldError::new("--ramps", folder.display(), "a folder").into());
    }
    let failed = |error| Error::from(AssetError::Io { path: folder.into(), error });
    let entries: Result<Vec<_>, _> = fs::read_dir(folder).map_err(failed)?.collect();
    let mut files: Vec<_> = entries.map_err(failed)?.into_iter().map(|entry| entry.path()).collect();
    files.retain(|path| has_extension(path, "png") || is_recipe(path) && !image_path(path).exists());
    files.sort();
    Ok(files)
}

impl Cell {
    fn ramp(&self) -> Result<Ramp, Error> {
        match &self.source {
            Source::File(path) => Ok(Ramp::from_image(&load_ramp_image(path)?.0)),
            Source::Builtin(builtin) => Ok(builtin.ramp()?),
        }
    }
}

/// Puts a ramp into a shot, and changes the settings so that the ramp is used.
fn apply_ramp(shot: &mut Shot, role: RampRole, ramp: &Ramp) {
    for (system, material) in shot.preset.systems.iter_mut().zip(&mut shot.materials) {
        let settings = &mut system.settings;
        let MaterialAssets {
            diffuse_ramp,
            backlight_ramp,
            shadow_ramp,
            soft_scatter_ramp,
            specular_ramp,
            coverage_ramp,
            age_ramp,
            heat_ramp,
            fire_ramp,
            ..
        } = material;
        let position = match role {
            RampRole::Diffuse => {
                if settings.diffuse.mode == DiffuseMode::PaintedMotif {
                    settings.diffuse.mode = DiffuseMode::Ramp;
                }
                diffuse_ramp
            }
            RampRole::Backlight => {
                settings.diffuse.backlight = Backlight::Ramp;
                backlight_ramp
            }
            RampRole::Shadow => {
                if settings.shadow.strength <= 0.0 {
                    settings.shadow.strength = 1.0;
                }
                shadow_ramp
            }
            RampRole::Scatter => {
                settings.soft_scatter.mode = SoftScatterMode::Ramp;
                soft_scatter_ramp
            }
            RampRole::Specular => specular_ramp,
            RampRole::Coverage => {
                settings.coverage = CoverageMode::Ramp;
                coverage_ramp
            }
            // Only forward smoke uses the age ramp.
            RampRole::Heat | RampRole::Fire => {
                if !settings.burns() {
                    settings.fire.intensity = 4.0;
                }
                if role == RampRole::Heat { heat_ramp } else { fire_ramp }
            }
            RampRole::Age => {
                settings.path = RenderPath::Forward;
                settings.sprite.age_color = 1.0;
                age_ramp
            }
        };
        *position = ramp.clone();
    }
}
