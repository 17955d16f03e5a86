//! List of presets to start from.

use std::path::{Path, PathBuf};

use eframe::egui::{self, Sense, Ui, Vec2};

use crate::files::preset_thumbnails::{PresetEntry, PresetThumbnails, SIZE};

/// Margin around an image, points.
const MARGIN: f32 = 4.0;
/// Height of a name, points.
const NAME: f32 = 20.0;
/// Size of an image with its name.
const CELL: Vec2 = Vec2::new(SIZE.x as f32 + 2.0 * MARGIN, SIZE.y as f32 + NAME + MARGIN);

/// Draws the list over the window. Returns `Some(Some(path))` if a preset was chosen, and `Some(None)` if the list is
/// to be closed.
pub fn panel(ui: &Ui, thumbnails: &mut PresetThumbnails) -> Option<Option<PathBuf>> {
    thumbnails.advance(ui.ctx());
    let mut chosen = None;
    let room = ui.ctx().content_rect().size() - Vec2::new(80.0, 140.0);
    let response = egui::Modal::new(egui::Id::unique("presets")).show(ui.ctx(), |ui| {
        ui.set_width(room.x.min(3.0 * (CELL.x + 12.0)));
        ui.heading("New from Preset");
        ui.add_space(6.0);
        egui::ScrollArea::vertical().max_height(room.y).show(ui, |ui| {
            let columns = (ui.available_width() / (CELL.x + ui.spacing().item_spacing.x)).max(1.0) as usize;
            for row in thumbnails.entries.chunks(columns) {
                ui.horizontal(|ui| {
                    for entry in row.iter().filter(|entry| cell(ui, entry)) {
                        chosen = Some(entry.path.clone());
                    }
                });
            }
        });
    });
    (chosen.is_some() || response.should_close()).then_some(chosen)
}

/// Draws an image with its name. Returns true if it was chosen.
fn cell(ui: &mut Ui, entry: &PresetEntry) -> bool {
    let (rect, response) = ui.allocate_exact_size(CELL, Sense::click());
    // A file is known by its name: a preset that was saved as another keeps the name inside.
    let shown = entry.shown.as_ref().filter(|_| entry.path.extension().is_none());
    let name = shown.map_or_else(|| file_name(&entry.path), |shown| shown.name.clone());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, name.clone()));
    let visuals = ui.style().interact(&response);
    let image_rect =
        egui::Rect::from_min_size(rect.min + Vec2::splat(MARGIN), CELL - Vec2::new(2.0 * MARGIN, NAME + MARGIN));
    ui.painter().rect(rect, visuals.corner_radius, visuals.weak_bg_fill, visuals.bg_stroke, egui::StrokeKind::Inside);
    match &entry.shown {
        Some(shown) => egui::Image::new(&shown.image).paint_at(ui, image_rect),
        None => _ = ui.painter().rect_filled(image_rect, 0.0, ui.visuals().extreme_bg_color),
    }
    let text = egui::WidgetText::from(name);
    let text = text.into_galley(ui, Some(egui::TextWrapMode::Truncate), image_rect.width(), egui::TextStyle::Body);
    ui.painter().galley(image_rect.left_bottom(), text, visuals.text_color());
    let description = entry.shown.as_ref().map_or("", |shown| shown.description.as_str());
    let tooltip = format!("{description}\n{}", entry.path.display());
    response.on_hover_text(tooltip.trim()).clicked()
}

fn file_name(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}
