//! Plot of the soft fade over the distance to a surface.

use eframe::egui::{self, Align2, Sense, Ui, Vec2, pos2};
use haze_core::formula::soft_fade::soft_fade;
use haze_core::settings::SoftFade;

const HEIGHT: f32 = 84.0;
/// Height of the labels below the plot, points.
const TEXT_SIZE: f32 = 16.0;
const POINTS: usize = 160;

/// Draws the plot, from behind the surface to where the sprite is fully visible.
pub fn panel(ui: &mut Ui, fade: &SoftFade) {
    let (rect, response) = ui.allocate_exact_size(Vec2::new(ui.available_width(), HEIGHT), Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Fade curve"));
    let plot = rect.with_max_y(rect.bottom() - TEXT_SIZE).shrink(2.0);
    let reach = fade.max_distance();
    let from = -0.6 * reach;
    let to = 1.4 * reach;
    let x = |distance: f32| plot.left() + (distance - from) / (to - from) * plot.width();
    let value = |distance| soft_fade(fade.curve, distance, fade.fade_scale, fade.contrast_power, fade.epsilon);
    let visuals = ui.visuals();
    let faint = visuals.weak_text_color();
    let ink = visuals.text_color();
    let painter = ui.painter_at(rect);
    painter.rect_filled(plot, 2.0, visuals.extreme_bg_color);
    // The region behind the surface.
    painter.rect_filled(plot.with_max_x(x(0.0)), 0.0, visuals.faint_bg_color);
    painter.vline(x(0.0), plot.y_range(), egui::Stroke::new(1.0, faint));
    painter.vline(x(reach), plot.y_range(), egui::Stroke::new(1.0, faint.gamma_multiply(0.5)));
    let points = (0..=POINTS).map(|step| {
        let distance = from + (to - from) * step as f32 / POINTS as f32;
        pos2(x(distance), plot.bottom() - 1.0 - value(distance).clamp(0.0, 1.0) * (plot.height() - 2.0))
    });
    painter.add(egui::Shape::line(points.collect(), egui::Stroke::new(1.5, ink)));
    let font = egui::TextStyle::Small.resolve(ui.style());
    let word = |at: f32, align: Align2, text: String| {
        painter.text(pos2(at, rect.bottom()), align, text, font.clone(), faint);
    };
    word(x(0.0), Align2::CENTER_BOTTOM, "Surface".into());
    word(x(reach), Align2::CENTER_BOTTOM, format!("{reach:.2} m"));
    response.on_hover_text("Opacity of a sprite over its distance in front of a surface");
}
