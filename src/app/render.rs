//! `haze render`: one picture.

use clap::Args;
use haze::Error;
use haze::settings::ShadeTree;

use super::options::{DEFAULT_PRESET, ShotArguments, choices};
use super::tonemap::develop;

#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    shot: ShotArguments,
    /// Which stage of the shading is shown.
    #[arg(long, default_value = "final", value_parser = choices::<ShadeTree>())]
    view: ShadeTree,
}

pub fn run(arguments: &Arguments) -> Result<(), Error> {
    let mut shot = arguments.shot.load(DEFAULT_PRESET, &[])?;
    shot.shade_tree = arguments.view;
    let backend = arguments.shot.run.backend()?;
    let picture = backend.render(&shot)?;
    arguments.shot.write(develop(&picture, &shot), &shot, &backend)
}
