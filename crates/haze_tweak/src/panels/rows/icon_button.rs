//! Buttons with drawn icons, because the fonts of the window lack these symbols.

use eframe::egui::{self, Color32, Id, Pos2, Rect, Response, Sense, Shape, Ui, Vec2, pos2};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Icon {
    Play,
    Pause,
    Back,
    Forward,
    Loop,
    Sheet,
}

/// Adds an icon button. `name` is its tooltip and its accessible name.
pub fn button(ui: &mut Ui, icon: Icon, is_on: bool, name: &str) -> Response {
    let side = ui.spacing().interact_size.y;
    let (_, response) = ui.allocate_exact_size(Vec2::splat(side), Sense::click());
    shown(ui, response, icon, is_on, name)
}

/// Adds an icon button in `rect`, over existing content.
pub fn button_over(ui: &Ui, rect: Rect, id: Id, icon: Icon, name: &str) -> Response {
    shown(ui, ui.interact(rect, id, Sense::click()), icon, false, name)
}

fn shown(ui: &Ui, response: Response, icon: Icon, is_on: bool, name: &str) -> Response {
    let rect = response.rect;
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, is_on, name));
    let visuals = ui.style().interact_selectable(&response, is_on);
    ui.painter().rect_filled(rect, visuals.corner_radius, visuals.weak_bg_fill);
    draw(ui, icon, rect, visuals.text_color());
    response.on_hover_text(name)
}

fn draw(ui: &Ui, icon: Icon, rect: Rect, color: Color32) {
    let at = |x: f32, y: f32| -> Pos2 { pos2(rect.left() + x * rect.width(), rect.top() + y * rect.height()) };
    let solid = |points: Vec<Pos2>| Shape::convex_polygon(points, color, egui::Stroke::NONE);
    let bar = |left: f32| solid(vec![at(left, 0.25), at(left + 0.15, 0.25), at(left + 0.15, 0.75), at(left, 0.75)]);
    let right = |left: f32| solid(vec![at(left, 0.25), at(left + 0.4, 0.5), at(left, 0.75)]);
    let left = |right: f32| solid(vec![at(right, 0.25), at(right, 0.75), at(right - 0.4, 0.5)]);
    let shapes = match icon {
        Icon::Play => vec![right(0.33)],
        Icon::Pause => vec![bar(0.28), bar(0.57)],
        Icon::Back => vec![bar(0.2), left(0.78)],
        Icon::Forward => vec![right(0.22), bar(0.65)],
        Icon::Sheet => {
            let cell = |x: f32, y: f32| Rect::from_min_max(at(x, y), at(x + 0.24, y + 0.24));
            let cells = [(0.22, 0.22), (0.54, 0.22), (0.22, 0.54), (0.54, 0.54)];
            cells.map(|(x, y)| Shape::rect_filled(cell(x, y), 0.0, color)).into()
        }
        Icon::Loop => {
            let stroke = egui::Stroke::new(1.5, color);
            let arc = (2..=22).map(|step| {
                let angle = step as f32 / 24.0 * std::f32::consts::TAU;
                at(0.5 + 0.26 * angle.cos(), 0.5 + 0.26 * angle.sin())
            });
            vec![Shape::line(arc.collect(), stroke), solid(vec![at(0.62, 0.36), at(0.92, 0.36), at(0.77, 0.54)])]
        }
    };
    ui.painter().extend(shapes);
}
