//! `haze techniques`: renders one shot with every technique, labelled with its cost, and enlarges the intersection with
//! the scene.

use std::path::PathBuf;

use clap::Args;
use glam::UVec2;
use haze::FieldError;
use haze_bench::frame_timer::{Cost, FrameTimer, measure_interleaved, median_of};
use haze_core::error::Error;
use haze_core::formula::soft_fade::soft_fade;
use haze_core::settings::{FadeCurve, Technique};
use haze_demo::shot::Shot;
use haze_demo::tonemap_pass::tonemap;
use haze_export::backend::Backend;
use haze_export::contact_sheet::ContactSheet;
use haze_export::options::ShotArguments;
use haze_export::output::print_error;
use haze_preset::write_png;
use image::{Rgb, RgbImage, imageops};

use crate::plot::{Curve, plot};

#[derive(Args)]
#[command(
    // This preset shows the differences best.
    mut_arg("preset", |preset| preset.default_value("crates")),
    mut_arg("size", |size| size.help("Twice the size of an image on the sheet, in pixels; the sheet has two columns")),
)]
pub struct Arguments {
    #[command(flatten)]
    shot: ShotArguments,
    /// Also write every image as FOLDER/NAME.png.
    #[arg(long, value_name = "FOLDER")]
    cells: Option<PathBuf>,
    /// Also plot the fade curves.
    #[arg(long, value_name = "FILE.png")]
    curves: Option<PathBuf>,
}

const COLUMNS: u32 = 2;

/// Rounds in which every technique is measured.
const ROUNDS: u32 = 5;
/// The CPU renderer is slow, and its times are steady.
const ROUNDS_ON_CPU: u32 = 1;

pub fn run(arguments: &Arguments) -> Result<(), Error> {
    if let Some(technique) = arguments.shot.technique {
        let problem = format!("{} is given, but the sheet shows every technique", technique.name());
        return Err(FieldError::from_problem("--technique", problem, "no --technique").into());
    }
    let in_cells = |name: &str| arguments.cells.as_ref().map(|folder| folder.join(format!("{name}.png")));
    let cells = variants().filter_map(|variant| Some(("--cells", in_cells(variant.name)?)));
    let curves = arguments.curves.iter().map(|path| ("--curves", path.clone()));
    let mut shot = arguments.shot.load(&curves.chain(cells).collect::<Vec<_>>())?;
    let backend = arguments.shot.run.backend()?;
    shot.size = (arguments.shot.run.size / COLUMNS).max(UVec2::ONE);
    let cells = render_cells(&backend, &shot)?;
    let rounds = if matches!(backend, Backend::Cpu) { ROUNDS_ON_CPU } else { ROUNDS };
    let costs = measure(&backend, &shot, &cells, rounds)?;

    let zoom = Zoom::at_largest_difference(&cells[0].image, &cells[1].image);
    let mut sheet = ContactSheet::new(shot.size, COLUMNS, cells.len() as u32);
    for (index, cell) in (0..).zip(&cells) {
        let mut label = cell.name.to_owned();
        if let Some(costs) = &costs {
            label += &format!("    {}", cost_label(&costs[index], &costs[0]));
        }
        let zoomed = zoom.inset(&cell.image);
        if let Some(path) = in_cells(cell.name) {
            write_png(&path, &zoomed.clone().into(), arguments.shot.effort())?;
        }
        sheet.place(index as u32, &label, &zoomed);
    }
    let measured = match costs {
        Some(_) => format!("ms: all sprites once, {}", median_of(rounds)),
        None => "no smoke is visible, so costs are left out".into(),
    };
    sheet.add_footer(&format!("{measured}; {}x{}, {}", shot.size.x, shot.size.y, backend.description()));
    if let Some(curves) = &arguments.curves {
        write_png(curves, &fade_curves().into(), arguments.shot.effort())?;
    }
    arguments.shot.write(sheet.image, &shot, &backend)
}

/// Content of a cell.
struct Variant {
    name: &'static str,
    technique: Technique,
    /// True for the fade curve `always`, which has no depth test.
    always: bool,
}

/// Returns all variants; `hard` and `soft` are the first two.
fn variants() -> impl Iterator<Item = Variant> {
    let plain = Technique::ALL.iter().map(|&technique| Variant { name: technique.name(), technique, always: false });
    plain.chain([Variant { name: "soft_always", technique: Technique::Soft, always: true }])
}

struct Cell {
    name: &'static str,
    shot: Shot,
    image: RgbImage,
}

/// Renders the shot with every technique that is possible; `hard` and `soft` always are.
fn render_cells(backend: &Backend, shot: &Shot) -> Result<Vec<Cell>, Error> {
    let mut cells = Vec::new();
    for variant in variants() {
        let mut shot = shot.at_its_time().into_owned();
        for system in &mut shot.preset.systems {
            system.settings.technique = variant.technique;
            if variant.always {
                system.settings.soft_fade.curve = FadeCurve::Always;
            }
        }
        match backend.render(&shot) {
            Ok(image) => cells.push(Cell { image: tonemap(&image, &shot), name: variant.name, shot }),
            // The sprite has no detail map, or the adapter cannot render to R32Float.
            Err(Error::Field(error)) if error.field.ends_with("settings.technique") => {
                print_error(format_args!("left out: {error}"));
            }
            Err(error) => return Err(error),
        }
    }
    Ok(cells)
}

/// Measures the cost of every cell; `None` if every cell looks like the scene without smoke.
fn measure(backend: &Backend, shot: &Shot, cells: &[Cell], rounds: u32) -> Result<Option<Vec<Cost>>, Error> {
    let mut bare = shot.clone();
    bare.preset.systems.clear();
    let bare = tonemap(&backend.render(&bare)?, &bare);
    if cells.iter().all(|cell| cell.image == bare) {
        print_error("no smoke is visible: costs are left out");
        return Ok(None);
    }
    let mut timer = FrameTimer::new(backend)?;
    let loops = timer.measurable_loops(&cells[0].shot)?;
    measure_interleaved(rounds, cells.len(), |cell| timer.seconds_per_pass(&cells[cell].shot, loops)).map(Some)
}

/// Plots the fade by distance for every curve, from the reference formulas.
fn fade_curves() -> RgbImage {
    const COLORS: [Rgb<u8>; FadeCurve::ALL.len()] =
        [Rgb([240, 196, 110]), Rgb([225, 225, 220]), Rgb([120, 190, 240]), Rgb([240, 130, 120]), Rgb([150, 210, 140])];
    let curve = |(&curve, color): (&FadeCurve, Rgb<u8>)| Curve {
        name: curve.name(),
        color,
        function: Box::new(move |x| {
            soft_fade(curve, x, 1.0, if curve == FadeCurve::Contrast { 2.0 } else { 1.0 }, 0.0)
        }),
    };
    let curves: Vec<_> = FadeCurve::ALL.iter().zip(COLORS).map(curve).collect();
    let axis = "distance in front of the scene, in 1 / fade_scale   (contrast_power 2 for contrast, 1 for exponential)";
    plot(UVec2::new(800, 360), -1.5, 1.5, axis, &curves)
}

fn cost_label(cost: &Cost, hard: &Cost) -> String {
    format!("{:.3} ms, {:.2} x hard", 1000.0 * cost.median(), cost.median() / hard.median())
}

/// A square of the image that is shown enlarged in one of the image's corners.
struct Zoom {
    corner: UVec2,
    side: u32,
}

/// Magnification.
const MAGNIFICATION: u32 = 3;

impl Zoom {
    /// Finds the square in which the edges of the two images differ most.
    fn at_largest_difference(a: &RgbImage, b: &RgbImage) -> Self {
        let size = UVec2::from(a.dimensions());
        let side = (size.y / 7).max(1).min(size.x);
        let green = |x, y| i64::from(a.get_pixel(x, y).0[1]) - i64::from(b.get_pixel(x, y).0[1]);
        let edge = |x, y| (green(x + 1, y) - green(x, y)).pow(2) + (green(x, y + 1) - green(x, y)).pow(2);
        let sum = |corner: UVec2| {
            let last = corner + side - 1;
            (corner.y..last.y).flat_map(|y| (corner.x..last.x).map(move |x| edge(x, y))).sum::<i64>()
        };
        let step = (side / 4).max(1) as usize;
        let corners = (0..=size.y - side)
            .step_by(step)
            .flat_map(|y| (0..=size.x - side).step_by(step).map(move |x| UVec2::new(x, y)));
        let corner = corners.max_by_key(|&corner| sum(corner)).unwrap_or(UVec2::ZERO);
        Self { corner, side }
    }

    fn inset(&self, image: &RgbImage) -> RgbImage {
        let mut image = image.clone();
        let size = UVec2::from(image.dimensions());
        let enlarged = (self.side * MAGNIFICATION).min(size.min_element());
        let part = imageops::crop_imm(&image, self.corner.x, self.corner.y, self.side, self.side).to_image();
        let part = imageops::resize(&part, enlarged, enlarged, imageops::FilterType::CatmullRom);
        // In the right corner, or in the left one if it would hide the square itself.
        let covers = self.corner.x + self.side > size.x - enlarged;
        let at = UVec2::new(if covers { 0 } else { size.x - enlarged }, size.y - enlarged);
        imageops::replace(&mut image, &part, i64::from(at.x), i64::from(at.y));
        outline(&mut image, at, enlarged);
        outline(&mut image, self.corner, self.side);
        image
    }
}

fn outline(image: &mut RgbImage, corner: UVec2, side: u32) {
    const LINE: Rgb<u8> = Rgb([240, 240, 235]);
    let last = side - 1;
    for i in 0..side {
        for (x, y) in [(i, 0), (i, last), (0, i), (last, i)] {
            if let Some(pixel) = image.get_pixel_mut_checked(corner.x + x, corner.y + y) {
                *pixel = LINE;
            }
        }
    }
}
