//! Main window: its layout, and the order of work in a frame.

mod device;
pub mod drag_end;
#[cfg(not(target_arch = "wasm32"))]
pub mod open;
#[cfg(target_arch = "wasm32")]
pub mod page_window;
mod panel_size;
mod status_bar;
pub mod surface_pacing;
mod system_thumbnails;
#[cfg(test)]
pub mod testing;
mod title_bar;

use std::path::Path;

use eframe::egui::{self, Ui};
use haze_core::error::Error;
use haze_core::settings::DebugView;

use crate::files::export_job::{ExportJob, ExportKind};
use crate::files::file_actions::FileActions;
use crate::files::hot_reload::{HotReload, ShaderFolder};
use crate::files::persistence::{Layout, Persistence};
use crate::files::preset_thumbnails::PresetThumbnails;
use crate::files::shared_look;
use crate::files::thumbnail_cache::ThumbnailCache;
use crate::files::window_screenshot::Screenshot;
use crate::panels;
use crate::panels::debug_view_strip::{debug_view_strip, filled_height, next_debug_view};
use crate::panels::start_view::StartChoice;
use crate::platform::idle_timer::IdleTimer;
use crate::platform::{IS_PAGE, clock, file_io, print_error};
use crate::session::Session;
use crate::session::action::{ACTIONS, Action, keys_of};
use crate::session::first_run_hints::WindowPart;
use crate::session::view_options::Tab;
use crate::viewport::Viewport;
use crate::viewport::pixel_readout as inspector;
use crate::viewport::probe_job::ProbeJob;
use crate::viewport_renderer::ViewportRenderer;
use panel_size::PanelTracker;
use system_thumbnails::SystemThumbnails;

pub struct Window {
    pub session: Session,
    renderer: ViewportRenderer,
    pub hot_reload: HotReload,
    viewport: Viewport,
    pub file_actions: FileActions,
    pub thumbnails: PresetThumbnails,
    system_thumbnails: SystemThumbnails,
    pub export_job: ExportJob,
    /// The presets to start from are shown.
    has_start_view: bool,
    idle: IdleTimer,
    pub persistence: Option<Persistence>,
    layout: Layout,
    settings_size: PanelTracker,
    strip_size: PanelTracker,
    shaders: ShaderFolder,
    has_dialogs: bool,
    adapter: String,
    probe_job: Option<ProbeJob>,
    screenshot: Screenshot,
}

/// Use of a copied link, for those who cannot guess it.
const LINK_USE: &str =
    if IS_PAGE { "" } else { ". Open it with `haze 'LINK'`, or append it to the address of a haze page." };

/// Longest click where the CPU draws, seconds.
const MAX_CLICK_SECONDS: f64 = 3.0;

/// State that a window starts with.
pub struct Start {
    pub session: Session,
    pub shaders: ShaderFolder,
    /// `None` persists nothing.
    pub persistence: Option<Persistence>,
    pub layout: Layout,
    /// The system may have file dialogs.
    pub has_dialogs: bool,
    pub cache: ThumbnailCache,
    /// Begins with presets to start from.
    pub has_start_view: bool,
}

impl Window {
    /// # Errors
    /// [`AssetError::Io`](haze_core::error::AssetError::Io) if the system cannot start another thread.
    pub fn new(renderer: ViewportRenderer, start: Start) -> Result<Self, Error> {
        let Start { mut session, shaders, persistence, layout, has_dialogs, cache, has_start_view } = start;
        session.attach_window(renderer.egui());
        renderer.egui().add_glyph_rasterizer(panels::rows::copy_icon::rasterizer());
        if renderer.is_software() {
            // A frame can take longer than the 0.8 s after which egui takes a press for no click.
            renderer.egui().options_mut(|options| options.input_options.max_click_duration = MAX_CLICK_SECONDS);
        }
        if session.screenshot.is_some() {
            renderer.draw_stages_at_once();
        }
        session.view.has_strip = layout.has_strip.unwrap_or(session.view.has_strip);
        session.inspect.is_docked = layout.has_docked_inspector.unwrap_or_default();
        match &layout.hints {
            Some(left) => session.hints.resume(left),
            None if persistence.is_some() && layout == Layout::default() => session.hints.begin(),
            None => {}
        }
        if let Some(theme) = layout.theme() {
            renderer.egui().set_theme(theme);
        }
        let mut window = Self {
            hot_reload: HotReload::new(&session, &shaders, &renderer, renderer.wake())?,
            file_actions: FileActions::new(has_dialogs, renderer.wake())?,
            thumbnails: PresetThumbnails::new(cache, renderer.wake())?,
            system_thumbnails: SystemThumbnails::default(),
            export_job: ExportJob::new(renderer.wake(), layout.export_folder.clone())?,
            viewport: Viewport::default(),
            has_start_view: false,
            idle: IdleTimer::default(),
            persistence,
            layout,
            settings_size: PanelTracker::default(),
            strip_size: PanelTracker::default(),
            shaders,
            has_dialogs,
            adapter: renderer.adapter(),
            // Without a thread there is no inspector.
            probe_job: ProbeJob::new(renderer.egui()).ok(),
            screenshot: Screenshot::default(),
            session,
            renderer,
        };
        if has_start_view {
            window.open_start_view();
        }
        Ok(window)
    }

    /// Returns the state that another window can continue with.
    pub fn into_start(self) -> Start {
        let Self { session, shaders, persistence, layout, has_dialogs, thumbnails, has_start_view, .. } = self;
        let cache = thumbnails.cache;
        Start { session, shaders, persistence, layout, has_dialogs, cache, has_start_view }
    }

    #[cfg(test)]
    pub fn renderer(&self) -> &ViewportRenderer {
        &self.renderer
    }

    #[cfg(test)]
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    #[cfg(test)]
    pub fn session_mut(&mut self) -> &mut Session {
        &mut self.session
    }

    /// Runs the actions of pressed keys, unless text is being edited.
    fn keys(&mut self, ui: &Ui) {
        let is_requested = self.file_actions.waiting.is_some()
            || self.file_actions.typed.is_some()
            || self.session.copy_request.is_some();
        let is_modal = self.session.search.is_open || self.session.view.help || self.has_start_view || is_requested;
        // An open menu receives the keys, such as Escape to close it.
        let is_menu = egui::Popup::is_any_open(ui.ctx());
        if ui.ctx().text_edit_focused() || is_modal || is_menu || self.viewport.is_dragging() {
            return;
        }
        // Gradient stops are pasted into the gradient editor.
        let is_for_stops = self.session.view.tab == Tab::Ramps && self.session.ramps.takes_paste();
        for text in ui.input(pasted).into_iter().filter(|_| !is_for_stops) {
            self.session.paste(&text);
        }
        // Escape closes the topmost item first.
        if ui.input(|input| input.key_pressed(egui::Key::Escape))
            && (self.export_job.dismiss() || self.session.looks.close() || self.session.hints.dismiss())
        {
            ui.input_mut(|input| input.consume_key(egui::Modifiers::NONE, egui::Key::Escape));
        }
        // A focused control receives Space and other keys without modifiers.
        let is_free = ui.memory(egui::Memory::focused).is_none();
        for entry in ACTIONS.iter().filter(|entry| is_free || entry.keys.modifiers.any()) {
            if ui.input_mut(|input| input.consume_shortcut(&entry.keys)) {
                self.act(entry.action, ui.ctx());
            }
        }
    }

    fn act(&mut self, action: Action, context: &egui::Context) {
        let session = &mut self.session;
        match action {
            Action::Presets => self.open_start_view(),
            Action::Open => self.file_actions.ask_open(session),
            Action::Save => self.file_actions.save(session),
            Action::SaveAs => self.file_actions.save_as(session),
            Action::Copy => {
                context.copy_text(session.document.to_json());
                session.messages.info("file", "Copied the preset as text");
            }
            Action::CopyLink => match shared_look::fragment_of(session) {
                Ok(fragment) => {
                    context.copy_text(file_io::link_address(&fragment));
                    session.messages.info("file", format!("Copied a link to this look{LINK_USE}"));
                }
                Err(error) => session.messages.error("file", error),
            },
            Action::Screenshot => self.export_job.start(ExportKind::Image, session),
            Action::Seeds => self.export_job.start(ExportKind::Seeds, session),
            Action::EngineFlipbook => self.export_job.start(ExportKind::EngineFlipbook, session),
            Action::Export => self.export_job.is_open = !self.export_job.is_open,
            Action::Paste => context.send_viewport_cmd(egui::ViewportCommand::RequestPaste),
            Action::Undo => session.undo(),
            Action::Redo => session.redo(),
            Action::Find => session.search.open(),
            Action::Play => session.playback.is_playing = !session.playback.is_playing,
            Action::StepBack => session.playback.step(-1.0),
            Action::StepOn => session.playback.step(1.0),
            Action::Loop => session.playback.is_looping = !session.playback.is_looping,
            Action::Strip => session.view.has_strip = !session.view.has_strip,
            Action::Inspect => session.inspect.toggle(),
            Action::Compare(against) => session.compare.toggle(against),
            Action::NextStage => session.view.debug_view = next_debug_view(session.view.debug_view),
            Action::Image => session.view.debug_view = DebugView::Final,
            Action::Help => session.view.help = !session.view.help,
            Action::InView(action) => self.viewport.act(action, session),
        }
    }

    /// Shows the presets to start from.
    fn open_start_view(&mut self) {
        self.has_start_view = true;
        let folder = self.session.document.path().parent().unwrap_or(Path::new(""));
        self.thumbnails.list(folder, self.session.assets.as_deref(), &self.layout.recent);
    }

    fn start_view(&mut self, ui: &Ui) {
        // A focused card receives Space.
        let is_free = ui.memory(egui::Memory::focused).is_none();
        if is_free && keys_of(Action::Play).is_some_and(|keys| ui.input_mut(|input| input.consume_shortcut(&keys))) {
            self.act(Action::Play, ui.ctx());
        }
        let Some(choice) = panels::start_view::panel(ui, &mut self.thumbnails, self.idle) else { return };
        self.has_start_view = false;
        self.thumbnails.stop();
        match choice {
            StartChoice::Open(path) => self.file_actions.open(path, &self.session),
            StartChoice::AskOpen => self.file_actions.ask_open(&self.session),
            StartChoice::Close => {}
        }
    }

    /// Draws the bars above and below the image.
    fn bars(&mut self, ui: &mut Ui) {
        egui::Panel::top("top").show(ui, |ui| self.title_bar(ui));
        panels::notice_bar::panel(ui, &mut self.session, self.persistence.as_mut());
        egui::Panel::bottom("status").show(ui, |ui| self.status_bar(ui));
        egui::Panel::bottom("time").show(ui, |ui| panels::timeline::panel(ui, &mut self.session));
        self.tracks(ui);
        if self.session.view.has_strip && !panels::narrow::is_narrow(ui.ctx()) {
            let aspect = self.session.view.aspect;
            let room = ui.available_height();
            let usual = (0.12 * room).max(80.0).min(filled_height(ui.available_width()));
            let height = self.strip_size.begin(ui.ctx(), self.layout.strip_height, room, usual);
            let most = (0.25 * room).clamp(56.0, 320.0);
            let panel = egui::Panel::bottom("strip").resizable(true).default_size(height).size_range(56.0..=most);
            let shown = panel.show(ui, |ui| debug_view_strip(ui, &mut self.session, &self.renderer, aspect));
            let shown = shown.response.rect.height();
            self.strip_size.end(ui.ctx(), shown, room, &mut self.layout.strip_height);
        }
    }

    /// Draws the keyframes, if there are any.
    fn tracks(&mut self, ui: &mut Ui) {
        let is_empty = self.session.document.preset.animation.is_empty();
        if is_empty || self.session.view.tracks.is_closed || panels::narrow::is_narrow(ui.ctx()) {
            return;
        }
        let most = 0.4 * ui.available_height();
        let height = panels::track_editor::filled_height(&self.session).min(most);
        let panel = egui::Panel::bottom("tracks").exact_size(height);
        panel.show(ui, |ui| panels::track_editor::panel(ui, &mut self.session));
    }

    /// Draws the settings panel: at the right, or below the image of a narrow window.
    fn settings(&mut self, ui: &mut Ui) {
        // Those of the presets come first.
        if !self.has_start_view {
            self.system_thumbnails.advance(ui.ctx(), &mut self.session, self.idle);
        }
        if panels::narrow::is_narrow(ui.ctx()) {
            let height = 0.4 * ui.available_height();
            let panel = egui::Panel::bottom("settings_below").resizable(true).default_size(height);
            let shown = panel
                .size_range(80.0..=1.6 * height)
                .show(ui, |ui| panels::settings_panel::panel(ui, &mut self.session));
            return self.run_settings(shown.response.rect, shown.inner);
        }
        let room = ui.available_width();
        let usual = (0.18 * room).clamp(370.0, 440.0);
        let width = self.settings_size.begin(ui.ctx(), self.layout.settings_width, room, usual);
        // The image stays the largest part, even in a small window.
        let most = (0.45 * room).clamp(240.0, 560.0);
        let settings = egui::Panel::right("settings").default_size(width).size_range(240.0..=most);
        let shown = settings.show(ui, |ui| panels::settings_panel::panel(ui, &mut self.session));
        let width = shown.response.rect.width();
        self.settings_size.end(ui.ctx(), width, room, &mut self.layout.settings_width);
        self.run_settings(shown.response.rect, shown.inner);
    }

    /// Runs the requests of the settings panel.
    fn run_settings(&mut self, rect: egui::Rect, sheet_of: Option<String>) {
        self.session.hints.record_rect(WindowPart::Settings, rect);
        if let Some(path) = sheet_of {
            let is_seed = path.ends_with(".emitter.seed");
            let product = if is_seed { ExportKind::Seeds } else { ExportKind::Values(path) };
            self.export_job.start(product, &mut self.session);
        }
    }

    /// Draws the image, and all that opens over it.
    fn image_and_popups(&mut self, ui: &mut Ui, is_touched: bool) {
        inspector::docked_panel(ui, &mut self.session);
        egui::CentralPanel::no_frame().show(ui, |ui| {
            let rect = ui.max_rect();
            self.session.hints.record_rect(WindowPart::Image, rect);
            self.viewport.show(ui, &mut self.session, &self.renderer);
            inspector::panel(ui, rect, &mut self.session);
            panels::look_browser::panel(ui, &mut self.session, rect);
        });
        if let Some(probe_job) = &mut self.probe_job {
            probe_job.update(ui, &mut self.session, &self.renderer);
        }
        if !self.has_start_view {
            panels::hint_popup::panel(ui, &mut self.session, is_touched, self.viewport.is_dragging());
        }
        panels::search_box::panel(ui, &mut self.session);
        panels::key_list::panel(ui, &mut self.session);
        panels::export_dialog::panel(ui, &mut self.export_job, &mut self.session);
        self.ask_export();
        panels::copy_question::panel(ui, &mut self.session);
        let Session { ramps, sprites, simulation, .. } = &mut self.session;
        let waiting =
            [&mut ramps.needs_saved_preset, &mut sprites.needs_saved_preset, &mut simulation.needs_saved_preset];
        let cannot_save = waiting.map(std::mem::take);
        if cannot_save.contains(&true) {
            self.file_actions.save_as(&self.session);
        }
        panels::file_menu::questions(ui, &mut self.file_actions, &mut self.session);
        if self.has_start_view {
            self.start_view(ui);
        }
    }

    /// Asks where an export goes, and passes on the answer.
    fn ask_export(&mut self) {
        if let Some(suggested) = self.export_job.take_question() {
            self.file_actions.ask_export(suggested);
        }
        if let Some(chosen) = self.file_actions.take_exported() {
            self.export_job.answer(chosen, &mut self.session);
        }
    }

    /// Records the edits of the frame, writes files that are due, and reports errors of the renderer.
    fn end_frame(&mut self, ui: &Ui, frame: &eframe::Frame) {
        let is_held = ui.input(|input| input.pointer.any_down()) || ui.ctx().text_edit_focused();
        self.session.track(is_held || self.viewport.is_held(ui));
        if let Some(persistence) = &mut self.persistence {
            persistence.advance(&mut self.session, ui.ctx());
        }
        self.layout.record(ui.ctx(), &self.session);
        self.layout.export_folder = self.export_job.folder.clone();
        self.persistence
            .iter_mut()
            .for_each(|persistence| persistence.write_layout(&self.layout, &self.file_actions, ui.ctx()));
        let Session { timings, view, document, compare, .. } = &mut self.session;
        let is_seen = view.tab == Tab::Performance || compare.against.is_some();
        if timings.follow(&self.renderer, is_seen, frame.info().cpu_usage, &document.preset) {
            ui.ctx().request_repaint();
        }
        match self.renderer.error() {
            Some(error) => self.session.messages.error("image", error),
            None => self.session.messages.clear("image"),
        }
        if let Some(error) = self.renderer.health().take_error() {
            // An error in the commands of a frame can leave the window without an image, and without this message.
            print_error(&error);
            self.session.messages.error("device", error);
        }
        if self.is_playing() {
            ui.ctx().request_repaint();
        }
    }

    /// Returns true if time passes. Where the CPU draws, it stands behind the start view, and leaves the time to its
    /// thumbnails.
    fn is_playing(&self) -> bool {
        self.session.playback.is_playing && !(self.has_start_view && self.renderer.is_software())
    }
}

/// Returns the texts that were pasted in this frame.
fn pasted(input: &egui::InputState) -> Vec<String> {
    let texts = input.events.iter().map(|event| match event {
        egui::Event::Paste(text) => Some(text.clone()),
        _ => None,
    });
    texts.flatten().collect()
}

impl eframe::App for Window {
    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        let acts = ui.input(|input| input.pointer.any_pressed() || !input.keys_down.is_empty());
        if let Some(left) = self.session.messages.advance(clock::now(), acts) {
            ui.ctx().request_repaint_after(left);
        }
        self.idle.follow(ui.ctx());
        self.keys(ui);
        self.hot_reload.advance(&mut self.session, &self.renderer);
        let is_touched = ui.input(|input| input.pointer.any_down() || input.smooth_scroll_delta() != egui::Vec2::ZERO);
        let is_turning = self.session.view.lights.turn.is_some();
        let is_playing = self.is_playing();
        self.renderer.begin_frame(is_touched, is_turning || is_playing);
        self.file_actions.advance(&mut self.session, ui.ctx());
        if is_playing {
            self.session.playback.advance(f64::from(ui.input(|input| input.stable_dt)));
        }
        panels::narrow::set_spacing(ui);
        self.bars(ui);
        self.settings(ui);
        self.image_and_popups(ui, is_touched);
        self.end_frame(ui, frame);
        self.screenshot.advance(ui, &mut self.session);
    }

    fn on_exit(&mut self) {
        self.file_actions.finish();
        if let Some(persistence) = self.persistence.take() {
            persistence.finish(&self.layout);
        }
    }
}

#[cfg(test)]
mod tests;
