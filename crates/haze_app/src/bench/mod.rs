//! `haze bench`: measures the cost of smoke on this machine, and the image quality that each saving costs.

mod adapter;
mod awake;
mod compare;
mod csv;
mod json;
mod limits;
mod measure;
mod page;
mod particles;
mod quality;
mod report;
mod run;
mod soft_particles;
mod suites;
mod table;
mod verdict;

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use haze::Error;
use haze::image::write_file;

use super::output::{Failures, Files, write_text};

#[derive(Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    run: run::Arguments,
}

#[derive(Subcommand)]
enum Command {
    /// Run NV's experiment: two big sprites drawn 1000 times, with each of the three depth tests.
    #[command(alias = "soft_particles")]
    SoftParticles(soft_particles::Arguments),
    /// Compare two runs row by row; exits with 1 if the second is slower.
    Compare(compare::Arguments),
    /// Make the HTML page of an earlier run, or of a run on another machine.
    Page {
        /// JSON report, as `--json` writes it.
        report: PathBuf,
        /// HTML page to write.
        #[arg(short, long, value_name = "FILE.html")]
        output: PathBuf,
    },
    /// Print the JSON schema of the report that `--json` writes.
    Schema,
}

pub fn run(arguments: &Arguments) -> Result<(), Failures> {
    match &arguments.command {
        Some(Command::SoftParticles(arguments)) => Ok(soft_particles::run(arguments)?),
        Some(Command::Compare(arguments)) => compare::run(arguments),
        Some(Command::Page { report, output }) => Ok(make_page(report, output)?),
        Some(Command::Schema) => Ok(write_text(json::schema())?),
        None => run::run(&arguments.run),
    }
}

fn make_page(report: &Path, output: &Path) -> Result<(), Error> {
    Files::read([report]).write("--output", output, "html")?;
    write_file(output, page::page(&json::read(report)?).as_bytes())
}
