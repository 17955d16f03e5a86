//! `haze preset`: list, check, schema.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use glam::UVec2;
use haze::builtin;
use haze::demo::shot::Shot;
use haze::preset::Preset;

use super::output::{Failures, say, write_text};

#[derive(Args)]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// The built-in presets.
    List,
    /// Load presets and their pictures, and say what is wrong with them.
    Check {
        /// Names or paths.
        #[arg(required = true)]
        presets: Vec<PathBuf>,
    },
    /// Print the JSON schema of preset files.
    Schema,
}

pub fn run(arguments: &Arguments) -> Result<(), Failures> {
    match &arguments.command {
        Command::List => {
            for builtin in builtin::PRESETS {
                let preset = Preset::load(builtin.name)?;
                say!("{:<14}{}", builtin.name, preset.description)?;
            }
        }
        Command::Check { presets } => {
            let check = |name| Shot::load(name, UVec2::new(1280, 720)).map(|_| name);
            let (good, failures) = Failures::of_each(presets, check);
            for name in good {
                say!("{}: good", name.display())?;
            }
            return failures.into_result();
        }
        Command::Schema => write_text(haze::preset::schema())?,
    }
    Ok(())
}
