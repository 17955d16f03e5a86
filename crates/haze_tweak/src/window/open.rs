//! Opens the window, and opens it again with the same session when the graphics device is lost.

use eframe::{egui, egui_wgpu};
use haze_core::error::{Error, one_line};
use haze_demo::headless::check_address_space;

use super::device::setup;
use super::drag_end::split_events_at_buttons;
use super::surface_pacing::paced_surface_handler;
use super::{Start, Window};
use crate::platform::clock::{self, Duration};
use crate::viewport_renderer::ViewportRenderer;
use crate::viewport_renderer::device_health::{DeviceHealth, destroy_device};

/// Two device losses within this time end the program.
const MIN_TIME_BETWEEN_LOSSES: Duration = Duration::from_secs(10);

/// Environment variable with the frames, counted over all windows, in which the device is destroyed: "5,9". For tests.
const LOSE_DEVICE: &str = "HAZE_TEST_LOSE_DEVICE";

/// Alternative that error messages name where no window can be opened.
const INSTEAD: &str = "`haze render` draws to files without one";

/// State that is kept while one window closes and the next opens.
struct KeptState {
    /// `None` while a window owns it.
    start: Option<Start>,
    /// Memory of egui: sizes of panels, collapsed sections.
    memory: Option<egui::Memory>,
    /// Position and size of the window.
    viewport: egui::ViewportBuilder,
    is_lost: bool,
    /// Number of frames that were shown.
    frames: u32,
    /// Frames in which the device is destroyed.
    destroy_in: Vec<u32>,
}

/// Shows a session in a window until the user closes it. `size` is in points; `None` leaves it to the adapter.
pub fn open(start: Start, size: Option<egui::Vec2>) -> Result<(), Error> {
    check_display()?;
    check_address_space()?;
    let destroy_in = std::env::var(LOSE_DEVICE).unwrap_or_default();
    let destroy_in = destroy_in.split(',').filter_map(|frame| frame.parse().ok()).collect();
    let viewport = egui::ViewportBuilder::default().with_inner_size(size.unwrap_or(DEFAULT_SIZE));
    let mut kept = KeptState { start: Some(start), memory: None, viewport, is_lost: false, frames: 0, destroy_in };
    let mut is_sized = size.is_some();
    let mut last_loss = None;
    loop {
        let opened = open_once(&mut kept, is_sized);
        if !std::mem::take(&mut kept.is_lost) {
            return match last_loss {
                Some(_) => opened.map_err(|error| {
                    write_recovery_and_fail(&mut kept, &format!("it was lost and cannot be reopened: {error}"))
                }),
                None => opened,
            };
        }
        let now = clock::now();
        if last_loss.replace(now).is_some_and(|last| now.saturating_duration_since(last) < MIN_TIME_BETWEEN_LOSSES) {
            return Err(write_recovery_and_fail(&mut kept, "it was lost twice within 10 seconds"));
        }
        is_sized = true;
    }
}

/// Default size of a window in points, and the size where the CPU draws.
const DEFAULT_SIZE: egui::Vec2 = egui::Vec2::new(1280.0, 800.0);
const DEFAULT_SOFTWARE_SIZE: egui::Vec2 = egui::Vec2::new(1000.0, 640.0);

fn open_once(kept: &mut KeptState, is_sized: bool) -> Result<(), Error> {
    let options = eframe::NativeOptions {
        viewport: kept.viewport.clone().with_app_id("haze").with_title("haze").with_min_inner_size([640.0, 400.0]),
        wgpu_options: egui_wgpu::WgpuConfiguration {
            wgpu_setup: setup(),
            on_surface_status: paced_surface_handler(),
            ..Default::default()
        },
        ..Default::default()
    };
    let state = &mut *kept;
    let app: eframe::AppCreator<'_> = Box::new(move |context| {
        let renderer = ViewportRenderer::new(context)?;
        if let Some(memory) = state.memory.take() {
            context.egui_ctx.memory_mut(|new| *new = memory);
        }
        if !is_sized && renderer.is_software() {
            context.egui_ctx.send_viewport_cmd(egui::ViewportCommand::InnerSize(DEFAULT_SOFTWARE_SIZE));
        }
        let health = renderer.health().clone();
        let window = state.start.take().map(|start| Window::new(renderer, start)).transpose()?;
        Ok(Box::new(WindowApp { window, health, kept: state, later: Vec::new() }) as Box<dyn eframe::App>)
    });
    let ended = eframe::run_native("haze", options, app);
    ended.map_err(|error| no_window(error, kept.frames > 0))
}

/// App of eframe around the window, while the device works.
struct WindowApp<'a> {
    window: Option<Window>,
    health: DeviceHealth,
    kept: &'a mut KeptState,
    /// Events that later frames take.
    later: Vec<egui::Event>,
}

impl eframe::App for WindowApp<'_> {
    fn raw_input_hook(&mut self, context: &egui::Context, input: &mut egui::RawInput) {
        split_events_at_buttons(&mut self.later, &mut input.events);
        if !self.later.is_empty() {
            context.request_repaint();
        }
    }

    fn logic(&mut self, context: &egui::Context, frame: &mut eframe::Frame) {
        if !self.health.is_lost() {
            if let Some(window) = &mut self.window {
                window.logic(context, frame);
            }
        } else if !std::mem::replace(&mut self.kept.is_lost, true) {
            self.kept.memory = Some(context.memory(Clone::clone));
            self.kept.viewport = context.input(|input| viewport_builder(input.viewport()));
            context.send_viewport_cmd(egui::ViewportCommand::Close);
        }
    }

    fn ui(&mut self, ui: &mut egui::Ui, frame: &mut eframe::Frame) {
        // egui panics if it uploads to a lost device. An empty frame uploads nothing.
        if self.kept.is_lost {
            return;
        }
        if let Some(window) = &mut self.window {
            window.ui(ui, frame);
        }
        self.kept.frames += 1;
        if self.kept.destroy_in.contains(&self.kept.frames) {
            destroy_device(ui);
        }
    }

    fn on_exit(&mut self) {
        // After a device loss the session continues in another window.
        if !self.kept.is_lost
            && let Some(window) = &mut self.window
        {
            window.on_exit();
        }
    }
}

impl Drop for WindowApp<'_> {
    fn drop(&mut self) {
        self.kept.start = self.window.take().map(Window::into_start);
    }
}

/// Returns a builder with the position and size of this window.
fn viewport_builder(window: &egui::ViewportInfo) -> egui::ViewportBuilder {
    let mut viewport = egui::ViewportBuilder::default()
        .with_maximized(window.maximized.unwrap_or_default())
        .with_fullscreen(window.fullscreen.unwrap_or_default());
    viewport.inner_size = window.inner_rect.map(|rect| rect.size());
    viewport.position = window.outer_rect.map(|rect| rect.min);
    viewport
}

/// Writes unsaved work to the recovery file, and returns the error that ends the program.
fn write_recovery_and_fail(kept: &mut KeptState, reason: &str) -> Error {
    let start = kept.start.as_mut().filter(|start| start.session.document.is_dirty());
    let Some(Start { session, persistence, .. }) = start else {
        return Error::Device(format!("{reason}; there was no unsaved work"));
    };
    let saved = match persistence {
        Some(persistence) => persistence.write(&session.document).map_err(|error| error.to_string()),
        None => Err("there is no folder for it; set HOME".into()),
    };
    Error::Device(match saved {
        Ok(()) => format!("{reason}; unsaved work is kept for the next start"),
        Err(error) => format!("{reason}; unsaved work could not be kept: {error}"),
    })
}

/// Returns an error if there is no display. Its text is clearer than that of the windowing library.
fn check_display() -> Result<(), Error> {
    let is_set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    if !cfg!(target_os = "linux") || ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"].into_iter().any(is_set) {
        return Ok(());
    }
    let reason = "no display for a window: neither DISPLAY nor WAYLAND_DISPLAY is set";
    Err(Error::NoDevice(format!("{reason}; to open it, start haze in a desktop session or by `ssh -X`; {INSTEAD}")))
}

/// Converts an error of eframe to one that tells the reason and a remedy. The texts of the windowing library name a source
/// file of it instead.
fn no_window(error: eframe::Error, was_shown: bool) -> Error {
    match error {
        eframe::Error::AppCreation(error) => match error.downcast::<Error>() {
            Ok(error) => *error,
            Err(error) => Error::Device(error.to_string()),
        },
        eframe::Error::Wgpu(error) => Error::NoDevice(format!(
            "no graphics adapter for a window ({error}); on Debian and Ubuntu `apt-get install mesa-vulkan-drivers` \
             installs a software one; {INSTEAD}"
        )),
        eframe::Error::WinitEventLoop(_) if !was_shown => {
            Error::NoDevice(format!("{}; {INSTEAD}", unreachable_display()))
        }
        eframe::Error::WinitEventLoop(_) | eframe::Error::Winit(_) => {
            Error::NoDevice(format!("the display closed the window or refused to open it; {INSTEAD}"))
        }
    }
}

/// Returns a message that names the displays that were tried.
fn unreachable_display() -> String {
    let named = ["WAYLAND_DISPLAY", "DISPLAY"].into_iter().filter_map(|name| {
        let value = std::env::var_os(name).filter(|value| !value.is_empty())?;
        Some(format!("{name}={}", one_line(value.to_string_lossy())))
    });
    let named = named.collect::<Vec<_>>().join(" and ");
    let named = if named.is_empty() { String::new() } else { format!(" with {named}") };
    format!("no display for a window: none could be opened{named}; expected a display that runs and admits this user")
}
