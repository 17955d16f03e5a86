//! Swatch of a color, and the popup that edits it: a picker, hexadecimal code, temperature and brightness, an eyedropper
//! and recent colors.

use std::ops::RangeInclusive;

use eframe::egui::color_picker::{Alpha, color_picker_hsva_2d, show_color_at};
use eframe::egui::ecolor::Hsva;
use eframe::egui::{self, Popup, PopupCloseBehavior, Response, Rgba, Sense, Ui};
use egui_gradient::ColorEyedropper;
use glam::Vec3;
use haze_author::color_temperature::{KELVIN, color_of_temperature, temperature_of_color};
use haze_author::ramp::HexColor;
use haze_core::formula::color::srgb_from_linear;

/// Range of the brightness, stops.
const STOPS: RangeInclusive<f32> = -10.0..=10.0;

/// Most recent colors that are kept.
const MAX_RECENT: usize = 8;

/// Draws a swatch of a linear RGB color, whose channels have a range; a click opens the popup. The color may exceed 1; what
/// is shown is then normalised to its largest channel.
pub fn swatch(ui: &mut Ui, value: &mut Vec3, range: &RangeInclusive<f32>) -> Response {
    let size = ui.spacing().interact_size;
    let (rect, mut button) = ui.allocate_exact_size(size, Sense::click());
    button.widget_info(|| egui::WidgetInfo::new(egui::Role::ColorWell));
    if ui.is_rect_visible(rect) {
        let [r, g, b] = (*value / shown_peak(*value)).to_array();
        let visuals = ui.style().interact(&button);
        show_color_at(ui.painter(), Rgba::from_rgb(r, g, b).into(), rect);
        ui.painter().rect_stroke(rect, visuals.corner_radius, visuals.bg_stroke, egui::StrokeKind::Inside);
    }
    let before = *value;
    let popup = beside_row(ui, Popup::from_toggle_button_response(&button), rect);
    let popup = popup.close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    let opened_with = button.id.with("opened with");
    // The area keeps the text field's request to scroll from the panel, which would scroll away from under the popup.
    let content = |ui: &mut Ui| egui::ScrollArea::neither().show(ui, |ui| popup_content(ui, value, button.id));
    let is_open = popup.show(content).is_some();
    if is_open {
        ui.data_mut(|data| *data.get_temp_mut_or(opened_with, before));
    } else if ui.data_mut(|data| data.remove_temp::<Vec3>(opened_with)).is_some_and(|opened| opened != *value) {
        remember(ui, shown_code(*value));
    }
    // It outlives the popup, which would hide the image.
    if let Some(mut eyedropper) = ui.data_mut(|data| data.remove_temp::<ColorEyedropper>(button.id)) {
        match eyedropper.update(ui) {
            None => {
                ui.data_mut(|data| data.insert_temp(button.id, eyedropper));
            }
            Some(Some(picked)) => {
                *value = picked.linear() * shown_peak(*value);
                remember(ui, picked);
            }
            Some(None) => {}
        }
    }
    if *value != before {
        *value = value.clamp(Vec3::splat(*range.start()), Vec3::splat(*range.end()));
        button.mark_changed();
    }
    button
}

/// Moves a popup to the left of the panel if it fits neither below nor above its button, where it would hide the row that it
/// edits.
fn beside_row<'a>(ui: &Ui, popup: Popup<'a>, button: egui::Rect) -> Popup<'a> {
    let Some(size) = popup.get_expected_size() else { return popup };
    let window = ui.ctx().content_rect();
    let gap = ui.spacing().item_spacing.x;
    let has_room = button.bottom() + gap + size.y <= window.bottom() || button.top() - gap - size.y >= window.top();
    let left = ui.clip_rect().left() - 2.0 * gap - size.x;
    if has_room || left < window.left() {
        return popup;
    }
    let top = button.top().min(window.bottom() - size.y).max(window.top());
    popup.anchor(egui::PopupAnchor::Position(egui::pos2(left, top)))
}

/// Returns what a color is divided by to be shown: its brightest channel if that exceeds 1.
fn shown_peak(value: Vec3) -> f32 {
    value.max_element().max(1.0)
}

/// sRGB code of what is shown of a color.
fn shown_code(value: Vec3) -> HexColor {
    HexColor::from_srgb((value / shown_peak(value)).map(srgb_from_linear))
}

/// Draws the content of the popup of a button.
fn popup_content(ui: &mut Ui, value: &mut Vec3, button: egui::Id) {
    ui.spacing_mut().slider_width = 240.0;
    picker(ui, value);
    egui::Grid::new("color").num_columns(2).show(ui, |ui| {
        hex(ui, value);
        ui.end_row();
        temperature(ui, value);
        ui.end_row();
        brightness(ui, value);
        ui.end_row();
    });
    ui.horizontal(|ui| {
        let pick = ui.button("Pick color").on_hover_text("Takes a color from anywhere in the window; Escape cancels");
        if pick.clicked() {
            ui.data_mut(|data| data.insert_temp(button, ColorEyedropper::default()));
            ui.close();
        }
        recent(ui, value);
    });
}

fn recent_id() -> egui::Id {
    egui::Id::unique("recent colors")
}

/// Puts a color in front of the recent ones.
fn remember(ui: &Ui, color: HexColor) {
    ui.data_mut(|data| {
        let recent: &mut Vec<HexColor> = data.get_temp_mut_or_default(recent_id());
        recent.retain(|other| *other != color);
        recent.insert(0, color);
        recent.truncate(MAX_RECENT);
    });
}

/// Draws the colors that were chosen last in any popup; a click takes one.
fn recent(ui: &mut Ui, value: &mut Vec3) {
    let colors: Vec<HexColor> = ui.data(|data| data.get_temp(recent_id())).unwrap_or_default();
    for color in colors {
        let [r, g, b] = color.0;
        let size = egui::Vec2::splat(ui.spacing().interact_size.y);
        let button = egui::Button::new("").fill(egui::Color32::from_rgb(r, g, b)).min_size(size);
        let button = ui.add(button);
        let name = format!("Recent color {}", String::from(color));
        button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
        if button.on_hover_text(String::from(color)).clicked() {
            *value = color.linear() * shown_peak(*value);
        }
    }
}

/// Draws the picker. It keeps hue and saturation while the color is gray or black.
fn picker(ui: &mut Ui, value: &mut Vec3) {
    let peak = shown_peak(*value);
    let id = ui.scope_id().with("hsv");
    let rgb = |hsva: Hsva| Vec3::from(hsva.to_rgb());
    let kept = ui.data(|data| data.get_temp::<Hsva>(id));
    let kept = kept.filter(|kept| rgb(*kept).abs_diff_eq(*value / peak, 1e-3));
    let mut hsva = kept.unwrap_or_else(|| Hsva::from_rgb((*value / peak).to_array()));
    if color_picker_hsva_2d(ui, &mut hsva, Alpha::Opaque) {
        *value = rgb(hsva) * peak;
    }
    ui.data_mut(|data| data.insert_temp(id, hsva));
}

/// Draws the sRGB code of the shown color. Typed text is used when the field loses focus; text that is no code is dropped.
fn hex(ui: &mut Ui, value: &mut Vec3) {
    let peak = shown_peak(*value);
    let code = shown_code(*value);
    let id = ui.scope_id().with("hex");
    let mut text = ui.data(|data| data.get_temp(id)).unwrap_or_else(|| String::from(code));
    let label = ui.label("Hex");
    let field = ui.add(egui::TextEdit::singleline(&mut text).desired_width(80.0)).labelled_by(label.id);
    let field = field.on_hover_text("sRGB, #rrggbb");
    if field.has_focus() {
        ui.data_mut(|data| data.insert_temp(id, text));
        return;
    }
    ui.data_mut(|data| data.remove::<String>(id));
    if field.lost_focus()
        && let Ok(typed) = egui_gradient::parse_color(&text)
        && typed != code
    {
        *value = typed.linear() * peak;
    }
}

/// Draws the temperature of the nearest black body; `—` for a color that is none.
fn temperature(ui: &mut Ui, value: &mut Vec3) {
    let label = ui.label("Temperature");
    let found = temperature_of_color(*value);
    let mut kelvin = found.unwrap_or(6500.0);
    let drag = egui::DragValue::new(&mut kelvin).range(KELVIN).speed(20.0).max_decimals(0).suffix(" K");
    let drag = drag.update_while_editing(false).custom_formatter(move |number, _| match found {
        Some(_) => format!("{number:.0}"),
        None => "—".into(),
    });
    let drag = ui.add(drag).labelled_by(label.id);
    if drag.on_hover_text("Color of a black body: candle 1900, bulb 2700, sun 5500, clear sky 12000").changed() {
        *value = color_of_temperature(kelvin) * value.max_element();
    }
}

/// Draws the brightest channel in stops: 0 is 1, each stop doubles it.
fn brightness(ui: &mut Ui, value: &mut Vec3) {
    let label = ui.label("Brightness");
    let peak = value.max_element();
    let mut stops = peak.max(1e-6).log2();
    let drag = egui::DragValue::new(&mut stops)
        .range(STOPS)
        .speed(0.02)
        .fixed_decimals(2)
        .suffix(" stops")
        .update_while_editing(false);
    let drag = ui.add_enabled(peak > 0.0, drag).labelled_by(label.id);
    if drag.on_hover_text("Brightest channel: 0 is 1, each stop doubles it").changed() {
        *value *= stops.exp2() / peak;
    }
}

#[cfg(test)]
mod tests {
    use eframe::egui::{Key, Modifiers, Role, vec2};
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable as _;

    use super::*;

    fn open(value: Vec3) -> Harness<'static, Vec3> {
        let draw = |ui: &mut Ui, value: &mut Vec3| drop(swatch(ui, value, &(0.0..=100.0)).accessible_name("Tint"));
        let mut harness = Harness::builder().with_size(vec2(420.0, 520.0)).build_ui_state(draw, value);
        harness.ctx.add_glyph_rasterizer(super::super::copy_icon::rasterizer());
        harness.get_by_role(Role::ColorWell).click();
        harness.run();
        harness
    }

    #[test]
    fn a_popup_without_room_above_and_below_is_beside_the_panel() {
        let panel = egui::Rect::from_min_max(egui::pos2(500.0, 0.0), egui::pos2(800.0, 420.0));
        let draw = move |ui: &mut Ui, value: &mut Vec3| {
            let mut panel_ui = ui.new_child(egui::UiBuilder::new().max_rect(panel));
            panel_ui.set_clip_rect(panel);
            panel_ui.add_space(200.0);
            swatch(&mut panel_ui, value, &(0.0..=100.0)).accessible_name("Tint");
        };
        let mut harness = Harness::builder().with_size(vec2(800.0, 420.0)).build_ui_state(draw, Vec3::ONE);
        harness.ctx.add_glyph_rasterizer(super::super::copy_icon::rasterizer());
        harness.get_by_role(Role::ColorWell).click();
        harness.run();
        for name in ["Hex", "Brightness"] {
            let field = harness.get_all_by_label(name).next().unwrap().rect();
            assert!(field.right() < panel.left(), "{name}: {field}");
        }
    }

    fn type_into(harness: &mut Harness<'_, Vec3>, role: Role, name: &str, text: &str) {
        harness.get_by_role_and_label(role, name).click();
        harness.run();
        harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
        harness.event(egui::Event::Text(text.into()));
        harness.run();
        harness.key_press(Key::Enter);
        harness.run();
    }

    #[test]
    fn a_typed_code_keeps_the_brightness_and_nonsense_changes_nothing() {
        let mut harness = open(Vec3::new(4.0, 1.0, 0.5));
        type_into(&mut harness, Role::TextInput, "Hex", "#00ff00");
        assert!(harness.state().abs_diff_eq(Vec3::new(0.0, 4.0, 0.0), 1e-4), "{}", harness.state());
        type_into(&mut harness, Role::TextInput, "Hex", "green");
        assert!(harness.state().abs_diff_eq(Vec3::new(0.0, 4.0, 0.0), 1e-4), "{}", harness.state());
    }

    #[test]
    fn colors_of_closed_popups_are_offered_again() {
        let mut harness = open(Vec3::new(4.0, 1.0, 0.5));
        let close = |harness: &mut Harness<'_, Vec3>| {
            harness.key_press(Key::Escape);
            harness.run();
            harness.get_by_role(Role::ColorWell).click();
            harness.run();
        };
        // A popup in which nothing was changed adds no color.
        close(&mut harness);
        assert!(harness.query_all_by_label_contains("Recent color").next().is_none());
        type_into(&mut harness, Role::TextInput, "Hex", "#00ff00");
        close(&mut harness);
        type_into(&mut harness, Role::TextInput, "Hex", "#0000ff");
        close(&mut harness);
        harness.get_by_label("Recent color #00ff00").click();
        harness.run();
        assert!(harness.state().abs_diff_eq(Vec3::new(0.0, 4.0, 0.0), 1e-4), "{}", harness.state());
        assert!(harness.query_by_label("Recent color #0000ff").is_some());
    }

    #[test]
    fn the_eyedropper_takes_a_color_of_the_window() {
        let mut harness = open(Vec3::new(2.0, 2.0, 2.0));
        harness.get_by_label("Pick color").click();
        harness.run_steps(2);
        for _ in 0..6 {
            harness.step();
            let _ = harness.render().unwrap();
        }
        // A position without widgets.
        let position = egui::pos2(400.0, 500.0);
        let background = harness.render().unwrap().get_pixel(400, 500).0;
        harness.hover_at(position);
        for pressed in [true, false] {
            let modifiers = Modifiers::NONE;
            harness.event(egui::Event::PointerButton {
                pos: position,
                button: egui::PointerButton::Primary,
                pressed,
                modifiers,
            });
            harness.run_steps(2);
        }
        let [r, g, b, _] = background;
        let expected = HexColor([r, g, b]).linear() * 2.0;
        assert!(harness.state().abs_diff_eq(expected, 1e-4), "{}, expected {expected}", harness.state());
        assert!(harness.query_by_label("take a color").is_none());
    }

    #[test]
    fn a_temperature_and_stops_set_the_color() {
        let mut harness = open(Vec3::splat(0.5));
        type_into(&mut harness, Role::SpinButton, "Temperature", "2700");
        assert!(harness.state().abs_diff_eq(0.5 * color_of_temperature(2700.0), 1e-4), "{}", harness.state());
        type_into(&mut harness, Role::SpinButton, "Brightness", "2");
        assert!(harness.state().abs_diff_eq(4.0 * color_of_temperature(2700.0), 1e-3), "{}", harness.state());
    }
}
