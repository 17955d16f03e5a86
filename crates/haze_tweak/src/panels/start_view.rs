//! Presets to start from, as large images, and the files that were open last.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use eframe::egui::text::LayoutJob;
use eframe::egui::{self, Color32, FontId, Galley, Rect, Sense, TextStyle, Ui, Vec2, vec2};

use crate::files::preset_thumbnails::{PresetEntry, PresetThumbnails};
use crate::files::thumbnail_cache::SIZE;
use crate::platform::idle_timer::IdleTimer;
use crate::session::action::{Action, keys_of};
use crate::session::messages::truncate_middle;

/// Choice of the user.
pub enum StartChoice {
    /// Opens a file, or a built-in preset by name.
    Open(PathBuf),
    /// Asks for a file.
    AskOpen,
    Close,
}

/// Largest width of a card, gap between cards, and margin around the words of a card, points.
const MAX_CARD: f32 = 480.0;
const GAP: f32 = 10.0;
const MARGIN: f32 = 8.0;

/// Most letters of the name of a recent file.
const MAX_LETTERS: usize = 28;

/// Draws the list over the window. Returns the choice, if one was made.
pub fn panel(ui: &Ui, thumbnails: &mut PresetThumbnails, idle: IdleTimer) -> Option<StartChoice> {
    thumbnails.advance(ui.ctx(), idle);
    let mut choice = None;
    let window = ui.ctx().content_rect().size();
    // In a small window, nearly all of it.
    let size = window - 2.0 * (0.035 * window).clamp(Vec2::splat(12.0), Vec2::splat(56.0));
    let frame = egui::Frame::window(ui.style()).inner_margin(12).shadow(egui::Shadow::NONE);
    let inside = size - frame.total_margin().sum();
    let response = egui::Modal::new(egui::Id::unique("start")).frame(frame).show(ui.ctx(), |ui| {
        ui.set_width(inside.x);
        ui.set_height(inside.y);
        choice = heading(ui, &thumbnails.recent);
        ui.add_space(4.0);
        egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            ui.spacing_mut().item_spacing = Vec2::splat(GAP);
            // Beside the scroll bar.
            ui.set_max_width(ui.available_width() - ui.spacing().scroll.bar_width);
            let entries = &thumbnails.entries;
            let (files, built_in): (Vec<_>, Vec<_>) = entries.iter().partition(|entry| is_file(entry));
            let chosen = cards(ui, &built_in).or_else(|| {
                let folder = files.first()?.path.parent()?.display().to_string();
                ui.weak(truncate_middle(&format!("In {folder}"), 80));
                cards(ui, &files)
            });
            choice = chosen.map(StartChoice::Open).or(choice.take());
        });
    });
    if choice.is_none() && response.should_close() {
        return Some(StartChoice::Close);
    }
    choice
}

fn is_file(entry: &PresetEntry) -> bool {
    entry.path.extension().is_some()
}

/// Draws the row above the cards.
fn heading(ui: &mut Ui, recent: &[PathBuf]) -> Option<StartChoice> {
    let mut choice = None;
    ui.horizontal(|ui| {
        ui.heading("Start");
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if ui.button("Close").on_hover_text("Goes on with the smoke behind this list (Escape)").clicked() {
                choice = Some(StartChoice::Close);
            }
            let keys = |action| keys_of(action).map_or_else(String::new, |keys| ui.ctx().format_shortcut(&keys));
            let open = egui::Button::new("Open…").shortcut_text(keys(Action::Open));
            let again = keys(Action::Presets);
            if ui.add(open).on_hover_text("Opens a preset from a file").clicked() {
                choice = Some(StartChoice::AskOpen);
            }
            ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                let hints = [
                    format!("Space plays and pauses the smoke. {again} opens this list again."),
                    "Space plays and pauses.".into(),
                ];
                let fits = |hint: &&String| width(ui, hint, TextStyle::Body) <= ui.available_width();
                if let Some(hint) = hints.iter().find(fits) {
                    ui.weak(hint);
                }
            });
        });
    });
    if !recent.is_empty() {
        ui.horizontal(|ui| {
            ui.weak("Recent");
            for path in recent {
                let name = truncate_middle(&file_name(path), MAX_LETTERS);
                // Those that fit: the row does not wrap.
                if width(ui, &name, TextStyle::Button) + 2.0 * ui.spacing().button_padding.x > ui.available_width() {
                    break;
                }
                if ui.button(&name).on_hover_text(path.display().to_string()).clicked() {
                    choice = Some(StartChoice::Open(path.clone()));
                }
            }
        });
    }
    choice
}

/// Draws cards in rows. Returns the path of the one that was chosen.
fn cards(ui: &mut Ui, entries: &[&PresetEntry]) -> Option<PathBuf> {
    let mut chosen = None;
    let room = ui.available_width();
    let columns = (room / MAX_CARD).ceil().max(1.0);
    let width = ((room - (columns - 1.0) * GAP) / columns).floor();
    let image = vec2(width, (width * SIZE.y as f32 / SIZE.x as f32).round());
    for row in entries.chunks(columns as usize) {
        let words = row.iter().map(|entry| words(ui, entry, width - 2.0 * MARGIN)).collect::<Vec<_>>();
        let height = words.iter().map(|words| words.size().y).fold(0.0, f32::max);
        let size = image + vec2(0.0, height + 2.0 * MARGIN);
        ui.horizontal(|ui| {
            for (entry, words) in row.iter().zip(words) {
                if card(ui, entry, words, size) {
                    chosen = Some(entry.path.clone());
                }
            }
        });
    }
    chosen
}

/// Draws an image with words below it. Returns true if it was chosen.
fn card(ui: &mut Ui, entry: &PresetEntry, words: Arc<Galley>, size: Vec2) -> bool {
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    let name = name(entry);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
    if !ui.is_rect_visible(rect) {
        return response.clicked();
    }
    let visuals = ui.style().interact(&response);
    let radius = ui.visuals().widgets.inactive.corner_radius;
    let is_lit = response.hovered() || response.has_focus();
    let fill = if is_lit { visuals.weak_bg_fill } else { ui.visuals().faint_bg_color };
    ui.painter().rect_filled(rect, radius, fill);
    let image = Rect::from_min_size(rect.min, vec2(size.x, (size.x * SIZE.y as f32 / SIZE.x as f32).round()));
    let top = egui::CornerRadius { sw: 0, se: 0, ..radius };
    match &entry.image {
        Some(shown) => egui::Image::new(shown).corner_radius(top).paint_at(ui, image),
        None => _ = ui.painter().rect_filled(image, top, ui.visuals().extreme_bg_color),
    }
    ui.painter().galley(image.left_bottom() + Vec2::splat(MARGIN), words, ui.visuals().text_color());
    if is_lit {
        let stroke = egui::Stroke::new(2.0, ui.visuals().selection.bg_fill);
        ui.painter().rect_stroke(rect, radius, stroke, egui::StrokeKind::Inside);
    }
    response.on_hover_cursor(egui::CursorIcon::PointingHand).clicked()
}

/// Returns the words of a card: its name, and its description.
fn words(ui: &Ui, entry: &PresetEntry, width: f32) -> Arc<Galley> {
    let mut job = LayoutJob::default();
    let description = entry.about.as_ref().map_or("", |about| about.description.as_str());
    let body = TextStyle::Body.resolve(ui.style());
    let small = FontId::new(0.9 * body.size, body.family.clone());
    let line_height = Some(1.5 * body.size);
    let bold = egui::TextFormat { line_height, ..egui::TextFormat::simple(body, ui.visuals().strong_text_color()) };
    job.append(&name(entry), 0.0, bold);
    job.append(&format!("\n{description}"), 0.0, egui::TextFormat::simple(small, ui.visuals().text_color()));
    job.wrap.max_width = width;
    ui.painter().layout_job(job)
}

/// Returns the width of a text, points.
fn width(ui: &Ui, text: &str, style: TextStyle) -> f32 {
    ui.painter().layout_no_wrap(text.to_owned(), style.resolve(ui.style()), Color32::WHITE).size().x
}

/// Returns the name of a preset. A file is known by its name: a preset that was saved as another keeps the name inside.
fn name(entry: &PresetEntry) -> String {
    let about = entry.about.as_ref().filter(|_| !is_file(entry));
    about.map_or_else(|| file_name(&entry.path), |about| about.name.clone())
}

fn file_name(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}
