//! Command line of the tweaker.

use std::path::{Path, PathBuf};

use clap::Args;
use eframe::egui;
use glam::UVec2;
use haze_core::error::Error;
use haze_export::options::{AssetsArguments, parse_assignment, parse_size, with_option};
use haze_export::share_link;

use super::files::hot_reload::ShaderFolder;
use super::files::persistence::{Layout, Persistence};
use super::files::shared_look;
use super::files::thumbnail_cache::ThumbnailCache;
use super::platform::file_dialog::Dialogs;
use super::platform::{asset_loading, file_io, state_folder};
use super::session::Session;
use super::session::playback::Playback;
use super::window::Start;
use super::window::open::open;

/// Arguments of the tweaker.
#[derive(Args, Default)]
pub struct Arguments {
    /// A built-in preset's name (see `haze preset list`), the path of a JSON file, or a link to a look, in quotes. Without
    /// one, the window begins with presets to choose from.
    preset: Option<PathBuf>,
    /// Size of the window in points. Default: the last size, or 1280x800, or 1000x640 where the CPU draws.
    #[arg(long, value_name = "WxH", value_parser = parse_size, allow_hyphen_values = true)]
    size: Option<UVec2>,
    /// Sets a field of the preset, as in `haze render`. May be given more than once.
    #[arg(long, value_name = "FIELD=VALUE", value_parser = parse_assignment)]
    set: Vec<(String, String)>,
    /// Folder with shaders that replace the built-in ones of the same file names, reloaded when they change. A program
    /// started by `cargo run` uses the `shaders` folder of its checkout.
    #[arg(long, value_name = "DIR")]
    shaders: Option<PathBuf>,
    #[command(flatten)]
    assets: AssetsArguments,
    /// Write an image of the window once it has settled, then close it.
    #[arg(long, value_name = "FILE.png")]
    screenshot: Option<PathBuf>,
}

/// Opens the window, and returns once it is closed.
///
/// # Errors
/// Of the preset and its files; [`Error::NoDevice`] without a display or a driver.
pub fn run(arguments: &Arguments) -> Result<(), Error> {
    let preset = arguments.preset.as_deref().unwrap_or(Path::new("column"));
    let mut session = match share_link::fragment_of_name(preset) {
        Some(fragment) => shared_look::open(fragment, &link_folder(fragment))?,
        None => Session::open(preset, arguments.assets.folder()?)?,
    };
    for (field, value) in &arguments.set {
        session.document.preset.set_field(field, value).map_err(|error| with_option("--set", error))?;
    }
    session.document.preset.validate()?;
    session.playback = Playback::of(&session.document.preset);
    session.screenshot = arguments.screenshot.clone();
    let shaders = match &arguments.shaders {
        Some(folder) => asset_loading::shaders(folder).map(|_| ShaderFolder::Given(folder.clone()))?,
        None => ShaderFolder::of_checkout(),
    };
    // A screenshot must not depend on the stored layout, so that it is the same on every machine.
    let state = state_folder::state(|name| std::env::var_os(name)).filter(|_| arguments.screenshot.is_none());
    let (layout, error) = state.as_ref().map_or_else(Default::default, |folder| Layout::read(folder));
    if let Some(error) = error {
        session.messages.error("layout", error);
    }
    let size = arguments.size.map(|size| size.as_vec2().to_array()).or(layout.window);
    let persistence = state.map(|folder| Persistence::new(folder, &mut session));
    let has_crashed_work = persistence.as_ref().is_some_and(|persistence| !persistence.crashed_work.is_empty());
    let is_plain = arguments.preset.is_none() && arguments.set.is_empty() && arguments.screenshot.is_none();
    let has_start_view = is_plain && !has_crashed_work;
    session.playback.is_playing = has_start_view;
    let cache = state_folder::cache(|name| std::env::var_os(name)).map(|folder| folder.join("thumbnails"));
    let start = Start {
        session,
        shaders,
        persistence,
        layout,
        has_dialogs: Dialogs::are_likely(|name| std::env::var_os(name)),
        cache: ThumbnailCache { folder: cache },
        has_start_view,
    };
    open(start, size.map(egui::Vec2::from))
}

/// Returns the folder for the ramps of a link.
fn link_folder(fragment: &str) -> PathBuf {
    let state = state_folder::state(|name| std::env::var_os(name)).unwrap_or_else(std::env::temp_dir);
    state.join("links").join(file_io::name_of_contents(fragment))
}
