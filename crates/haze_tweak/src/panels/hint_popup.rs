//! Current hint, next to the part of the window that it points at.

use eframe::egui::{self, Align2, Pos2, Rect, Ui, Vec2, vec2};

use crate::session::Session;
use crate::session::action::{Action, keys_of};
use crate::session::first_run_hints::{HINTS, Hint, UserActivity, WindowPart};
use crate::session::view_options::Tab;

/// Width of the text, points.
const WIDTH: f32 = 190.0;
/// Distance to the part that it points at, and size of the arrow, points.
const AWAY: f32 = 10.0;

/// Draws the hint, away from the middle of the image. `is_pressing`: a pointer button or the wheel is in use.
/// `is_dragging_light`: a light is being dragged.
pub fn panel(ui: &Ui, session: &mut Session, is_pressing: bool, is_dragging_light: bool) {
    let is_playing = session.playback.is_playing;
    let is_look_visible = session.view.tab == Tab::Look;
    let is_ramp_visible = session.view.tab == Tab::Ramps;
    let is_searching = session.search.is_open;
    let is_key_list_open = session.view.help;
    session.hints.follow(
        &session.document.preset,
        &UserActivity {
            is_pressing,
            is_dragging_light,
            is_playing,
            is_look_visible,
            is_ramp_visible,
            is_searching,
            is_key_list_open,
        },
    );
    let Some((hint, at)) = session.hints.shown().filter(|(_, at)| at.is_positive()) else { return };
    let Some((_, _, text)) = HINTS.into_iter().find(|(of, ..)| *of == hint) else { return };
    let (corner, pivot, way) = match hint.window_part() {
        WindowPart::Image => (at.left_bottom() + vec2(AWAY, -AWAY), Align2::LEFT_BOTTOM, Vec2::UP),
        WindowPart::Play => (at.left_top() + vec2(0.0, -AWAY), Align2::LEFT_BOTTOM, Vec2::DOWN),
        WindowPart::Settings => (at.left_top() + vec2(-AWAY, 64.0), Align2::RIGHT_TOP, Vec2::RIGHT),
        WindowPart::RampsTab | WindowPart::AddSystem | WindowPart::Find | WindowPart::Keys => {
            (at.right_bottom() + vec2(0.0, AWAY), Align2::RIGHT_TOP, Vec2::UP)
        }
    };
    let area = egui::Area::new(egui::Id::unique("hint")).fixed_pos(corner).pivot(pivot);
    let mut answer = None;
    let shown = area.constrain_to(ui.ctx().content_rect()).show(ui.ctx(), |ui| {
        let frame = egui::Frame::popup(ui.style()).stroke(ui.visuals().selection.stroke);
        frame.show(ui, |ui| {
            ui.set_width(WIDTH);
            ui.label(with_key(ui, hint, text));
            ui.horizontal(|ui| {
                if ui.button("Got it").on_hover_text("Or press Escape").clicked() {
                    answer = Some(true);
                }
                let all = ui.button("Skip hints").on_hover_text("The list of keys shows them again");
                if all.clicked() {
                    answer = Some(false);
                }
            });
        });
    });
    arrow(ui, shown.response.layer_id, tip(shown.response.rect, at, way), way);
    match answer {
        Some(true) => _ = session.hints.dismiss(),
        Some(false) => session.hints.dismiss_all(),
        None => {}
    }
}

/// Returns the text of a hint, with the key for its action.
fn with_key(ui: &Ui, hint: Hint, text: &str) -> String {
    let action = match hint {
        Hint::Play => Action::Play,
        Hint::Find => Action::Find,
        Hint::Keys => Action::Help,
        _ => return text.into(),
    };
    let keys = keys_of(action).map(|keys| ui.ctx().format_shortcut(&keys));
    let sign = if hint == Hint::Keys { "? or " } else { "" };
    format!("{sign}{} {text}", keys.unwrap_or_default())
}

/// Returns the tip of the arrow: outside the hint, towards its target.
fn tip(card: Rect, at: Rect, way: Vec2) -> Pos2 {
    if way == Vec2::RIGHT {
        return egui::pos2(card.right() + AWAY - 1.0, card.center().y);
    }
    let x = at.center().x.clamp(card.left() + 2.0 * AWAY, card.right() - 2.0 * AWAY);
    let y = if way == Vec2::DOWN { card.bottom() + AWAY - 1.0 } else { card.top() - AWAY + 1.0 };
    egui::pos2(x, y)
}

fn arrow(ui: &Ui, layer: egui::LayerId, tip: Pos2, way: Vec2) {
    let back = way * (AWAY - 1.0);
    let side = way.rot90() * 6.0;
    let color = ui.visuals().selection.stroke.color;
    let points = vec![tip, tip - back + side, tip - back - side];
    ui.ctx().layer_painter(layer).add(egui::Shape::convex_polygon(points, color, egui::Stroke::NONE));
}

#[cfg(test)]
mod tests {
    use eframe::egui::{Key, Modifiers, Theme};
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable as _;

    use super::*;
    use crate::files::persistence::{Layout, Persistence};
    use crate::window::testing;
    use crate::window::{Start, Window};

    /// Opens a window that persists its state in a folder.
    fn start(folder: &std::path::Path, size: Vec2, theme: Theme) -> Harness<'static, Window> {
        let mut session = Session::open("column".as_ref(), None).unwrap();
        let persistence = Some(Persistence::new(folder.into(), &mut session));
        let (layout, _) = Layout::read(folder);
        let start = Start { persistence, layout, ..testing::start_of(session) };
        testing::open(start, size, theme)
    }

    fn shown(harness: &Harness<'_, Window>) -> Option<Hint> {
        let told = harness.query_by_label("Got it").is_some();
        let shown = harness.state().session.hints.shown().map(|(hint, _)| hint);
        assert_eq!(told, shown.is_some());
        shown
    }

    #[test]
    fn each_hint_ends_when_its_action_is_done() {
        let folder = tempfile::tempdir().unwrap();
        let mut harness = start(folder.path(), vec2(1000.0, 640.0), Theme::Dark);
        assert_eq!(shown(&harness), Some(Hint::Play));
        harness.key_press(Key::Space);
        harness.run_steps(2);
        assert_eq!(shown(&harness), Some(Hint::Orbit));
        harness.key_press(Key::Space);
        // Later hints end too if their actions are done.
        harness.key_press_modifiers(Modifiers::COMMAND, Key::P);
        harness.run_steps(2);
        harness.key_press(Key::Escape);
        harness.run_steps(2);
        assert_eq!(harness.state().session.hints.left(), ["orbit", "light", "lamp", "look", "ramp", "system", "keys"]);
        let from = harness.get_by_label("viewport").rect().center();
        harness.drag_at(from);
        harness.step();
        harness.hover_at(from + vec2(60.0, 0.0));
        harness.run_steps(2);
        harness.drop_at(from + vec2(60.0, 0.0));
        harness.run_steps(2);
        assert_eq!(shown(&harness), Some(Hint::Light));
        // By keyboard alone.
        harness.key_press(Key::Escape);
        harness.run_steps(3);
        assert_eq!(shown(&harness), Some(Hint::Lamp));
        testing::click_at(&mut harness, from, egui::PointerButton::Secondary);
        harness.get_by_label("Add Point Light Here").click();
        harness.run_steps(3);
        assert_eq!(shown(&harness), Some(Hint::Look));
        harness.state_mut().session.document.preset.systems[0].emitter.radius_end *= 1.5;
        harness.run_steps(3);
        assert_eq!(shown(&harness), Some(Hint::Ramp));
        harness.get_by_label("Ramps").click();
        harness.run_steps(3);
        assert_eq!(shown(&harness), Some(Hint::System));
        harness.get_by_label("Add system").click();
        harness.run_steps(3);
        harness.get_by_label("Sparks").click();
        harness.run_steps(3);
        assert_eq!(shown(&harness), Some(Hint::Keys));
        harness.key_press(Key::Questionmark);
        harness.run_steps(3);
        assert_eq!(shown(&harness), None);
        harness.get_by_label("Show hints again").click();
        harness.run_steps(3);
        assert_eq!(shown(&harness), Some(Hint::Play));
        harness.get_by_label("Skip hints").click();
        harness.run_steps(3);
        assert_eq!(shown(&harness), None);
    }

    #[test]
    fn remaining_hints_are_persisted_and_a_window_without_a_state_folder_has_none() {
        let folder = tempfile::tempdir().unwrap();
        let mut harness = start(folder.path(), vec2(1000.0, 640.0), Theme::Light);
        harness.get_by_label("Got it").click();
        harness.run_steps(3);
        let window = harness.state_mut();
        window.persistence.take().unwrap().finish(&window.layout().clone());
        drop(harness);
        let mut harness = start(folder.path(), vec2(1000.0, 640.0), Theme::Light);
        assert_eq!(shown(&harness), Some(Hint::Orbit));
        harness.get_by_label("Skip hints").click();
        harness.run_steps(3);
        let window = harness.state_mut();
        window.persistence.take().unwrap().finish(&window.layout().clone());
        drop(harness);
        assert_eq!(shown(&start(folder.path(), vec2(1000.0, 640.0), Theme::Light)), None);
        assert_eq!(shown(&testing::window("column", vec2(1000.0, 640.0), Theme::Light)), None);
    }

    /// Also writes images to the folder that `HAZE_LOOK` names.
    #[test]
    fn no_hint_covers_the_middle_of_the_image_or_leaves_the_window() {
        let look = std::env::var_os("HAZE_LOOK").map(std::path::PathBuf::from);
        for (size, theme) in [(vec2(1280.0, 800.0), Theme::Dark), (vec2(800.0, 600.0), Theme::Light)] {
            let folder = tempfile::tempdir().unwrap();
            let mut harness = start(folder.path(), size, theme);
            for (hint, name, _) in HINTS {
                assert_eq!(shown(&harness), Some(hint));
                if let Some(folder) = &look {
                    let image = testing::screenshot(&mut harness);
                    image.save(folder.join(format!("hint_{name}_{}.png", size.x))).unwrap();
                }
                let view = harness.get_by_label("viewport").rect();
                let middle = Rect::from_center_size(view.center(), view.size() / 4.0);
                let card = egui::AreaState::load(&harness.ctx, egui::Id::unique("hint")).unwrap().rect();
                assert!(!card.intersects(middle), "{name}: {card} covers {middle}");
                assert!(Rect::from_min_size(Pos2::ZERO, size).contains_rect(card), "{name}: {card}");
                harness.key_press(Key::Escape);
                harness.run_steps(3);
            }
        }
    }
}
