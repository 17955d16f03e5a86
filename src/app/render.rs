//! `haze render`: one picture.

use clap::Args;
use haze::Error;
use haze::settings::ShadeTree;

use super::options::{DEFAULT_PRESET, ShotArguments, parse_choice};
use super::tonemap::develop;

#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    shot: ShotArguments,
    /// Which stage of the shading is shown: final, combined, diffuse, soft_scatter, specular_scatter, normals, amount,
    /// overdraw or reduced_depth.
    #[arg(long, default_value = "final", value_parser = parse_choice::<ShadeTree>)]
    view: ShadeTree,
}

pub fn run(arguments: &Arguments) -> Result<(), Error> {
    let mut shot = arguments.shot.load(DEFAULT_PRESET)?;
    shot.shade_tree = arguments.view;
    let backend = arguments.shot.run.backend()?;
    let picture = backend.render(&shot)?;
    arguments.shot.write(develop(&picture, &shot), &shot, &backend)
}
