//! The command line: what each subcommand takes, and how failure is reported.
//!
//! Exit codes: 0 done, 1 the work failed, 2 bad usage or bad input. One line on stderr says what is wrong, where, and what
//! would be right.

use std::ffi::OsString;
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

use clap::error::{ContextValue, ErrorKind};
use clap::{CommandFactory as _, Parser, Subcommand};
use haze::{Error, builtin};

use crate::output::{self, Failures, complain, one_line, write_text};
use crate::{bake, bench, info, preset, render, shade_tree, techniques, tweak, vary};

/// Lit, soft smoke for wgpu: accumulated small, lit once per pixel, painted by ramps.
#[derive(Parser)]
#[command(name = "haze", version, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    /// Light smoke by hand, in a window: what `haze` alone and `haze PRESET` do.
    Tweak(tweak::Arguments),
    /// Render a preset to a PNG, or to one for every frame.
    Render(render::Arguments),
    /// Render every stage of the shading on one labelled sheet.
    ShadeTree(shade_tree::Arguments),
    /// Render a preset with one field at several values, on one labelled sheet.
    Sheet(vary::Arguments),
    /// Render a preset under every soft-particle technique, with what each costs, on one labelled sheet.
    Techniques(techniques::Arguments),
    /// Measure what smoke costs here.
    Bench(bench::Arguments),
    /// List, check and describe presets.
    Preset(preset::Arguments),
    /// Make, import, watch, show and check ramps.
    Ramp(bake::RampArguments),
    /// Make, import and check sprites.
    Sprite(bake::SpriteArguments),
    /// Say what this machine renders with.
    Info,
}

/// Runs the program and reports how it went.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    // wgpu-hal logs every driver that it looks for and does not find, eframe that there is none: an error of ours.
    env_logger::Builder::from_env(
        env_logger::Env::default().default_filter_or("error,wgpu_hal=off,eframe::native::run=off"),
    )
    .format(|line, record| match tweak::is_of_dialogs(record.target()) {
        true => Ok(()),
        false => writeln!(line, "[{} {}] {}", record.level(), record.target(), record.args()),
    })
    .init();
    let cli = match Cli::try_parse_from(with_subcommand(arguments.into_iter().collect())) {
        Ok(cli) => cli,
        Err(help) if !help.use_stderr() => {
            // The text ends its last line itself.
            return report(write_text(help.to_string().trim_end()).map_err(Failures::from));
        }
        Err(help) if help.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            let _ = write!(std::io::stderr().lock(), "{help}");
            return ExitCode::from(2);
        }
        Err(error) => {
            complain(usage_line(error));
            return ExitCode::from(2);
        }
    };
    let one = |done: Result<(), Error>| done.map_err(Failures::from);
    report(match cli.command.unwrap_or_else(|| Command::Tweak(tweak::Arguments::default())) {
        Command::Tweak(arguments) => one(tweak::run(&arguments)),
        Command::Render(arguments) => one(render::run(&arguments)),
        Command::ShadeTree(arguments) => one(shade_tree::run(&arguments)),
        Command::Sheet(arguments) => one(vary::run(&arguments)),
        Command::Techniques(arguments) => one(techniques::run(&arguments)),
        Command::Bench(arguments) => bench::run(&arguments),
        Command::Preset(arguments) => preset::run(&arguments),
        Command::Ramp(arguments) => bake::run_ramp(&arguments),
        Command::Sprite(arguments) => bake::run_sprite(&arguments),
        Command::Info => one(info::run()),
    })
}

/// `haze PRESET` is `haze tweak PRESET`; a subcommand of that name comes first.
fn with_subcommand(mut arguments: Vec<OsString>) -> Vec<OsString> {
    let is_preset = |name: &OsString| {
        let path = Path::new(name);
        let is_built_in = name.to_str().is_some_and(|name| builtin::find(builtin::PRESETS, name).is_some());
        let is_command = Cli::command().find_subcommand(name).is_some();
        !is_command && (is_built_in || path.is_file() || output::has_extension(path, "json"))
    };
    if arguments.get(1).is_some_and(is_preset) {
        arguments.insert(1, "tweak".into());
    }
    arguments
}

fn report(done: Result<(), Failures>) -> ExitCode {
    let Err(failures) = done else { return ExitCode::SUCCESS };
    failures.errors().iter().for_each(complain);
    // None at all: what failed has been said.
    ExitCode::from(failures.errors().iter().map(exit_code).max().unwrap_or(1))
}

/// clap explains over several lines; the first says what is wrong and what would be right.
fn usage_line(mut error: clap::Error) -> String {
    // What was given may have line breaks of its own.
    let given = |(kind, value): (_, &_)| match value {
        ContextValue::String(given) => Some((kind, ContextValue::String(one_line(given)))),
        _ => None,
    };
    for (kind, value) in error.context().filter_map(given).collect::<Vec<_>>() {
        error.insert(kind, value);
    }
    let text = error.to_string();
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    let first = lines.next().unwrap_or_default().trim_start_matches("error: ");
    // Lists ("the following required arguments were not provided:", "[possible values: …]") go on one line more.
    let more = lines.next().filter(|line| first.ends_with(':') || line.starts_with("[possible values"));
    match more {
        Some(more) => format!("{first} {more}"),
        None => first.to_owned(),
    }
}

fn exit_code(error: &Error) -> u8 {
    match error {
        Error::Field(_)
        | Error::Image { .. }
        | Error::Json { .. }
        | Error::JsonField { .. }
        | Error::Shader { .. }
        | Error::NoDevice(_) => 2,
        Error::Picture { error, .. } => exit_code(error),
        // A file that is not there, or may not be read, is bad input; a full disk is not.
        Error::Io { error, .. } => match error.kind() {
            std::io::ErrorKind::NotFound
            | std::io::ErrorKind::PermissionDenied
            | std::io::ErrorKind::InvalidData
            | std::io::ErrorKind::IsADirectory => 2,
            _ => 1,
        },
        Error::Device(_) => 1,
    }
}
