//! Command line: subcommands, dispatch and error reporting.
//!
//! Exit codes: 0 success, 1 the work failed, 2 bad usage or bad input. One line on stderr says what is wrong, where,
//! and what would be right.

use std::ffi::OsString;
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

use clap::error::{ContextValue, ErrorKind};
use clap::{CommandFactory as _, Parser, Subcommand};
use haze_bench as bench;
use haze_core::error::{AssetError, Error, is_link_loop};
use haze_export::output::{Failures, one_line, print_error, write_text};
use haze_export::recipe_files::has_extension;
use haze_export::share_link;
use haze_preset::builtin;
use haze_tweak as tweak;

use crate::commands::{debug_views, export, info, preset, ramp, render, sheet, sprite, techniques};

/// Lit, soft smoke for wgpu: accumulated at low resolution, lit once per pixel from ramps that artists paint.
#[derive(Parser)]
#[command(name = "haze", version, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    /// Open the tweaker, a window to edit lights, ramps and smoke in; also `haze` alone, which renders an image where there is
    /// no display, and `haze PRESET`.
    Tweak(tweak::Arguments),
    /// Render a preset to a PNG, to one PNG per frame, to a flipbook or to a GIF.
    Render(render::Arguments),
    /// Render every stage of the shading on one labelled sheet.
    #[command(alias = "shade-tree")]
    DebugViews(debug_views::Arguments),
    /// Render a preset with several values of one field, on one labelled sheet.
    Sheet(sheet::Arguments),
    /// Render a preset with every soft-particle technique and its cost, on one labelled sheet.
    Techniques(techniques::Arguments),
    /// Measure the cost of smoke on this machine.
    Bench(bench::Arguments),
    /// List, check, show, create and describe presets.
    Preset(preset::Arguments),
    /// Create, bake, import, fit, watch, show and check ramps.
    Ramp(ramp::RampArguments),
    /// Bake, import, export, light and check sprites.
    Sprite(sprite::SpriteArguments),
    /// Write looks and images in the forms that engines read.
    Export(export::Arguments),
    /// Print what this machine renders with: GPU, driver and CPU, and the choices of path auto.
    Info,
}

/// Runs the program and returns its exit code.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    // wgpu-hal logs every driver that is missing, and eframe logs that none was found, which haze reports itself.
    env_logger::Builder::from_env(
        env_logger::Env::default().default_filter_or("error,wgpu_hal=off,eframe::native::run=off"),
    )
    .format(|line, record| match tweak::is_of_dialogs(record.target()) {
        true => Ok(()),
        false => writeln!(line, "[{} {}] {}", record.level(), record.target(), record.args()),
    })
    .init();
    let arguments = with_subcommand(arguments.into_iter().collect());
    if arguments.len() > 1 {
        return run_arguments(arguments);
    }
    // The first command that a new user types works on every machine.
    match tweak::run(&tweak::Arguments::default()) {
        Err(Error::NoDevice(reason)) => {
            print_error(reason);
            let output = free_image_name("column", |name| Path::new(name).symlink_metadata().is_err());
            run_arguments(vec!["haze".into(), "render".into(), "column".into(), "--output".into(), output.into()])
        }
        done => report(done.map_err(Failures::from)),
    }
}

/// Returns `NAME.png`, or else the first free one of `NAME_2.png` and so on, so that no file of the user is replaced.
fn free_image_name(name: &str, is_free: impl Fn(&str) -> bool) -> String {
    let mut file = format!("{name}.png");
    let mut number = 1;
    while !is_free(&file) {
        number += 1;
        file = format!("{name}_{number}.png");
    }
    file
}

fn run_arguments(arguments: Vec<OsString>) -> ExitCode {
    let cli = match Cli::try_parse_from(arguments) {
        Ok(cli) => cli,
        Err(help) if !help.use_stderr() => {
            // `write_text` adds the last line break.
            return report(write_text(help.to_string().trim_end()).map_err(Failures::from));
        }
        Err(help) if help.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            let _ = write!(std::io::stderr().lock(), "{help}");
            return ExitCode::from(2);
        }
        Err(error) => {
            print_error(usage_line(error));
            return ExitCode::from(2);
        }
    };
    let one = |done: Result<(), Error>| done.map_err(Failures::from);
    report(match cli.command.unwrap_or_else(|| Command::Tweak(tweak::Arguments::default())) {
        Command::Tweak(arguments) => one(tweak::run(&arguments)),
        Command::Render(arguments) => one(render::run(&arguments)),
        Command::DebugViews(arguments) => one(debug_views::run(&arguments)),
        Command::Sheet(arguments) => one(sheet::run(&arguments)),
        Command::Techniques(arguments) => one(techniques::run(&arguments)),
        Command::Bench(arguments) => bench::run(&arguments),
        Command::Preset(arguments) => preset::run(&arguments),
        Command::Ramp(arguments) => ramp::run(&arguments),
        Command::Sprite(arguments) => sprite::run(&arguments),
        Command::Export(arguments) => one(export::run(&arguments)),
        Command::Info => one(info::run()),
    })
}

/// Inserts `tweak` before the name of a preset, a link or an option of the tweaker: `haze PRESET --size 800x600` is `haze tweak
/// PRESET --size 800x600`. A subcommand of the same name takes precedence.
fn with_subcommand(mut arguments: Vec<OsString>) -> Vec<OsString> {
    let is_preset = |name: &OsString| {
        let path = Path::new(name);
        let is_built_in = name.to_str().is_some_and(|name| builtin::find(builtin::PRESETS, name).is_some());
        let is_command = Cli::command().find_subcommand(name).is_some();
        let is_link = name.to_str().and_then(share_link::fragment).is_some();
        !is_command && (is_built_in || is_link || path.is_file() || has_extension(path, "json"))
    };
    let is_option = |argument: &OsString| {
        let is_own = |name| ["-h", "--help", "-V", "--version"].contains(&name);
        argument.to_str().is_some_and(|name| name.starts_with('-') && !is_own(name))
    };
    if arguments.get(1).is_some_and(|argument| is_option(argument) || is_preset(argument)) {
        arguments.insert(1, "tweak".into());
    }
    arguments
}

fn report(done: Result<(), Failures>) -> ExitCode {
    let Err(failures) = done else { return ExitCode::SUCCESS };
    failures.errors().iter().for_each(print_error);
    // Without any error, the failure has been reported already.
    ExitCode::from(failures.errors().iter().map(exit_code).max().unwrap_or(1))
}

/// Returns clap's error as one line. clap explains over several lines; the first one says what is wrong and what would
/// be right.
fn usage_line(mut error: clap::Error) -> String {
    // Arguments may contain line breaks.
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
    // Lists ("the following required arguments were not provided:", "[possible values: …]") continue on the next line.
    let more = lines.next().filter(|line| first.ends_with(':') || line.starts_with("[possible values"));
    match more {
        Some(more) => format!("{first} {more}"),
        None => first.to_owned(),
    }
}

fn exit_code(error: &Error) -> u8 {
    match error {
        Error::Field(_) | Error::Prepare(_) | Error::NoDevice(_) => 2,
        Error::Asset(error) => exit_code_of_file(error),
        Error::Device(_) => 1,
    }
}

fn exit_code_of_file(error: &AssetError) -> u8 {
    match error {
        AssetError::Named { error, .. } => exit_code_of_file(error),
        // A file that is missing or may not be read is bad input; a full disk is not.
        AssetError::Io { error, .. } => match error.kind() {
            std::io::ErrorKind::NotFound
            | std::io::ErrorKind::PermissionDenied
            | std::io::ErrorKind::AlreadyExists
            | std::io::ErrorKind::ReadOnlyFilesystem
            | std::io::ErrorKind::InvalidData
            | std::io::ErrorKind::InvalidFilename
            | std::io::ErrorKind::InvalidInput
            | std::io::ErrorKind::IsADirectory
            | std::io::ErrorKind::NotADirectory => 2,
            _ if is_link_loop(error) => 2,
            _ => 1,
        },
        _ => 2,
    }
}

#[cfg(test)]
mod tests {
    use std::any::TypeId;

    use super::*;

    /// Collects the options of a command and of its subcommands whose value is a number, after the words before them.
    fn number_options(command: &clap::Command, words: &[String], found: &mut Vec<Vec<String>>) {
        let numbers = [
            TypeId::of::<f32>(),
            TypeId::of::<f64>(),
            TypeId::of::<i32>(),
            TypeId::of::<i64>(),
            TypeId::of::<u32>(),
            TypeId::of::<u64>(),
            TypeId::of::<usize>(),
        ];
        for argument in command.get_arguments() {
            if numbers.iter().any(|number| argument.get_value_parser().type_id() == *number) {
                let option = format!("--{}", argument.get_long().unwrap());
                found.push([words, &[option]].concat());
            }
        }
        for command in command.get_subcommands() {
            number_options(command, &[words, &[command.get_name().to_owned()]].concat(), found);
        }
    }

    #[test]
    fn options_of_the_tweaker_need_no_subcommand() {
        let completed = |words: &[&str]| {
            let words = with_subcommand(words.iter().map(OsString::from).collect());
            words.into_iter().map(|word| word.into_string().unwrap()).collect::<Vec<_>>().join(" ")
        };
        assert_eq!(completed(&["haze", "--size", "800x600"]), "haze tweak --size 800x600");
        assert_eq!(completed(&["haze", "fence", "--size", "800x600"]), "haze tweak fence --size 800x600");
        for own in ["--help", "-h", "--version", "-V", "render", "nonsense"] {
            assert_eq!(completed(&["haze", own]), format!("haze {own}"));
        }
        assert!(Cli::try_parse_from(with_subcommand(["haze", "--size", "800x600"].map(OsString::from).into())).is_ok());
    }

    #[test]
    fn every_option_that_takes_a_number_names_its_range() {
        let mut options = Vec::new();
        number_options(&Cli::command(), &["haze".into()], &mut options);
        // Far fewer would mean that options are no longer found.
        assert!(options.len() > 40, "{}", options.len());
        for words in options {
            let (option, words) = words.split_last().unwrap();
            for value in ["x", "", "nan", "-1e39"] {
                let given = words.iter().cloned().chain([format!("{option}={value}")]);
                let Err(error) = Cli::try_parse_from(given) else { panic!("{words:?} {option}={value}") };
                let line = usage_line(error);
                let is_digit = |c: char| c.is_ascii_digit() || c == '-';
                let mut ranges = line.match_indices(" to ");
                let has_range = ranges
                    .any(|(at, to)| line[..at].ends_with(is_digit) && line[at + to.len()..].starts_with(is_digit));
                assert!(has_range && line.contains(&**option), "{words:?}: {line}");
            }
        }
    }
}
