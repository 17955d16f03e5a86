//! `haze preset`: list, check, schema.

use clap::{Args, Subcommand};
use glam::UVec2;
use haze::demo::shot::Shot;
use haze::preset::Preset;
use haze::{Error, builtin};

use super::output::say;

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
        presets: Vec<String>,
    },
    /// Print the JSON schema of preset files.
    Schema,
}

pub fn run(arguments: &Arguments) -> Result<(), Error> {
    match &arguments.command {
        Command::List => {
            for builtin in builtin::PRESETS {
                let preset = Preset::load(builtin.name)?;
                say!("{:<14}{}", builtin.name, preset.description)?;
            }
        }
        Command::Check { presets } => {
            for name in presets {
                Shot::load(name, UVec2::new(1280, 720))?;
                say!("{name}: good")?;
            }
        }
        Command::Schema => say!("{}", haze::preset::schema())?,
    }
    Ok(())
}
