//! `haze shade-tree`: every stage of the shading on one sheet, as OTEE's slide "Shade tree" shows it.

use clap::Args;
use haze::Error;
use haze::settings::ShadeTree;
use haze_demo::shot::Shot;

use super::export::{Watch, sheet};
use super::options::ShotArguments;

#[derive(Args)]
#[command(mut_arg("size", |size| size.help("Three times the size of a picture on the sheet, which has three to a row, pixels")))]
pub struct Arguments {
    #[command(flatten)]
    shot: ShotArguments,
}

/// In the order in which they are made, three to a row.
pub const STAGES: [(ShadeTree, &str); ShadeTree::ALL.len()] = [
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

pub const COLUMNS: u32 = 3;

pub fn run(arguments: &Arguments) -> Result<(), Error> {
    let mut shot = arguments.shot.load(&[])?;
    // So the sheet costs what a picture costs.
    shot.size = (arguments.shot.run.size / COLUMNS).max(glam::UVec2::ONE);
    let backend = arguments.shot.run.backend()?;
    let sheet = sheet(&backend, &stages(&shot), COLUMNS, &arguments.shot.output, &Watch::terminal())?;
    arguments.shot.write(sheet.picture, &shot, &backend)
}

/// A shot of every stage, with its name.
pub fn stages(shot: &Shot) -> Vec<(String, Shot)> {
    STAGES.map(|(stage, label)| (label.into(), Shot { shade_tree: stage, ..shot.clone() })).into()
}
