//! `haze bench`: what smoke costs on this machine.

mod soft_particles;

use clap::{Args, Subcommand};
use haze::Error;

#[derive(Args)]
pub struct Arguments {
    #[command(subcommand)]
    suite: Suite,
}

#[derive(Subcommand)]
enum Suite {
    /// NV's experiment: two big sprites drawn 1000 times, by the three ways to test depth.
    #[command(alias = "soft_particles")]
    SoftParticles(soft_particles::Arguments),
}

pub fn run(arguments: &Arguments) -> Result<(), Error> {
    match &arguments.suite {
        Suite::SoftParticles(arguments) => soft_particles::run(arguments),
    }
}
