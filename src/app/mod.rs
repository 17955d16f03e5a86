//! The command line: what each subcommand takes, and how failure is reported.
//!
//! Exit codes: 0 done, 1 the work failed, 2 bad usage or bad input. One line on stderr says what is wrong, where, and what
//! would be right.

mod bake;
mod bench;
mod cost;
mod info;
mod label;
mod options;
mod output;
mod plot;
mod preset;
mod render;
mod shade_tree;
mod sheet;
mod techniques;
mod tonemap;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{Parser, Subcommand};
use haze::Error;

/// Lit, soft smoke for wgpu: accumulated small, lit once per pixel, painted by ramps.
#[derive(Parser)]
#[command(name = "haze", version, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Render a preset to a PNG.
    Render(render::Arguments),
    /// Render every stage of the shading on one labelled sheet.
    ShadeTree(shade_tree::Arguments),
    /// Render a preset under every soft-particle technique, with what each costs, on one labelled sheet.
    Techniques(techniques::Arguments),
    /// Measure what smoke costs here.
    Bench(bench::Arguments),
    /// List, check and describe presets.
    Preset(preset::Arguments),
    /// Make ramp pictures.
    Ramp(bake::RampArguments),
    /// Make sprite pictures.
    Sprite(bake::SpriteArguments),
    /// Say what this machine renders with.
    Info,
}

/// Runs the program and reports how it went.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    env_logger::Builder::from_env(env_logger::Env::default().default_filter_or("error")).init();
    let cli = match Cli::try_parse_from(arguments) {
        Ok(cli) => cli,
        Err(help) if !help.use_stderr() => {
            return report(output::say!("{help}"));
        }
        Err(help) if help.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            eprint!("{help}");
            return ExitCode::from(2);
        }
        Err(error) => {
            eprintln!("{}", usage_line(&error));
            return ExitCode::from(2);
        }
    };
    let done = match cli.command {
        Command::Render(arguments) => render::run(&arguments),
        Command::ShadeTree(arguments) => shade_tree::run(&arguments),
        Command::Techniques(arguments) => techniques::run(&arguments),
        Command::Bench(arguments) => bench::run(&arguments),
        Command::Preset(arguments) => preset::run(&arguments),
        Command::Ramp(arguments) => bake::run_ramp(&arguments),
        Command::Sprite(arguments) => bake::run_sprite(&arguments),
        Command::Info => info::run(),
    };
    report(done)
}

fn report(done: Result<(), Error>) -> ExitCode {
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("haze: {error}");
            ExitCode::from(exit_code(&error))
        }
    }
}

/// clap explains over several lines; the first says what is wrong and what would be right.
fn usage_line(error: &clap::Error) -> String {
    let text = error.to_string();
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    let first = lines.next().unwrap_or_default().trim_start_matches("error: ");
    // Lists ("the following required arguments were not provided:", "[possible values: …]") go on one line more.
    let more = lines.next().filter(|line| first.ends_with(':') || line.starts_with("[possible values"));
    match more {
        Some(more) => format!("haze: {first} {more}"),
        None => format!("haze: {first}"),
    }
}

fn exit_code(error: &Error) -> u8 {
    match error {
        Error::Field(_) | Error::Image { .. } | Error::Json { .. } | Error::JsonField { .. } => 2,
        // A file that is not there, or may not be read, is bad input; a full disk is not.
        Error::Io { error, .. } => match error.kind() {
            std::io::ErrorKind::NotFound
            | std::io::ErrorKind::PermissionDenied
            | std::io::ErrorKind::InvalidData
            | std::io::ErrorKind::IsADirectory => 2,
            _ => 1,
        },
        Error::NoDevice(_) | Error::Device(_) => 1,
    }
}
