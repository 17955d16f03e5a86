//! Fields of the selected stop, and buttons that act on all or all selected stops.

use egui::{self, Ui};
use glam::Vec3;

use super::edit_context::{EditContext, MOVE, RECOLOR, REMOVE};
use super::eyedropper::{Eyedropper, EyedropperResult};
use super::number::{self, NumberInput};
use super::paint::color32;
use super::selection::Selection;
use super::{clipboard, gradient_strip, simplify, stop_operations};
use haze_author::ramp::fit_stops::fit_row;
use haze_author::ramp::template::TEMPLATES;
use haze_author::ramp::{Blend, Curve, HexColor, RampStop};

/// Hover texts of the curves, in the order of [`Curve::ALL`].
const CURVES: [&str; 4] = ["Smooth, without overshoot", "Linear", "Flat at both ends", "Hard edge at the next stop"];

/// Draws the controls. `at` is the position of the row, for copied text; `blend` the space of the gradient.
pub fn show(ui: &mut Ui, context: &mut EditContext<'_>, at: f32, blend: Blend) {
    let Some(lead) = context.lead().cloned() else { return };
    ui.horizontal(|ui| {
        let last = context.stops.len() - 1;
        let selected = context.editor.selection.lead();
        let step = |ui: &mut Ui, is_enabled, text, name: &str| {
            let response = ui.add_enabled(is_enabled, egui::Button::new(text));
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, is_enabled, name));
            response.on_hover_text(name).clicked()
        };
        if step(ui, selected > 0, "<", "previous stop") {
            context.editor.selection = Selection::one(selected - 1);
        }
        if step(ui, selected < last, ">", "next stop") {
            context.editor.selection = Selection::one(selected + 1);
        }
        match context.editor.selection.count() {
            1 => ui.label(format!("Stop {} of {}", selected + 1, last + 1)),
            count => ui.label(format!("{count} of {} stops", last + 1)),
        };
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| position_field(ui, context, &lead));
    });
    ui.horizontal(|ui| color_and_curve(ui, context, &lead));
    ui.horizontal(|ui| {
        hsv_fields(ui, context, &lead);
        eyedropper_button(ui, context);
    });
    ui.horizontal_wrapped(|ui| {
        stop_buttons(ui, context, at);
        simplify_menu(ui, context, blend);
    });
    ui.horizontal(|ui| snap_controls(ui, context));
}

/// Returns a name whose first letter is a capital.
pub fn sentence_case(name: &str) -> String {
    let mut letters = name.chars();
    letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
}

fn position_field(ui: &mut Ui, context: &mut EditContext<'_>, lead: &RampStop) {
    let (response, typed) = number::field(ui, lead.at, |ui, field| {
        let field = field.range(0.0..=1.0).speed(0.001).max_decimals(4);
        ui.add_sized([64.0, ui.spacing().interact_size.y], field)
    });
    let label = ui.label("Position");
    response
        .labelled_by(label.id)
        .on_hover_text("0 to 1. Drag it, or click and type: +0.1, -0.1, *2 and /2 change the current number");
    match typed {
        None => {}
        Some(NumberInput::Multiply(times)) => {
            context.edit_selected(MOVE, |all, selection| stop_operations::scale(all, selection, times));
        }
        Some(typed) => {
            let at = typed.apply_to(lead.at);
            context.edit_selected(MOVE, |all, selection| stop_operations::move_to(all, selection, at));
        }
    }
}

fn color_and_curve(ui: &mut Ui, context: &mut EditContext<'_>, lead: &RampStop) {
    let mut color = lead.color;
    let mut curve = lead.curve;
    let label = ui.label("Color");
    if ui.color_edit_button_srgb(&mut color.0).labelled_by(label.id).changed() {
        context.recolor(color);
    }
    let mut text = context.editor.typed.take().unwrap_or_else(|| color.into());
    let field = ui.add(egui::TextEdit::singleline(&mut text).desired_width(66.0)).labelled_by(label.id);
    let field = field.on_hover_text("sRGB, #rrggbb");
    if field.lost_focus() {
        match clipboard::color(&text) {
            Ok(typed) if typed == color => {}
            Ok(typed) => context.recolor(typed),
            Err(reason) => context.refused = Some(reason),
        }
    } else if field.has_focus() {
        context.editor.typed = Some(text);
    }
    let label = ui.label("Curve");
    let combo = egui::ComboBox::from_id_salt("curve")
        .selected_text(sentence_case(curve.name()))
        .width(ui.available_width() - 8.0);
    let combo = combo.show_ui(ui, |ui| {
        for (entry, about) in Curve::ALL.iter().zip(CURVES) {
            ui.selectable_value(&mut curve, *entry, sentence_case(entry.name())).on_hover_text(about);
        }
    });
    combo.response.labelled_by(label.id).on_hover_text("Interpolation to the next stop");
    if curve != lead.curve {
        context.edit_each(["curve of a stop", "curve of stops"], |stop| stop.curve = curve);
    }
}

/// Draws fields for hue, saturation and value of the color.
fn hsv_fields(ui: &mut Ui, context: &mut EditContext<'_>, lead: &RampStop) {
    let known = context.editor.hsv.filter(|(known, _)| *known == lead.color);
    let shown = known.map_or_else(|| lead.color.hsv(), |(_, hsv)| hsv);
    for (channel, (name, letter, most, unit)) in
        [("hue", "H ", 360.0, "°"), ("saturation", "S ", 100.0, "%"), ("value", "V ", 100.0, "%")]
            .into_iter()
            .enumerate()
    {
        let number = shown[channel] * most;
        let (response, typed) = number::field(ui, number, |ui, field| {
            let field = field.range(0.0..=most).max_decimals(1).prefix(letter).suffix(unit);
            ui.add(field.speed(most / 250.0))
        });
        let number = f64::from(number);
        response.widget_info(|| egui::WidgetInfo {
            label: Some(name.into()),
            ..egui::WidgetInfo::drag_value(true, number)
        });
        response.on_hover_text(format!(
            "{} of the sRGB color. +10 or *0.5 changes each selected stop",
            sentence_case(name)
        ));
        if let Some(typed) = typed {
            let changed = |hsv: Vec3| {
                let mut hsv = hsv;
                hsv[channel] = (typed.apply_to(hsv[channel] * most) / most).clamp(0.0, 1.0);
                hsv
            };
            let of_lead = changed(shown);
            context.edit_each(RECOLOR, |stop| {
                let hsv = if stop.color == lead.color { of_lead } else { changed(stop.color.hsv()) };
                stop.color = HexColor::from_hsv(hsv);
            });
            context.editor.hsv = Some((HexColor::from_hsv(of_lead), of_lead));
        }
    }
}

/// Error bound of the stops fitted to a stroke, steps of 255.
const ERROR: f32 = 10.0;

/// Updates the active eyedropper and applies its result as one undo step.
pub fn update_eyedropper(ui: &Ui, context: &mut EditContext<'_>, blend: Blend) {
    let Some(mut eyedropper) = context.editor.eyedropper.take() else { return };
    match eyedropper.update(ui, &mut context.editor.sample_size) {
        EyedropperResult::Pointed(colors) => {
            if let Some(Ok(gradient)) =
                preview(context, &colors, blend).map(|stops| stop_operations::gradient(&stops, blend))
            {
                let color = |at: f32| color32(gradient_strip::color_at(&gradient, at));
                eyedropper.magnifier(ui, context.editor.sample_size, &colors, color);
            }
            context.editor.eyedropper = Some(eyedropper);
        }
        EyedropperResult::Done(colors) => match colors.as_slice() {
            [] => {}
            [color] => context.recolor(HexColor::from_srgb(*color / 255.0)),
            row => context.replace("gradient of a stroke", fit_row(row, blend, ERROR)),
        },
    }
}

/// Returns the stops that the eyedropper's current colors would give.
fn preview(context: &EditContext<'_>, colors: &[Vec3], blend: Blend) -> Option<Vec<RampStop>> {
    match colors {
        [] => None,
        [color] => {
            let mut stops = context.stops.clone();
            let selected = context.editor.selection.iter();
            selected.for_each(|index| stops[index].color = HexColor::from_srgb(*color / 255.0));
            Some(stops)
        }
        row => Some(fit_row(row, blend, ERROR)),
    }
}

fn eyedropper_button(ui: &mut Ui, context: &mut EditContext<'_>) {
    let about = "Click anywhere in the window to give its color to the selected stops, or draw a stroke to take the gradient \
                 along it. Wheel, or 1, 3 and 5: pixels across that are averaged. Keys: arrows move, with Shift ten times as far; \
                 Enter takes the color, Space begins a stroke. Escape cancels";
    let is_on = context.editor.eyedropper.is_some();
    if ui.selectable_label(is_on, "Pick color").on_hover_text(about).clicked() {
        context.editor.eyedropper = Some(Eyedropper::default());
    }
}

fn snap_controls(ui: &mut Ui, context: &mut EditContext<'_>) {
    let snap = &mut context.editor.snap;
    ui.checkbox(&mut snap.is_on, "Snap").on_hover_text("Snaps positions. Ctrl turns it off meanwhile.");
    let field = egui::DragValue::new(&mut snap.parts).range(2..=100).speed(0.1).suffix(" parts");
    let response = ui.add(field.update_while_editing(false));
    response.on_hover_text("Number of equal parts that positions snap to");
}

/// Draws the menu of simpler gradients.
fn simplify_menu(ui: &mut Ui, context: &mut EditContext<'_>, blend: Blend) {
    let menu = ui.menu_button("Simplify", |ui| {
        let known = context.editor.simplified.take();
        let known = known.filter(|(of, in_blend, _)| of == context.stops && *in_blend == blend);
        let known = known.unwrap_or_else(|| (context.stops.clone(), blend, simplify::simplified(context.stops, blend)));
        if known.2.is_empty() {
            ui.weak("No fewer stops make this gradient");
        }
        for simple in &known.2 {
            let text = format!("{} stops, error {:.1} of 255", simple.stops.len(), simple.error);
            if ui.button(text).clicked() {
                context.replace("simplify", simple.stops.clone());
                ui.close();
            }
        }
        context.editor.simplified = Some(known);
    });
    menu.response.on_hover_text("Fewer stops, with the largest error in any channel");
}

fn stop_buttons(ui: &mut Ui, context: &mut EditContext<'_>, at: f32) {
    let is_many = context.stops.len() > 1;
    let is_part = context.editor.selection.is_many();
    let of = |all: &str, part: &str| if is_part { part.to_owned() } else { all.to_owned() };
    let button = |ui: &mut Ui, is_enabled: bool, name: &str, about: &str| {
        ui.add_enabled(is_enabled, egui::Button::new(name)).on_hover_text(about).clicked()
    };
    if button(ui, is_many, "Remove", "Remove the selected stops (Delete)") {
        context.edit_selected(REMOVE, stop_operations::remove);
    }
    let about = of("Reverse the gradient", "Reverse the part from the first to the last selected stop");
    if button(ui, true, "Flip", &about) {
        context.edit_selected(["flip", "flip a part"], stop_operations::flip);
    }
    let about = of("Compress into the first half and mirror into the second", "Mirror the selected part");
    if button(ui, is_many, "Mirror", &about) {
        context.edit_selected(["mirror", "mirror a part"], stop_operations::mirror);
    }
    let about = of("Space all stops evenly", "Space the selected stops evenly");
    if button(ui, is_many, "Distribute", &about) {
        context.edit_selected(["distribute", "distribute a part"], |all, selection| {
            stop_operations::distribute(all, selection);
        });
    }
    let about = "Give the range after each stop the same width: for constant curves";
    if button(ui, is_many, "Steps", about) {
        context.edit_selected(["even steps", "even steps in a part"], |all, selection| {
            stop_operations::distribute_steps(all, selection);
        });
    }
    if button(ui, true, "Copy", "Copy all stops as recipe text (Ctrl+C on a stop)") {
        context.copy(ui, at);
    }
    if button(ui, true, "Paste", "Replace the stops by copied ones (Ctrl+V on a stop)") {
        context.editor.awaits_paste = true;
        ui.ctx().send_viewport_cmd(egui::ViewportCommand::RequestPaste);
    }
    ui.menu_button("Templates", |ui| {
        egui::ScrollArea::vertical().max_height(320.0).show(ui, |ui| {
            for template in TEMPLATES {
                if ui.button(template.name.replace('_', " ")).on_hover_text(template.description).clicked() {
                    let stops = template.recipe().rows.swap_remove(0).stops;
                    context.replace("template", stops);
                    ui.close();
                }
            }
        });
    });
}
