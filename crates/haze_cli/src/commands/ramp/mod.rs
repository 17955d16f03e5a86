//! `haze ramp`: arguments and dispatch of its subcommands.

mod bake;
mod check;
mod export;
mod fit;
mod fit_shadow;
mod import;
mod new;
mod ramp_image;
mod ramp_io;
mod sheet;
mod show;
mod watch;

use clap::{Args, Subcommand};

use haze_export::output::Failures;

#[derive(Args)]
pub struct RampArguments {
    #[command(subcommand)]
    command: RampCommand,
}

#[derive(Subcommand)]
enum RampCommand {
    /// Bake every recipe to a PNG beside it.
    Bake(bake::Arguments),
    /// Bake recipes again whenever they are saved, until Ctrl-C.
    Watch(watch::Arguments),
    /// Write a new recipe from a template, or a blank ramp to paint over.
    New(new::Arguments),
    /// Convert a PNG, or another program's gradient, to a recipe.
    Import(import::Arguments),
    /// Write the gradient of a recipe for other programs: SVG, CSS or GIMP.
    Export(export::Arguments),
    /// Path-trace a puff of steam, ash, … under a ring of lights, and write ramps that are fitted to its brightness.
    Fit(fit::Arguments),
    /// Path-trace clouds of many puffs under a ring of lights, and write a shadow ramp that is fitted to the light that
    /// comes through them.
    FitShadow(fit_shadow::Arguments),
    /// Render a preset with every ramp of a folder, on one labelled sheet. Ramps that cannot be read are reported and
    /// left out; the command then exits with 1.
    Sheet(sheet::Arguments),
    /// Show a ramp and its luminance curve in the terminal, or write them as an image.
    Show(show::Arguments),
    /// Report visible flaws: steps, seams, specular ramps that do not end in black, wrong color spaces. Exits with 1 if
    /// there are any. Banding is a warning, with the commands that cure it.
    Check(check::Arguments),
}

pub fn run(arguments: &RampArguments) -> Result<(), Failures> {
    match &arguments.command {
        RampCommand::Bake(arguments) => bake::run(arguments),
        RampCommand::Watch(arguments) => watch::run(arguments),
        RampCommand::New(arguments) => new::run(arguments).map_err(Failures::from),
        RampCommand::Fit(arguments) => fit::run(arguments).map_err(Failures::from),
        RampCommand::FitShadow(arguments) => fit_shadow::run(arguments).map_err(Failures::from),
        RampCommand::Import(arguments) => import::run(arguments).map_err(Failures::from),
        RampCommand::Export(arguments) => export::run(arguments).map_err(Failures::from),
        RampCommand::Sheet(arguments) => sheet::run(arguments),
        RampCommand::Show(arguments) => show::run(arguments).map_err(Failures::from),
        RampCommand::Check(arguments) => check::run(arguments),
    }
}
