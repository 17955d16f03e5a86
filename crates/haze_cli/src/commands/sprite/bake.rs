//! `haze sprite bake`: bakes sprite and noise recipes, and smoke of VDB files, to PNGs; with `--six-way` also to six-way
//! maps.

use std::path::PathBuf;

use clap::Args;
use haze_export::output::Failures;

use super::six_way::SixWayArguments;
use super::volumes::{self, VolumeArguments, is_volume};
use crate::bake_job::{OverwriteArguments, SPRITES, bake_all};

#[derive(Args)]
pub struct Arguments {
    /// `*.sprite.json` and `*.noise.json` files; with --six-way also names of built-in sprites. Or VDB files of smoke: one
    /// frame, or `smoke_####.vdb`, with # for the digits of the frame's number.
    #[arg(required = true)]
    files: Vec<PathBuf>,
    #[command(flatten)]
    six_way: SixWayArguments,
    #[command(flatten)]
    overwrite: OverwriteArguments,
    #[command(flatten)]
    volumes: VolumeArguments,
}

pub fn run(Arguments { files, six_way, overwrite, volumes }: &Arguments) -> Result<(), Failures> {
    let painted = overwrite.painted_png();
    let (volume_files, recipes): (Vec<_>, Vec<_>) = files.iter().cloned().partition(|path| is_volume(path));
    if volume_files.is_empty() {
        volumes.check_unused()?;
    }
    six_way.check(&recipes, painted)?;
    let jobs = volumes::find_all(&volume_files, volumes, six_way, painted)?;
    bake_all(&six_way.recipe_files(&recipes), &SPRITES, painted)?;
    six_way.bake_all(&recipes)?;
    jobs.iter().try_for_each(|job| job.run(six_way)).map_err(Failures::from)
}
