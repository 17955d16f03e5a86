//! `haze tweak`: a window to light smoke in.

mod action;
mod angles;
mod compare;
#[allow(dead_code, reason = "what the window is about to use")]
mod document;
mod gpu;
mod health;
mod icon;
mod lights;
mod messages;
#[cfg(test)]
mod motion_tests;
mod open;
mod pace;
mod panel;
mod pictures;
#[allow(dead_code, reason = "what the window is about to use")]
mod platform;
mod playback;
mod referee;
mod reload;
mod search;
mod session;
mod show;
mod smoke;
mod strip;
mod surface;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
mod viewport;
mod window;

use std::path::PathBuf;

use clap::Args;
use eframe::egui;
use glam::UVec2;
use haze::Error;
use haze::settings::set_field;
use haze::shader::Sources;

use super::options::{in_option, parse_assignment, parse_size};
use open::open;
use reload::ShaderFolder;
use session::Session;

#[derive(Args)]
pub struct Arguments {
    /// A built-in preset's name (see `haze preset list`), or the path of a JSON file.
    #[arg(default_value = "column")]
    preset: PathBuf,
    /// Size of the window, points; 1280x800 where it is not given, 1000x640 where the CPU draws.
    #[arg(long, value_name = "WxH", value_parser = parse_size, allow_hyphen_values = true)]
    size: Option<UVec2>,
    /// Sets a field of the preset, as in `haze render`. May be given more than once.
    #[arg(long, value_name = "FIELD=VALUE", value_parser = parse_assignment)]
    set: Vec<(String, String)>,
    /// A folder like haze's own `shaders`, followed as it changes: its files take the place of those of the same names that the
    /// program has in it. Started by `cargo run`, the program follows its checkout's.
    #[arg(long, value_name = "DIR")]
    shaders: Option<PathBuf>,
    /// Write a picture of the window once it stands still, and close it.
    #[arg(long, value_name = "FILE.png")]
    screenshot: Option<PathBuf>,
}

impl Default for Arguments {
    fn default() -> Self {
        Self { preset: "column".into(), size: None, set: Vec::new(), shaders: None, screenshot: None }
    }
}

pub fn run(arguments: &Arguments) -> Result<(), Error> {
    let mut session = Session::open(&arguments.preset)?;
    for (field, value) in &arguments.set {
        set_field(&mut session.document.preset, field, value).map_err(|error| in_option("--set", error))?;
    }
    session.document.preset.validate()?;
    session.screenshot = arguments.screenshot.clone();
    let shaders = match &arguments.shaders {
        Some(folder) => Sources::from_folder(folder).map(|_| ShaderFolder::Given(folder.clone()))?,
        None => ShaderFolder::of_checkout(),
    };
    open(session, &shaders, arguments.size.map(|size| egui::Vec2::from(size.as_vec2().to_array())))
}
