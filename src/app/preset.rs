//! `haze preset`: list, check, schema.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use glam::UVec2;
use haze::demo::shot::Shot;
use haze::preset::{Preset, PresetSystem};
use haze::settings::values;
use haze::{Light, builtin};

use super::output::{Failures, say, write_text};

#[derive(Args)]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
}

/// Of the picture that presets are checked for.
const SIZE: UVec2 = UVec2::new(1280, 720);

#[derive(Subcommand)]
enum Command {
    /// The built-in presets.
    List,
    /// Load presets and their pictures, and say what is wrong with them, and what is set to no effect.
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
            let check = |name| Shot::load(name, SIZE).map(|shot| (name, shot.preset));
            let (good, failures) = Failures::of_each(presets, check);
            for (name, preset) in good {
                say!("{}: good", name.display())?;
                for (path, reason) in idle(&preset) {
                    say!("  {path} has no effect: {reason}")?;
                }
            }
            return failures.into_result();
        }
        Command::Schema => write_text(haze::preset::schema())?,
    }
    Ok(())
}

/// Fields that are set, and have no effect, with the reason.
fn idle(preset: &Preset) -> Vec<(String, &'static str)> {
    let plain = Preset {
        lights: vec![Light::default(); preset.lights.len()],
        systems: vec![PresetSystem::default(); preset.systems.len()],
        ..Preset::default()
    };
    let set = values(preset).into_iter().zip(values(&plain)).filter(|(value, plain)| value != plain);
    set.filter_map(|((path, _), _)| preset.without_effect(&path, SIZE).map(|reason| (path, reason))).collect()
}
