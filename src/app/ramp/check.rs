//! `haze ramp check`: what would show.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use clap::Args;
use haze::Error;
use haze::assets::finding::Finding;
use haze::picture::colour_notes;
use haze::ramp::Role;
use haze::ramp::check::check;

use super::{picture_of, refuse_gradient};
use crate::app::findings::tell;
use crate::app::options::choices;
use crate::app::output::{Failures, has_extension};

#[derive(Args)]
pub struct Arguments {
    /// PNGs and `*.ramp.json` files.
    #[arg(required = true)]
    ramps: Vec<PathBuf>,
    /// What they are used for; else what their names begin with says it.
    #[arg(long = "as", value_name = "ROLE", value_parser = choices::<Role>())]
    role: Option<Role>,
}

pub fn run(Arguments { ramps, role }: &Arguments) -> Result<(), Failures> {
    tell(ramps, |path| findings(path, *role))
}

fn findings(path: &Path, role: Option<Role>) -> Result<Vec<Finding>, Error> {
    let name = path.file_name().and_then(OsStr::to_str).unwrap_or_default();
    let role = role.or_else(|| Role::of_name(name));
    refuse_gradient(path)?;
    let mut findings = Vec::new();
    if !has_extension(path, "json") {
        let notes = colour_notes(path)?;
        findings.extend(notes.into_iter().map(|what| Finding { name: "colour_space", what }));
    }
    match picture_of(path) {
        Ok((picture, _)) => findings.extend(check(&picture, role)),
        // A space that is refused has been noted.
        Err(Error::Image { .. }) if !findings.is_empty() => {}
        Err(error) => return Err(error),
    }
    Ok(findings)
}
