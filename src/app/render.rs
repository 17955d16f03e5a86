//! `haze render`: one picture.

use std::path::PathBuf;

use clap::Args;
use haze::Error;
use haze::picture::write_png;
use haze::settings::ShadeTree;

use super::options::{DEFAULT_PRESET, ShotArguments, parse_choice};
use super::output::{check_target, say};
use super::tonemap::develop;

#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    shot: ShotArguments,
    /// The PNG to write.
    #[arg(short, long, value_name = "FILE.png")]
    output: PathBuf,
    /// Which stage of the shading is shown: final, combined, diffuse, soft_scatter, specular_scatter, normals, amount,
    /// overdraw or reduced_depth.
    #[arg(long, default_value = "final", value_parser = parse_choice::<ShadeTree>)]
    view: ShadeTree,
}

pub fn run(arguments: &Arguments) -> Result<(), Error> {
    check_target(&arguments.output)?;
    let mut shot = arguments.shot.load(DEFAULT_PRESET)?;
    shot.shade_tree = arguments.view;
    let backend = arguments.shot.run.backend()?;
    let picture = backend.render(&shot)?;
    write_png(&arguments.output, &develop(&picture, &shot).into())?;
    say!("{}: {} on {}", arguments.output.display(), shot.preset.name, backend.description())
}
