//! `haze shade-tree`: every stage of the shading on one sheet, as OTEE's slide "Shade tree" shows it.

use std::path::PathBuf;

use clap::Args;
use haze::Error;
use haze::picture::write_png;
use haze::settings::ShadeTree;
use image::{Rgb, RgbImage, imageops};

use super::label::draw_text;
use super::options::ShotArguments;
use super::tonemap::develop;

#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    shot: ShotArguments,
    /// The PNG to write.
    #[arg(short, long, value_name = "FILE.png")]
    output: PathBuf,
}

/// In the order in which they are made, three to a row.
const STAGES: [(ShadeTree, &str); 9] = [
    (ShadeTree::ReducedDepth, "Reduced depth"),
    (ShadeTree::Normals, "Accumulated normals"),
    (ShadeTree::Amount, "Accumulated amount"),
    (ShadeTree::Overdraw, "Overdraw"),
    (ShadeTree::Diffuse, "Diffuse"),
    (ShadeTree::SoftScatter, "Soft scatter and ambient"),
    (ShadeTree::SpecularScatter, "Specular scatter"),
    (ShadeTree::Combined, "Combined lighting"),
    (ShadeTree::Final, "Final"),
];

const COLUMNS: u32 = 3;
const MARGIN: u32 = 12;
const LABEL: u32 = 28;
const PAPER: Rgb<u8> = Rgb([24, 25, 28]);
const INK: Rgb<u8> = Rgb([225, 225, 220]);

pub fn run(arguments: &Arguments) -> Result<(), Error> {
    let mut shot = arguments.shot.load()?;
    // The picture's size is the sheet's: every stage is a third of it, so that the sheet costs what a picture costs.
    shot.size = (arguments.shot.size / COLUMNS).max(glam::UVec2::ONE);
    let backend = arguments.shot.backend()?;
    let rows = STAGES.len() as u32 / COLUMNS;
    let cell = shot.size + glam::UVec2::new(MARGIN, MARGIN + LABEL);
    let mut sheet = RgbImage::from_pixel(cell.x * COLUMNS + MARGIN, cell.y * rows + MARGIN, PAPER);
    for (index, (stage, label)) in (0u32..).zip(STAGES) {
        shot.shade_tree = stage;
        let picture = develop(&backend.render(&shot)?, &shot);
        let corner = glam::UVec2::new(index % COLUMNS, index / COLUMNS) * cell + MARGIN;
        draw_text(&mut sheet, corner.x as f32 + 2.0, corner.y as f32, 20.0, INK, label);
        imageops::replace(&mut sheet, &picture, i64::from(corner.x), i64::from(corner.y + LABEL));
    }
    write_png(&arguments.output, &sheet.into())?;
    println!("{}: {} on {}", arguments.output.display(), shot.preset.name, backend.description());
    Ok(())
}
