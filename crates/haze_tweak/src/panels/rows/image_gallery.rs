//! Field that names an image, chosen by thumbnail.

use eframe::egui::{self, Rect, Response, Sense, Stroke, Ui, Vec2};
use haze_core::assets::ramp::RampRole;
use haze_core::settings::ImageRole;

use crate::session::image_thumbnails::{ImageThumbnails, SIZE};

/// Size of a thumbnail and height of its name, points.
const THUMBNAIL: Vec2 = Vec2::new(SIZE[0] as f32, SIZE[1] as f32);
const NAME: f32 = 16.0;
/// Thumbnails in a row.
const COLUMNS: f32 = 3.0;

/// Draws a field that names an image. Its menu shows thumbnails: first the ramps for the role of the field, then the
/// others. `path` is that of the field.
pub fn gallery(ui: &mut Ui, thumbnails: &ImageThumbnails, role: ImageRole, value: &mut String, path: &str) -> Response {
    let shown = if value.is_empty() { "None" } else { value.as_str() };
    let combo = egui::ComboBox::from_id_salt(path)
        .selected_text(shown)
        .width(ui.available_width() - 8.0)
        .height(4.5 * (THUMBNAIL.y + NAME + 8.0));
    combo
        .show_ui(ui, |ui| {
            let gap = ui.spacing().item_spacing.x;
            ui.set_width(COLUMNS * (THUMBNAIL.x + 8.0) + (COLUMNS + 1.0) * gap);
            let mut cells = |ui: &mut Ui, names: Vec<String>| {
                ui.horizontal_wrapped(|ui| {
                    for name in names {
                        if cell(ui, thumbnails, role, &name, *value == name).clicked() {
                            *value = name;
                            ui.close();
                        }
                    }
                });
            };
            let wanted = path.rsplit('.').next().and_then(RampRole::from_field);
            // A file whose name tells no role fits every field.
            let fits =
                |name: &String| RampRole::from_name(name).is_none_or(|role| wanted.is_none_or(|wanted| role == wanted));
            let (fitting, others): (Vec<_>, Vec<_>) = thumbnails.names(ui.ctx(), role).into_iter().partition(fits);
            cells(ui, fitting);
            if !others.is_empty() {
                ui.separator();
                ui.weak("Others");
                cells(ui, others);
            }
            if matches!(role, ImageRole::Detail | ImageRole::SixWay) && ui.button("None").clicked() {
                value.clear();
            }
        })
        .response
}

/// Draws a thumbnail with its name.
fn cell(ui: &mut Ui, thumbnails: &ImageThumbnails, role: ImageRole, name: &str, is_chosen: bool) -> Response {
    let (rect, response) = ui.allocate_exact_size(THUMBNAIL + Vec2::new(8.0, NAME + 4.0), Sense::click());
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, is_chosen, name));
    let visuals = ui.style().interact_selectable(&response, is_chosen);
    if is_chosen || response.hovered() || response.has_focus() {
        ui.painter().rect_filled(rect, 3.0, visuals.bg_fill);
    }
    let image = Rect::from_min_size(rect.min + Vec2::splat(4.0), THUMBNAIL);
    let text = Rect::from_min_max(image.left_bottom(), rect.max);
    match thumbnails.texture(ui.ctx(), role, name) {
        Some(texture) => {
            let whole = Rect::from_min_max(egui::Pos2::ZERO, egui::pos2(1.0, 1.0));
            ui.painter().image(texture, image, whole, egui::Color32::WHITE);
        }
        None => {
            let stroke = Stroke::new(1.0, ui.visuals().weak_text_color());
            ui.painter().rect_stroke(image, 2.0, stroke, egui::StrokeKind::Inside);
        }
    }
    let label = egui::WidgetText::from(name);
    let label = label.into_galley(ui, Some(egui::TextWrapMode::Truncate), text.width() - 2.0, egui::TextStyle::Small);
    ui.painter().galley(text.min, label, visuals.text_color());
    response.on_hover_text(name)
}

#[cfg(test)]
mod tests {
    use eframe::egui::{Key, Rect, Role, Theme, Vec2};
    use egui_kittest::Harness;
    use egui_kittest::kittest::{NodeT as _, Queryable as _};
    use image::imageops;

    use crate::window::Window;
    use crate::window::testing::{screenshot, window};

    /// Opens a window that shows the images of its smoke, in a temporary folder.
    fn opened(folder: &std::path::Path) -> Harness<'static, Window> {
        let preset = haze_preset::Preset::load("column").unwrap();
        let path = folder.join("own.json");
        std::fs::write(&path, serde_json::to_string(&preset).unwrap()).unwrap();
        image::RgbaImage::from_pixel(8, 1, image::Rgba([250, 20, 20, 255])).save(folder.join("red.png")).unwrap();
        std::fs::write(folder.join("broken.png"), "no image").unwrap();
        let mut harness = window(path.to_str().unwrap(), Vec2::new(1000.0, 900.0), Theme::Dark);
        harness.get_by_label("Smoke").click();
        harness.run_steps(3);
        for fold in ["Emitter", "Sprite and ramps", "Ramps and noise"] {
            harness.get_by_label(fold).click();
            harness.run_steps(30);
        }
        harness
    }

    fn open(harness: &mut Harness<'_, Window>) {
        let nodes = harness.get_all_by_label("Diffuse ramp");
        nodes.into_iter().find(|node| node.accesskit_node().role() == Role::ComboBox).unwrap().click();
        harness.run_steps(3);
    }

    #[test]
    fn an_image_is_chosen_by_its_thumbnail() {
        let folder = tempfile::tempdir().unwrap();
        let mut harness = opened(folder.path());
        open(&mut harness);
        let before = screenshot(&mut harness);
        let cell = harness.get_by_label("red.png").rect();
        // A broken file has a name and no thumbnail; decoded images appear.
        for _ in 0..100 {
            harness.step();
            std::thread::sleep(std::time::Duration::from_millis(10));
        }
        let after = screenshot(&mut harness);
        let middle = |image: &image::RgbaImage| image.get_pixel(cell.center().x as u32, cell.top() as u32 + 20).0;
        let [r, g, b, _] = middle(&after);
        assert!(r > 200 && g < 60 && b < 60, "{r} {g} {b}");
        assert!(harness.query_by_label("broken.png").is_some() && harness.query_by_label("diffuse_ember").is_some());
        harness.get_by_label("red.png").click();
        harness.run_steps(3);
        assert!(harness.query_by_label("broken.png").is_none(), "it closes");
        // Waits for the background load.
        for _ in 0..30 {
            harness.step();
            std::thread::sleep(std::time::Duration::from_millis(20));
        }
        let chosen = screenshot(&mut harness);
        let redness = |image: &image::RgbaImage| {
            let part = imageops::crop_imm(image, 50, 100, 500, 400).to_image();
            part.pixels().map(|pixel| f64::from(pixel.0[0]) - f64::from(pixel.0[1])).sum::<f64>() / 200_000.0
        };
        assert!(redness(&chosen) > redness(&before) + 1.0, "{} {}", redness(&before), redness(&chosen));
    }

    #[test]
    fn ramps_for_the_role_of_the_field_come_first_and_others_below_a_separator() {
        let folder = tempfile::tempdir().unwrap();
        let mut harness = opened(folder.path());
        open(&mut harness);
        let rect = |name: &str| -> Rect { harness.get_by_label(name).rect() };
        let line = rect("Others").center().y;
        for name in ["diffuse_ink", "red.png"] {
            assert!(rect(name).bottom() < line, "{name}");
        }
        for name in ["scatter_mist", "specular_halo", "coverage_cut", "age_smoke"] {
            assert!(rect(name).top() > line, "{name}");
        }
    }

    #[test]
    fn a_ramp_can_also_be_chosen_on_the_ramps_tab() {
        let mut harness = window("column", Vec2::new(1000.0, 1400.0), Theme::Dark);
        harness.get_by_label("Ramps").click();
        harness.run_steps(3);
        let nodes = harness.get_all_by_label("Coverage, by amount × boost");
        nodes.into_iter().find(|node| node.accesskit_node().role() == Role::ComboBox).unwrap().click();
        harness.run_steps(3);
        harness.get_by_label("coverage_wispy").click();
        harness.run_steps(3);
        let session = &harness.state().session;
        assert_eq!(session.document.preset.systems[0].material.coverage_ramp, "coverage_wispy");
        assert_eq!(session.document.history().undo_name(), Some("Coverage ramp of smoke"));
    }

    #[test]
    fn images_can_be_chosen_by_keyboard() {
        let folder = tempfile::tempdir().unwrap();
        let mut harness = opened(folder.path());
        open(&mut harness);
        harness.get_by_label("diffuse_ember").focus();
        harness.run_steps(2);
        harness.key_press(Key::Enter);
        harness.run_steps(3);
        let nodes = harness.get_all_by_label("Diffuse ramp");
        let combo = nodes.into_iter().find(|node| node.accesskit_node().role() == Role::ComboBox).unwrap();
        assert_eq!(combo.accesskit_node().value().as_deref(), Some("diffuse_ember"));
    }
}
