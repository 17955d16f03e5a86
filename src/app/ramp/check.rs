//! `haze ramp check`: what would show.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use clap::Args;
use haze::Error;
use haze::picture::colour_notes;
use haze::ramp::Role;
use haze::ramp::check::{Finding, check};

use super::super::options::choices;
use super::super::output::{Failures, has_extension, say};
use super::picture_of;

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
    let (checked, failures) = Failures::of_each(ramps, |path| Ok((path, findings(path, *role)?)));
    let mut is_good = true;
    for (path, findings) in checked {
        if findings.is_empty() {
            say!("{}: good", path.display())?;
        }
        for Finding { name, what } in findings {
            is_good = false;
            say!("{}: {name}: {what}", path.display())?;
        }
    }
    failures.into_result()?;
    if is_good { Ok(()) } else { Err(Failures::default()) }
}

fn findings(path: &Path, role: Option<Role>) -> Result<Vec<Finding>, Error> {
    let name = path.file_name().and_then(OsStr::to_str).unwrap_or_default();
    let role = role.or_else(|| Role::of_name(name));
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
