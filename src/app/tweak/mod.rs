//! `haze tweak`: a window to light smoke in.

mod action;
mod angles;
mod compare;
#[allow(dead_code, reason = "what the window is about to use")]
mod document;
mod gpu;
mod icon;
mod lights;
mod messages;
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
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
mod viewport;
mod window;

use std::path::PathBuf;

use clap::Args;
use eframe::{egui, egui_wgpu, wgpu};
use glam::UVec2;
use haze::Error;
use haze::settings::set_field;
use haze::shader::Sources;

use super::options::{in_option, parse_assignment, parse_size};
use reload::ShaderFolder;
use session::Session;
use window::Window;

#[derive(Args)]
pub struct Arguments {
    /// A built-in preset's name (see `haze preset list`), or the path of a JSON file.
    #[arg(default_value = "column")]
    preset: PathBuf,
    /// Size of the window, points.
    #[arg(long, value_name = "WxH", default_value = "1280x800", value_parser = parse_size, allow_hyphen_values = true)]
    size: UVec2,
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
        Self { preset: "column".into(), size: UVec2::new(1280, 800), set: Vec::new(), shaders: None, screenshot: None }
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
    let options = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_app_id("haze")
            .with_title("haze")
            .with_inner_size(arguments.size.as_vec2().to_array())
            .with_min_inner_size([640.0, 400.0]),
        wgpu_options: egui_wgpu::WgpuConfiguration { wgpu_setup: setup(), ..Default::default() },
        ..Default::default()
    };
    let window = |context: &eframe::CreationContext<'_>| {
        Ok(Box::new(Window::new(context, session, &shaders)?) as Box<dyn eframe::App>)
    };
    check_display()?;
    eframe::run_native("haze", options, Box::new(window)).map_err(no_window)
}

/// The fastest adapter, or the one that WGPU_ADAPTER_NAME and WGPU_BACKEND choose.
fn setup() -> egui_wgpu::WgpuSetup {
    let mut setup = egui_wgpu::WgpuSetupCreateNew::without_display_handle();
    setup.device_descriptor = std::sync::Arc::new(|adapter| {
        let timing = wgpu::Features::TIMESTAMP_QUERY | wgpu::Features::TIMESTAMP_QUERY_INSIDE_PASSES;
        wgpu::DeviceDescriptor {
            label: Some("haze window"),
            required_features: timing & adapter.features(),
            required_limits: wgpu::Limits::downlevel_webgl2_defaults().using_resolution(adapter.limits()),
            ..Default::default()
        }
    });
    setup.into()
}

/// What draws where there can be no window.
const INSTEAD: &str = "`haze render` draws to files without one";

/// Says so where there is nothing to open a window on, better than a window library does.
fn check_display() -> Result<(), Error> {
    let is_set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    if !cfg!(target_os = "linux") || ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"].into_iter().any(is_set) {
        return Ok(());
    }
    let reason = "no display for a window: neither DISPLAY nor WAYLAND_DISPLAY is set";
    Err(Error::NoDevice(format!("{reason}; {INSTEAD}, and under `xvfb-run` a window opens on none")))
}

/// Why there is no window, and what to do instead.
fn no_window(error: eframe::Error) -> Error {
    match error {
        eframe::Error::AppCreation(error) => match error.downcast::<Error>() {
            Ok(error) => *error,
            Err(error) => Error::Device(error.to_string()),
        },
        eframe::Error::Wgpu(error) => Error::NoDevice(format!(
            "no graphics adapter for a window ({error}); on Debian and Ubuntu `apt-get install mesa-vulkan-drivers` \
             installs a software one; {INSTEAD}"
        )),
        error => Error::NoDevice(format!("no window: {error}; {INSTEAD}")),
    }
}
