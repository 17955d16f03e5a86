//! Stops of a ramp that has a recipe, and ways to get a recipe for one that has none.

use std::path::Path;

use eframe::egui::{self, Color32, Ui};
use egui_gradient::DisplayOptions;
use glam::Vec2;
use haze_author::ramp::fit_stops::{RampFit, simplify_rows};
use haze_author::ramp::{Blend, RampRecipe, RampRow};
use haze_core::error::FieldError;
use haze_preset::{AssetFolders, builtin};

use super::gradient_drag::{self, DraggedGradient};
use super::rows::value_control;
use crate::document::ramp_edits::RampOrigin;
use crate::session::{CopiedImage, CopyRequest, Session};

/// Tooltip about saving.
const WRITTEN: &str =
    "Changes are visible at once. The ramp's files, a recipe and a PNG, are written after each step and each undo.";

/// Ramp of the preset.
#[derive(Clone, Copy)]
pub struct NamedRamp<'a> {
    pub system: usize,
    pub field: &'static str,
    /// Name that the preset has for it.
    pub name: &'a str,
}

/// Histogram and its color; coordinate and color of a mark.
pub type Bins = (Color32, Vec<f32>);
pub type Mark = (f32, Color32);

/// Histograms of the coordinates that the image samples along an axis of a ramp, and marks of single pixels.
pub type AxisSamples = (Vec<Bins>, Vec<Mark>);

/// True if a ramp has stops to edit.
pub fn has_stops(session: &mut Session, ramp: NamedRamp<'_>) -> bool {
    let folders = session.folders();
    matches!(session.ramps.source(ramp.name, &folders), RampOrigin::Recipe(_))
}

/// Draws the editor of a ramp, and returns the position under the pointer; the outer `None` means that the ramp has no stops.
/// Histograms are shown for the axis of the edited gradient: rows run across, the gradient that multiplies
/// them runs upwards.
pub fn editor(
    ui: &mut Ui,
    session: &mut Session,
    ramp: NamedRamp<'_>,
    across: &AxisSamples,
    up: &AxisSamples,
) -> Option<Option<Vec2>> {
    let folders = session.folders();
    let RampOrigin::Recipe(read) = session.ramps.source(ramp.name, &folders).clone() else { return None };
    let mut recipe = session.document.recipes.ramps.get(ramp.name).unwrap_or(&read).clone();
    let (editor, index) = session.ramps.editor(ramp.field);
    let mut is_changed = choose(ui, &mut recipe, index);
    let simplified = if recipe.rows.len() > 1 { simplify_rows_menu(ui, &recipe) } else { None };
    if let Some(Ok(simple)) = &simplified {
        recipe = simple.recipe.clone();
        *index = 0;
        is_changed = true;
    }
    let (bins, marks) = if *index < recipe.rows.len() { across } else { up };
    let histograms: Vec<_> = bins.iter().map(|(color, bins)| (*color, bins.as_slice())).collect();
    let options = DisplayOptions { blend: recipe.blend, histograms: &histograms, marks };
    let mut shown = shown(&recipe, *index)?;
    let edited = ui.push_id(ramp.field, |ui| editor.show(ui, &mut shown, &options));
    let rect = edited.response.rect;
    let edited = edited.inner;
    let index = *index;
    match &simplified {
        Some(Ok(RampFit { recipe: simple, error })) => {
            session.document.name_gradient_step(ramp.name, "simplify rows");
            let stops: usize = simple.rows.iter().map(|row| row.stops.len()).sum();
            let size = format!("{stops} stops in rows: {}", simple.rows.len());
            session.messages.info("simplify", format!("{}: {size}, largest error {error:.1}/255", ramp.name));
        }
        Some(Err(error)) => session.messages.error("simplify", error),
        None => {}
    }
    if let Some(dropped) = gradient_drag::dropped(ui, rect) {
        session.document.name_gradient_step(ramp.name, "copy a gradient");
        if recipe.rows.len() == 1 && recipe.times.is_empty() {
            recipe.blend = dropped.blend;
        }
        match recipe.rows.get_mut(index) {
            Some(row) => row.stops.clone_from(&dropped.stops),
            None => recipe.times.clone_from(&dropped.stops),
        }
        is_changed = true;
    }
    is_changed |= ui.horizontal(|ui| blend(ui, &mut recipe.blend, ramp.field)).inner;
    if let Some(step) = edited.step {
        session.document.name_gradient_step(ramp.name, step);
    }
    if edited.is_changed {
        match recipe.rows.get_mut(index) {
            Some(row) => *row = shown,
            None => recipe.times = shown.stops,
        }
        is_changed = true;
    }
    // The gradient that multiplies the rows has no position of its own.
    let row = recipe.rows.get(index).map(|row| row.at);
    if is_changed {
        let ramps = &mut session.document.recipes.ramps;
        // A recipe that equals the one on disk is no change, and no step.
        if recipe == read {
            ramps.forget(ramp.name);
        } else {
            ramps.set(ramp.name, recipe);
        }
    }
    if let Some(refused) = edited.refused {
        session.messages.error("ramp", refused);
    } else if is_changed {
        session.messages.clear("ramp");
    }
    Some(edited.pointed_at.zip(row).map(|(at, row)| Vec2::new(at, row)))
}

/// Returns the recipe of a ramp as it is edited, or that of a built-in ramp.
fn recipe_of(session: &mut Session, name: &str, folders: &AssetFolders) -> Option<RampRecipe> {
    match session.ramps.source(name, folders) {
        RampOrigin::Recipe(read) => {
            let read = read.clone();
            Some(session.document.recipes.ramps.get(name).cloned().unwrap_or(read))
        }
        RampOrigin::BuiltIn => {
            let builtin = builtin::find(builtin::RAMPS, name)?;
            RampRecipe::parse(Path::new(name), builtin.recipe).ok()
        }
        RampOrigin::Painted { .. } | RampOrigin::Missing => None,
    }
}

/// Draws the grip with which the shown gradient is dragged onto another ramp, if it has one.
pub fn grip(ui: &mut Ui, session: &mut Session, ramp: NamedRamp<'_>) {
    let folders = session.folders();
    let Some(recipe) = recipe_of(session, ramp.name, &folders) else { return };
    let index = session.ramps.editor(ramp.field).1;
    if let Some(row) = shown(&recipe, index).or_else(|| shown(&recipe, 0)) {
        gradient_drag::grip(ui, ramp.name, DraggedGradient { stops: row.stops, blend: recipe.blend });
    }
}

/// Draws the choice of the color space for blending. Returns true if it was changed.
fn blend(ui: &mut Ui, blend: &mut Blend, field: &str) -> bool {
    let before = *blend;
    let label = ui.label("Blend in");
    value_control::choice(ui, blend, &format!("Blend of {field}"), |_| None).labelled_by(label.id);
    *blend != before
}

/// Returns the edited gradient: a row, or the gradient that multiplies the rows.
fn shown(recipe: &RampRecipe, index: usize) -> Option<RampRow> {
    let times = || RampRow { stops: recipe.times.clone(), ..RampRow::default() };
    recipe.rows.get(index).cloned().or_else(|| (!recipe.times.is_empty()).then(times))
}

/// Draws the choice of a gradient for a ramp with two axes, with controls to add, move and remove rows. Returns true if
/// the recipe was changed.
fn choose(ui: &mut Ui, recipe: &mut RampRecipe, index: &mut usize) -> bool {
    let has_times = !recipe.times.is_empty();
    *index = (*index).min(recipe.rows.len() - usize::from(!has_times && !recipe.rows.is_empty()));
    if recipe.height == 1 && recipe.rows.len() == 1 && !has_times {
        return false;
    }
    let before = recipe.rows.clone();
    ui.horizontal_wrapped(|ui| {
        ui.label("Row at");
        for (rect, of) in recipe.rows.iter().enumerate() {
            ui.selectable_value(index, rect, format!("{:.2}", of.at)).on_hover_text("Position on the vertical axis");
        }
        if has_times {
            let about = "A gradient along the vertical axis that multiplies the rows";
            ui.selectable_value(index, recipe.rows.len(), "Multiplier").on_hover_text(about);
        }
    });
    let Some(chosen) = recipe.rows.get_mut(*index) else { return false };
    let mut is_added = false;
    let mut is_removed = false;
    ui.horizontal(|ui| {
        let label = ui.label("Position");
        let field = egui::DragValue::new(&mut chosen.at).range(0.0..=1.0).speed(0.002).update_while_editing(false);
        ui.add(field).labelled_by(label.id).on_hover_text("Position on the vertical axis, 0 to 1");
        is_added = ui.button("Add row").on_hover_text("Copies this row half way to the next").clicked();
        is_removed = ui.add_enabled(before.len() > 1, egui::Button::new("Remove row")).clicked();
    });
    if is_added {
        let above = before.iter().map(|row| row.at).filter(|at| *at > chosen.at).fold(1.0, f32::min);
        let copy = RampRow { at: 0.5 * (chosen.at + above), ..chosen.clone() };
        *index += 1;
        recipe.rows.insert(*index, copy);
    } else if is_removed {
        recipe.rows.remove(*index);
        *index = index.saturating_sub(1);
    }
    recipe.rows != before
}

/// Largest errors that the menu of simpler rows offers, steps of 255.
const ROW_ERRORS: [f32; 4] = [1.5, 3.0, 6.0, 12.0];

/// Draws the menu that fits fewer rows and stops. Returns the chosen recipe.
fn simplify_rows_menu(ui: &mut Ui, recipe: &RampRecipe) -> Option<Result<RampFit, FieldError>> {
    let mut chosen = None;
    let menu = ui.menu_button("Simplify rows", |ui| {
        for error in ROW_ERRORS {
            if ui.button(format!("Within {error} of 255")).clicked() {
                chosen = Some(simplify_rows(recipe, error));
                ui.close();
            }
        }
    });
    menu.response.on_hover_text("Fewer rows, and fewer stops in each, with this largest error in any channel");
    chosen
}

/// Draws where stops are saved, or a button to get stops.
pub fn offer_stops(ui: &mut Ui, session: &mut Session, ramp: NamedRamp<'_>) {
    let folders = session.folders();
    match session.ramps.source(ramp.name, &folders) {
        RampOrigin::BuiltIn => {
            let about = "Built-in ramps cannot be changed. Makes an editable copy; asks first.";
            if button(ui, "Make my own…", ramp, about) {
                let system = ramp.system;
                let name = ramp.name.to_owned();
                let image = CopiedImage::Ramp(ramp.field);
                session.copy_request = Some(CopyRequest { system, name, image });
            }
        }
        RampOrigin::Painted { has_recipe, has_bands } => {
            let has_recipe = *has_recipe;
            let has_bands = *has_bands;
            let recipe = Path::new(ramp.name).with_extension("ramp.json");
            if has_recipe {
                ui.label(format!(
                    "The image does not match {}: another program changed one of them.",
                    recipe.display()
                ));
            } else {
                ui.weak("A painted image has no stops.");
            }
            let about = "Finds stops that make this image. The image stays as it is until you edit a stop.";
            let mut fitted = button(ui, "Fit stops to image", ramp, about).then(|| session.ramps.fit(ramp.name));
            if has_bands {
                let about = "The gradient has visible steps, because the image has 8 bits a channel. Finds stops that make this \
                             image, and replaces it by a smooth one of 16 bits.";
                if button(ui, "Import and bake", ramp, about) {
                    fitted = Some(session.ramps.import_and_bake(ramp.name));
                }
            }
            match fitted {
                Some(Ok((count, error))) => {
                    let name = ramp.name;
                    session.messages.info("ramp", format!("{name}: {count} stops, largest error {error:.1}/255"));
                }
                Some(Err(error)) => session.messages.error("ramp", error),
                None => {}
            }
        }
        RampOrigin::Recipe(_) => {
            ui.weak("Saved automatically").on_hover_text(WRITTEN);
        }
        RampOrigin::Missing => {}
    }
}

fn button(ui: &mut Ui, text: &str, ramp: NamedRamp<'_>, about: &str) -> bool {
    let button = ui.button(text);
    let name = format!("{text}: {}", ramp.name);
    button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
    button.on_hover_text(about).clicked()
}
