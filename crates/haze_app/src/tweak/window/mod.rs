//! Main window: its layout, and the order of work in a frame.

pub mod drag_end;
pub mod open;
pub mod surface_pacing;
#[cfg(test)]
pub mod testing;

use std::path::Path;

use eframe::egui::{self, Ui};
use haze::Error;
use haze::settings::DebugView;

use crate::tweak::files::export_job::{ExportJob, ExportKind};
use crate::tweak::files::file_actions::FileActions;
use crate::tweak::files::hot_reload::{HotReload, ShaderFolder};
use crate::tweak::files::persistence::{Layout, Persistence};
use crate::tweak::files::preset_thumbnails::PresetThumbnails;
use crate::tweak::files::window_screenshot::Screenshot;
use crate::tweak::panels;
use crate::tweak::panels::comparison_bar::width;
use crate::tweak::panels::debug_view_strip::{after, strip};
use crate::tweak::platform::clock::Instant;
use crate::tweak::session::Session;
use crate::tweak::session::action::{ACTIONS, Action};
use crate::tweak::session::first_run_hints::Place;
use crate::tweak::session::messages::short;
use crate::tweak::session::view_options::Tab;
use crate::tweak::viewport::Viewport;
use crate::tweak::viewport::pixel_readout as inspector;
use crate::tweak::viewport::probe_job::Lens;
use crate::tweak::viewport_renderer::Easel;

pub struct Window {
    pub session: Session,
    easel: Easel,
    pub reload: HotReload,
    viewport: Viewport,
    pub filing: FileActions,
    pub thumbnails: PresetThumbnails,
    pub exporting: ExportJob,
    /// The list of presets is open.
    has_browser: bool,
    pub keeping: Option<Persistence>,
    layout: Layout,
    shaders: ShaderFolder,
    has_dialogs: bool,
    adapter: String,
    lens: Option<Lens>,
    screenshot: Screenshot,
}

/// State that a window starts with.
pub struct Start {
    pub session: Session,
    pub shaders: ShaderFolder,
    /// `None` persists nothing.
    pub keeping: Option<Persistence>,
    pub layout: Layout,
    /// The system may have file dialogs.
    pub has_dialogs: bool,
}

/// Tooltip where the CPU draws.
const SLOW: &str = "The CPU draws the picture, at a low resolution while something moves. A smaller window is faster.";

impl Window {
    /// # Errors
    /// [`Error::Io`] if the system cannot start another thread.
    pub fn new(easel: Easel, start: Start) -> Result<Self, Error> {
        let Start { mut session, shaders, keeping, layout, has_dialogs } = start;
        session.attach_window(easel.egui());
        session.show.has_strip = layout.has_strip.unwrap_or(session.show.has_strip);
        match &layout.hints {
            Some(left) => session.hints.go_on(left),
            None if keeping.is_some() && layout == Layout::default() => session.hints.begin(),
            None => {}
        }
        if let Some(theme) = layout.theme() {
            easel.egui().set_theme(theme);
        }
        Ok(Self {
            reload: HotReload::new(&session, &shaders, &easel, easel.wake())?,
            filing: FileActions::new(has_dialogs, easel.wake())?,
            thumbnails: PresetThumbnails::new(easel.wake())?,
            exporting: ExportJob::new(easel.wake())?,
            viewport: Viewport::default(),
            has_browser: false,
            keeping,
            layout,
            shaders,
            has_dialogs,
            adapter: easel.adapter(),
            // Without a thread there is no inspector.
            lens: Lens::new(easel.egui()).ok(),
            screenshot: Screenshot::default(),
            session,
            easel,
        })
    }

    /// Returns the state that another window can continue with.
    pub fn into_start(self) -> Start {
        let Self { session, shaders, keeping, layout, has_dialogs, .. } = self;
        Start { session, shaders, keeping, layout, has_dialogs }
    }

    #[cfg(test)]
    pub fn easel(&self) -> &Easel {
        &self.easel
    }

    #[cfg(test)]
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    #[cfg(test)]
    pub fn session_mut(&mut self) -> &mut Session {
        &mut self.session
    }

    fn top(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            if let Some(action) = panels::file_menu::menu(ui, &mut self.session) {
                self.act(action, ui.ctx());
            }
            // A quarter of the row, at about 7 points a character.
            let letters = (0.25 * ui.available_width() / 7.0).clamp(12.0, 40.0) as usize;
            ui.strong(short(&self.session.document.title(), letters))
                .on_hover_text(self.session.document.path().to_string_lossy());
            if self.session.document.is_dirty() {
                ui.label("•").on_hover_text("Has unsaved changes");
            }
            ui.separator();
            let undo = self.session.document.history().undo_name().map(str::to_owned);
            let redo = self.session.document.history().redo_name().map(str::to_owned);
            let button = ui.add_enabled(undo.is_some(), egui::Button::new("Undo"));
            if button.on_hover_text(undo.unwrap_or_default()).clicked() {
                self.session.undo();
            }
            let button = ui.add_enabled(redo.is_some(), egui::Button::new("Redo"));
            if button.on_hover_text(redo.unwrap_or_default()).clicked() {
                self.session.redo();
            }
            ui.separator();
            let others = ["Inspect", "Theme", "Find", "?"];
            let others: f32 = others.map(|name| width(ui, name) + ui.spacing().item_spacing.x).iter().sum();
            panels::comparison_bar::panel(ui, &mut self.session, ui.available_width() - others);
            let inspect = ui.selectable_label(self.session.inspect.is_on, "Inspect");
            if inspect.on_hover_text("Values of the pixel under the pointer (I); a click keeps it").clicked() {
                self.session.inspect.toggle();
            }
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                let keys = ui.button("?").on_hover_text("Keys and gestures");
                self.session.hints.see(Place::Keys, keys.rect);
                if keys.clicked() {
                    self.act(Action::Help, ui.ctx());
                }
                let find = ui.button("Find").on_hover_text("Finds a setting by its name or description");
                self.session.hints.see(Place::Find, find.rect);
                if find.clicked() {
                    self.act(Action::Find, ui.ctx());
                }
                theme(ui);
            });
        });
    }

    fn status(&mut self, ui: &mut Ui) {
        let mut is_read = false;
        let line = |ui: &mut Ui| {
            if self.easel.is_software() {
                ui.colored_label(ui.visuals().warn_fg_color, &self.adapter).on_hover_text(SLOW);
            } else {
                ui.weak(&self.adapter);
            }
            ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                if let Some(message) = self.session.messages.latest() {
                    let text = egui::RichText::new(&message.text);
                    let text = if message.is_error { text.color(ui.visuals().error_fg_color) } else { text };
                    let label = ui.add(egui::Label::new(text).truncate().sense(egui::Sense::click()));
                    is_read = label.on_hover_text("Click to dismiss").clicked();
                }
            });
        };
        ui.horizontal(|ui| ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), line));
        if is_read {
            self.session.messages.dismiss_latest();
        }
    }

    /// Runs the actions of pressed keys, unless text is being edited.
    fn keys(&mut self, ui: &Ui) {
        let is_requested = self.filing.waiting.is_some() || self.filing.typed.is_some();
        let is_modal = self.session.search.is_open || self.session.show.help || self.has_browser || is_requested;
        // An open menu receives the keys, such as Escape to close it.
        let is_menu = egui::Popup::is_any_open(ui.ctx());
        if ui.ctx().text_edit_focused() || is_modal || is_menu || self.viewport.is_dragging() {
            return;
        }
        // Gradient stops are pasted into the gradient editor.
        let is_for_stops = self.session.show.tab == Tab::Ramps && self.session.ramps.takes_paste();
        for text in ui.input(pasted).into_iter().filter(|_| !is_for_stops) {
            self.session.paste(&text);
        }
        // Escape closes the topmost item first.
        if ui.input(|input| input.key_pressed(egui::Key::Escape))
            && (self.exporting.dismiss() || self.session.hints.dismiss())
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
            Action::Presets => {
                self.has_browser = true;
                let folder = session.document.path().parent().unwrap_or(Path::new(""));
                self.thumbnails.list(folder, session.assets.as_deref());
            }
            Action::Open => self.filing.ask_open(session),
            Action::Save => self.filing.save(session),
            Action::SaveAs => self.filing.save_as(session),
            Action::Copy => {
                context.copy_text(session.document.to_text());
                session.messages.say("file", "copied: the preset as text");
            }
            Action::Screenshot => self.exporting.begin(ExportKind::Image, session),
            Action::Seeds => self.exporting.begin(ExportKind::Seeds, session),
            Action::Export => self.exporting.is_open = !self.exporting.is_open,
            Action::Paste => context.send_viewport_cmd(egui::ViewportCommand::RequestPaste),
            Action::Undo => session.undo(),
            Action::Redo => session.redo(),
            Action::Find => session.search.open(),
            Action::Play => session.playback.is_playing = !session.playback.is_playing,
            Action::StepBack => session.playback.step(-1.0),
            Action::StepOn => session.playback.step(1.0),
            Action::Loop => session.playback.is_looping = !session.playback.is_looping,
            Action::Strip => session.show.has_strip = !session.show.has_strip,
            Action::Inspect => session.inspect.toggle(),
            Action::Compare(against) => session.compare.toggle(against),
            Action::NextStage => session.show.stage = after(session.show.stage),
            Action::Image => session.show.stage = DebugView::Final,
            Action::Help => session.show.help = !session.show.help,
            Action::InView(action) => self.viewport.act(action, session),
        }
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

/// Theme menu. It is not egui's own button, because the fonts lack its symbols.
fn theme(ui: &mut Ui) {
    let mut preference = ui.ctx().options(|options| options.theme_preference);
    ui.menu_button("Theme", |ui| {
        use egui::ThemePreference::{Dark, Light, System};
        for (theme, name) in [(System, "As the system"), (Dark, "Dark"), (Light, "Light")] {
            if ui.radio_value(&mut preference, theme, name).clicked() {
                ui.close();
            }
        }
    });
    ui.ctx().set_theme(preference);
}

impl eframe::App for Window {
    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        let acts = ui.input(|input| input.pointer.any_pressed() || !input.keys_down.is_empty());
        if let Some(left) = self.session.messages.advance(Instant::now(), acts) {
            ui.ctx().request_repaint_after(left);
        }
        self.keys(ui);
        self.reload.advance(&mut self.session, &self.easel);
        let is_touched = ui.input(|input| input.pointer.any_down() || input.smooth_scroll_delta() != egui::Vec2::ZERO);
        let is_turning = self.session.show.lights.turn.is_some();
        self.easel.begin_frame(is_touched || is_turning || self.session.playback.is_playing);
        self.filing.advance(&mut self.session, ui.ctx());
        self.session.playback.advance(ui.input(|input| input.stable_dt));
        egui::Panel::top("top").show(ui, |ui| self.top(ui));
        panels::notice_bar::panel(ui, &mut self.session, self.keeping.as_mut());
        egui::Panel::bottom("status").show(ui, |ui| self.status(ui));
        egui::Panel::bottom("time").show(ui, |ui| panels::timeline::panel(ui, &mut self.session));
        if self.session.show.has_strip {
            let aspect = self.session.show.aspect;
            let height = self.layout.strip.unwrap_or((0.12 * ui.available_height()).max(80.0));
            let most = (0.25 * ui.available_height()).clamp(56.0, 320.0);
            let panel = egui::Panel::bottom("strip").resizable(true).default_size(height).size_range(56.0..=most);
            let shown = panel.show(ui, |ui| strip(ui, &mut self.session, &self.easel, aspect));
            self.layout.strip = Some(shown.response.rect.height());
        }
        let width = self.layout.settings.unwrap_or((0.18 * ui.available_width()).clamp(370.0, 440.0));
        // The image stays the largest part, even in a small window.
        let most = (0.45 * ui.available_width()).clamp(240.0, 560.0);
        let settings = egui::Panel::right("settings").default_size(width).size_range(240.0..=most);
        let shown = settings.show(ui, |ui| panels::settings_panel::panel(ui, &mut self.session));
        self.layout.settings = Some(shown.response.rect.width());
        self.session.hints.see(Place::Settings, shown.response.rect);
        let has_no_place =
            [&mut self.session.ramps.wants_place, &mut self.session.sprites.wants_place].map(std::mem::take);
        if has_no_place.contains(&true) {
            self.filing.save_as(&self.session);
        }
        if let Some(path) = shown.inner {
            let is_seed = path.ends_with(".emitter.seed");
            let product = if is_seed { ExportKind::Seeds } else { ExportKind::Values(path) };
            self.exporting.begin(product, &mut self.session);
        }
        egui::CentralPanel::no_frame().show(ui, |ui| {
            let rect = ui.max_rect();
            self.session.hints.see(Place::Image, rect);
            self.viewport.show(ui, &mut self.session, &self.easel);
            inspector::panel(ui, rect, &self.session);
        });
        if let Some(lens) = &mut self.lens {
            lens.update(ui, &mut self.session, &self.easel);
        }
        panels::hint_popup::panel(ui, &mut self.session, is_touched, self.viewport.is_dragging());
        panels::search_box::panel(ui, &mut self.session);
        panels::key_list::panel(ui, &mut self.session);
        panels::export_dialog::panel(ui, &mut self.exporting, &mut self.session);
        panels::file_menu::questions(ui, &mut self.filing, &mut self.session);
        if self.has_browser
            && let Some(chosen) = panels::preset_browser::panel(ui, &mut self.thumbnails)
        {
            self.has_browser = false;
            self.thumbnails.stop();
            chosen.into_iter().for_each(|path| self.filing.open(path, &self.session));
        }
        let is_held = ui.input(|input| input.pointer.any_down()) || ui.ctx().text_edit_focused();
        self.session.track(is_held || self.viewport.is_held(ui));
        if let Some(keeping) = &mut self.keeping {
            keeping.advance(&mut self.session, ui.ctx());
        }
        self.layout.see(ui.ctx(), &self.session);
        self.keeping.iter_mut().for_each(|keeping| keeping.remember(&self.layout, &self.filing, ui.ctx()));
        let Session { performance, show, document, compare, .. } = &mut self.session;
        let is_seen = show.tab == Tab::Performance || compare.against.is_some();
        if performance.follow(&self.easel, is_seen, frame.info().cpu_usage, &document.preset) {
            ui.ctx().request_repaint();
        }
        match self.easel.error() {
            Some(error) => self.session.messages.complain("picture", error),
            None => self.session.messages.withdraw("picture"),
        }
        if let Some(error) = self.easel.health().take_error() {
            self.session.messages.complain("device", error);
        }
        if self.session.playback.is_playing {
            ui.ctx().request_repaint();
        }
        self.screenshot.advance(ui, &mut self.session);
    }

    fn on_exit(&mut self) {
        self.filing.finish();
        if let Some(keeping) = self.keeping.take() {
            keeping.finish(&self.layout);
        }
    }
}

#[cfg(test)]
mod tests;
