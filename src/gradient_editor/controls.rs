//! The fields of the selected stop, and what is done to all of them.

use eframe::egui::{self, Ui};

use super::eyedropper::Eyedropper;
use super::frame::Frame;
use super::{stops, text};
use crate::assets::ramp::bake::{Blend, Curve, HexColour};
use crate::assets::ramp::fit::fit_row;
use crate::assets::ramp::template::TEMPLATES;

/// What the curves are, in the order of [`Curve::ALL`].
const CURVES: [&str; 4] =
    ["smooth, never beyond its neighbours", "straight", "flat at both ends", "a hard edge at the next stop"];

/// Draws them; `at` is the place of the row, for what is copied.
pub fn show(ui: &mut Ui, frame: &mut Frame<'_>, at: f32) {
    if frame.stops.is_empty() {
        return;
    }
    ui.horizontal(|ui| {
        let last = frame.stops.len() - 1;
        let selected = frame.editor.selected;
        let step = |ui: &mut Ui, is_enabled, text, name: &str| {
            let response = ui.add_enabled(is_enabled, egui::Button::new(text));
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, is_enabled, name));
            response.on_hover_text(name).clicked()
        };
        if step(ui, selected > 0, "<", "previous stop") {
            frame.editor.selected -= 1;
        }
        if step(ui, selected < last, ">", "next stop") {
            frame.editor.selected += 1;
        }
        ui.label(format!("Stop {} of {}", selected + 1, last + 1));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| place(ui, frame));
    });
    ui.horizontal(|ui| colour_and_curve(ui, frame));
    ui.horizontal(|ui| {
        hue_and_so_on(ui, frame);
        eyedropper(ui, frame);
    });
    ui.horizontal_wrapped(|ui| {
        all(ui, frame, at);
        snap(ui, frame);
    });
}

fn place(ui: &mut Ui, frame: &mut Frame<'_>) {
    let mut at = frame.stops[frame.editor.selected].at;
    let field = egui::DragValue::new(&mut at).range(0.0..=1.0).speed(0.001).max_decimals(4).update_while_editing(false);
    let response = ui.add_sized([64.0, ui.spacing().interact_size.y], field);
    let label = ui.label("place");
    if response.labelled_by(label.id).on_hover_text("0 to 1: drag, or click and type").changed() {
        frame.edit_and_select("move a stop", |all, index| stops::move_to(all, index, at));
    }
}

fn colour_and_curve(ui: &mut Ui, frame: &mut Frame<'_>) {
    let stop = &frame.stops[frame.editor.selected];
    let (mut colour, mut curve) = (stop.colour, stop.curve);
    let label = ui.label("colour");
    if ui.color_edit_button_srgb(&mut colour.0).labelled_by(label.id).changed() {
        frame.recolour(colour);
    }
    let mut text = frame.editor.typed.take().unwrap_or_else(|| colour.into());
    let field = ui.add(egui::TextEdit::singleline(&mut text).desired_width(66.0)).labelled_by(label.id);
    let field = field.on_hover_text("sRGB, #rrggbb");
    if field.lost_focus() {
        match text::colour(&text) {
            Ok(typed) if typed == colour => {}
            Ok(typed) => frame.recolour(typed),
            Err(reason) => frame.refused = Some(reason),
        }
    } else if field.has_focus() {
        frame.editor.typed = Some(text);
    }
    let label = ui.label("then");
    let combo = egui::ComboBox::from_id_salt("curve").selected_text(curve.name()).width(ui.available_width() - 8.0);
    let combo = combo.show_ui(ui, |ui| {
        for (entry, about) in Curve::ALL.iter().zip(CURVES) {
            ui.selectable_value(&mut curve, *entry, entry.name()).on_hover_text(about);
        }
    });
    combo.response.labelled_by(label.id).on_hover_text("How the gradient goes on to the next stop");
    if curve != frame.stops[frame.editor.selected].curve {
        frame.edit("curve of a stop", |all, index| all[index].curve = curve);
    }
}

/// Hue, saturation and value of the colour, as paint programs have them.
fn hue_and_so_on(ui: &mut Ui, frame: &mut Frame<'_>) {
    let colour = frame.stops[frame.editor.selected].colour;
    let known = frame.editor.hsv.filter(|(known, _)| *known == colour);
    let before = known.map_or_else(|| colour.hsv(), |(_, hsv)| hsv);
    let mut hsv = before;
    for (channel, (name, letter, most, unit)) in hsv.as_mut().iter_mut().zip([
        ("hue", "H ", 360.0, "°"),
        ("saturation", "S ", 100.0, "%"),
        ("value", "V ", 100.0, "%"),
    ]) {
        let mut shown = *channel * most;
        let field = egui::DragValue::new(&mut shown).range(0.0..=most).max_decimals(1).prefix(letter).suffix(unit);
        let response = ui.add(field.speed(most / 250.0).update_while_editing(false));
        let number = f64::from(shown);
        response.widget_info(|| egui::WidgetInfo {
            label: Some(name.into()),
            ..egui::WidgetInfo::drag_value(true, number)
        });
        if response.on_hover_text(format!("{name}, of the sRGB colour")).changed() {
            *channel = shown / most;
        }
    }
    if hsv != before {
        let colour = HexColour::from_hsv(hsv);
        frame.editor.hsv = Some((colour, hsv));
        frame.recolour(colour);
    }
}

/// How far stops of a stroke may be off its colours, steps of 255.
const ERROR: f32 = 10.0;

/// Lets the eyedropper take what it is for, while there is one: a step.
pub fn take(ui: &Ui, frame: &mut Frame<'_>, blend: Blend) {
    let Some(mut eyedropper) = frame.editor.eyedropper.take() else { return };
    match eyedropper.take(ui).as_deref() {
        None => frame.editor.eyedropper = Some(eyedropper),
        Some([]) => {}
        Some([colour]) => frame.recolour(HexColour::from_srgb(*colour / 255.0)),
        Some(row) => frame.replace("gradient of a stroke", fit_row(row, blend, ERROR)),
    }
}

fn eyedropper(ui: &mut Ui, frame: &mut Frame<'_>) {
    let about = "The selected stop takes the colour that is clicked on next, anywhere in the window; a stroke takes the gradient \
                 along it. Escape gives it up";
    let is_on = frame.editor.eyedropper.is_some();
    if ui.selectable_label(is_on, "Take a colour").on_hover_text(about).clicked() {
        frame.editor.eyedropper = Some(Eyedropper::default());
    }
}

fn snap(ui: &mut Ui, frame: &mut Frame<'_>) {
    let snap = &mut frame.editor.snap;
    ui.checkbox(&mut snap.is_on, "Snap").on_hover_text("Without Ctrl; Ctrl lets go then");
    let field = egui::DragValue::new(&mut snap.parts).range(2..=100).speed(0.1).suffix(" parts");
    let response = ui.add(field.update_while_editing(false));
    response.on_hover_text("How many equal parts of the gradient places snap to");
}

fn all(ui: &mut Ui, frame: &mut Frame<'_>, at: f32) {
    let is_many = frame.stops.len() > 1;
    let button = |ui: &mut Ui, is_enabled: bool, name: &str, about: &str| {
        ui.add_enabled(is_enabled, egui::Button::new(name)).on_hover_text(about).clicked()
    };
    if button(ui, is_many, "Remove", "The selected stop (Delete)") {
        frame.edit_and_select("remove a stop", stops::remove);
    }
    if button(ui, true, "Flip", "What is at 0 goes to 1") {
        frame.edit("flip", |all, _| stops::flip(all));
    }
    if button(ui, is_many, "Distribute", "The same distance from each stop to the next") {
        frame.edit("distribute", |all, _| stops::distribute(all));
    }
    if button(ui, is_many, "Steps", "The same width for what is at the right of each stop: for constant curves") {
        frame.edit("distribute", |all, _| stops::step_evenly(all));
    }
    if button(ui, true, "Copy", "All stops, as text of a recipe (Ctrl+C on a stop)") {
        frame.copy(ui, at);
    }
    if button(ui, true, "Paste", "Stops that were copied, in place of these (Ctrl+V on a stop)") {
        frame.editor.awaits_paste = true;
        ui.ctx().send_viewport_cmd(egui::ViewportCommand::RequestPaste);
    }
    ui.menu_button("Templates", |ui| {
        egui::ScrollArea::vertical().max_height(320.0).show(ui, |ui| {
            for template in TEMPLATES {
                if ui.button(template.name.replace('_', " ")).on_hover_text(template.about).clicked() {
                    let stops = template.recipe().rows.swap_remove(0).stops;
                    frame.replace("template", stops);
                    ui.close();
                }
            }
        });
    });
}
