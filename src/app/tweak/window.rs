//! The window: what is where, and the order in which a frame happens.

use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use eframe::egui::{self, Ui};
use eframe::wgpu;
use haze::Error;
use haze::picture::{Effort, write_png};
use image::RgbImage;

use super::gpu::Easel;
use super::panel;
use super::session::Session;
use super::strip::strip;
use super::viewport::viewport;

pub struct Window {
    session: Session,
    easel: Easel,
    adapter: String,
    screenshot: Screenshot,
}

/// A picture of the window on its way.
#[derive(Default)]
struct Screenshot {
    /// Frames that have been shown.
    frames: u32,
    taken: Arc<Mutex<Option<Arc<egui::ColorImage>>>>,
}

/// Frames after which a window stands still.
const SETTLED: u32 = 6;

impl Window {
    pub fn new(context: &eframe::CreationContext<'_>, session: Session) -> Result<Self, Error> {
        let none = || Error::NoDevice("the window has no graphics device".into());
        let render = context.wgpu_render_state.as_ref().ok_or_else(none)?;
        let info = render.adapter.get_info();
        let software = if info.device_type == wgpu::DeviceType::Cpu { ", software" } else { "" };
        Ok(Self {
            session,
            easel: Easel::new(render)?,
            adapter: format!("{} ({}{software})", info.name, info.backend),
            screenshot: Screenshot::default(),
        })
    }

    fn top(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            ui.strong(&self.session.preset.name);
            if self.session.preset != self.session.saved {
                ui.label("•").on_hover_text("Changed since it was saved");
            }
            ui.separator();
            let undo = self.session.history.undo_name().map(str::to_owned);
            let redo = self.session.history.redo_name().map(str::to_owned);
            if ui.add_enabled(undo.is_some(), egui::Button::new("Undo")).clicked() {
                self.session.undo();
            }
            if ui.add_enabled(redo.is_some(), egui::Button::new("Redo")).clicked() {
                self.session.redo();
            }
        });
    }

    fn time(&mut self, ui: &mut Ui) {
        let playback = &mut self.session.playback;
        ui.horizontal(|ui| {
            if ui.button(if playback.is_playing { "Pause" } else { "Play" }).clicked() {
                playback.is_playing = !playback.is_playing;
            }
            if ui.button("⏴").clicked() {
                playback.step(-1.0);
            }
            if ui.button("⏵").clicked() {
                playback.step(1.0);
            }
            ui.spacing_mut().slider_width = (ui.available_width() - 90.0).max(60.0);
            ui.add(
                egui::Slider::new(&mut playback.time, playback.range.clone())
                    .clamping(egui::SliderClamping::Never)
                    .suffix(" s"),
            );
        });
    }

    fn status(&self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            if let Some(message) = self.session.messages.latest() {
                let text = egui::RichText::new(&message.text);
                ui.label(if message.is_error { text.color(ui.visuals().error_fg_color) } else { text });
            }
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| ui.weak(&self.adapter));
        });
    }

    fn keys(&mut self, ui: &Ui) {
        let pressed = |modifiers, key| ui.input_mut(|input| input.consume_key(modifiers, key));
        let (command, shift) = (egui::Modifiers::COMMAND, egui::Modifiers::SHIFT);
        if pressed(command | shift, egui::Key::Z) || pressed(command, egui::Key::Y) {
            self.session.redo();
        }
        if pressed(command, egui::Key::Z) {
            self.session.undo();
        }
    }

    /// Takes the picture that was asked for, and closes the window.
    fn take_screenshot(&mut self, ui: &Ui) {
        let Some(path) = self.session.screenshot.clone() else { return };
        self.screenshot.frames += 1;
        let taken = self.screenshot.taken.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(picture) = taken {
            if let Err(error) = write(&path, &picture) {
                self.session.messages.complain("screenshot", error);
            }
            ui.ctx().send_viewport_cmd(egui::ViewportCommand::Close);
        } else if self.screenshot.frames == SETTLED {
            let (taken, context) = (self.screenshot.taken.clone(), ui.ctx().clone());
            ui.ctx().request_screenshot(move |picture| {
                *taken.lock().unwrap_or_else(PoisonError::into_inner) = Some(picture);
                context.request_repaint();
            });
        }
        ui.ctx().request_repaint();
    }
}

fn write(path: &Path, picture: &egui::ColorImage) -> Result<(), Error> {
    let [width, height] = picture.size.map(|side| side as u32);
    let bytes = picture.pixels.iter().flat_map(|pixel| [pixel.r(), pixel.g(), pixel.b()]).collect();
    let picture = RgbImage::from_raw(width, height, bytes).unwrap_or_default();
    write_png(path, &picture.into(), Effort::Quick)
}

impl eframe::App for Window {
    fn ui(&mut self, ui: &mut Ui, _: &mut eframe::Frame) {
        self.keys(ui);
        self.session.playback.advance(ui.input(|input| input.stable_dt));
        egui::Panel::top("top").show(ui, |ui| self.top(ui));
        egui::Panel::bottom("status").show(ui, |ui| self.status(ui));
        egui::Panel::bottom("time").show(ui, |ui| self.time(ui));
        egui::Panel::right("settings").default_size(330.0).show(ui, |ui| panel::settings::panel(ui, &mut self.session));
        if self.session.show.has_strip {
            let panel = egui::Panel::bottom("strip").resizable(true).default_size(100.0).size_range(60.0..=240.0);
            panel.show(ui, |ui| strip(ui, &mut self.session, &self.easel));
        }
        egui::CentralPanel::no_frame().show(ui, |ui| viewport(ui, &mut self.session, &self.easel));
        self.session.track(ui.input(|input| input.pointer.any_down()));
        match self.easel.take_error() {
            Some(error) => self.session.messages.complain("picture", error),
            None => self.session.messages.withdraw("picture"),
        }
        if self.session.playback.is_playing {
            ui.ctx().request_repaint();
        }
        self.take_screenshot(ui);
    }
}
