//! `haze bench`: measures the cost of smoke on this machine, and the image quality that each saving costs.

mod adapter;
mod clock_keepalive;
mod compare_runs;
pub mod flip;
mod frame_suite;
pub mod frame_timer;
mod limit_work;
mod limits;
mod measure;
mod page;
mod particle_cpu_time;
mod quality;
mod recommendation;
mod report;
mod report_csv;
mod report_json;
mod run;
mod run_time;
mod shadow_suite;
mod soft_particles;
mod sprite_shots;
mod sprites_suite;
mod stop;
mod suite;
mod suites;
mod terminal_table;

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use haze_core::error::Error;
use haze_preset::write_file;

use haze_export::output::{Failures, FileChecks, write_text};

/// Arguments of the benchmark.
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
    Compare(compare_runs::Arguments),
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

/// Runs the benchmark, or one of its subcommands.
///
/// # Errors
/// The failures of the files and of the measurement; empty if a comparison found slower rows and has printed them.
pub fn run(arguments: &Arguments) -> Result<(), Failures> {
    match &arguments.command {
        Some(Command::SoftParticles(arguments)) => Ok(soft_particles::run(arguments)?),
        Some(Command::Compare(arguments)) => compare_runs::run(arguments),
        Some(Command::Page { report, output }) => Ok(make_page(report, output)?),
        Some(Command::Schema) => Ok(write_text(report_json::schema())?),
        None => run::run(&arguments.run),
    }
}

fn make_page(report: &Path, output: &Path) -> Result<(), Error> {
    FileChecks::for_inputs([report]).check_output("--output", output, "html")?;
    Ok(write_file(output, page::page(&report_json::read(report)?).as_bytes())?)
}
