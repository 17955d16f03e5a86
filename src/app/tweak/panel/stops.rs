//! The stops of a ramp that has a recipe, and how one without gets some.

use eframe::egui::{self, Color32, Ui};
use haze::gradient_editor::{GradientEditor, Surroundings};
use haze::ramp::bake::{HexColour, RampRecipe, RampRow};

use crate::app::tweak::ramp_files::Source;
use crate::app::tweak::session::Session;

/// What is said of all that is changed here.
const WRITTEN: &str =
    "Seen at once; the recipe and its PNG are written when a step is done, and again when it is undone";

/// A ramp of the preset.
#[derive(Clone, Copy)]
pub struct Named<'a> {
    pub system: usize,
    pub field: &'static str,
    /// What the preset has for it.
    pub name: &'a str,
}

/// A histogram in its colour, and marks on the ramp.
pub type Bins = (Color32, Vec<f32>);
pub type Mark = (f32, Color32);

/// Draws its editor, and gives the place that is pointed at; nothing for a ramp without stops.
pub fn editor(
    ui: &mut Ui,
    session: &mut Session,
    ramp: Named<'_>,
    bins: &[Bins],
    marks: &[Mark],
) -> Option<Option<f32>> {
    let folders = session.folders();
    let Source::Recipe(recipe) = session.ramps.source(ramp.name, &folders) else { return None };
    let mut recipe = session.document.recipes.ramps.get(ramp.name).unwrap_or(recipe).clone();
    let kept = session.inspect.kept_colour();
    let (editor, row) = session.ramps.editor(ramp.field);
    rows(ui, &recipe, row);
    let histograms: Vec<_> = bins.iter().map(|(colour, bins)| (*colour, bins.as_slice())).collect();
    let surroundings = Surroundings { blend: recipe.blend, histograms: &histograms, marks };
    let shown = recipe.rows.get_mut(*row)?;
    let edited = ui.push_id(ramp.field, |ui| editor.show(ui, shown, &surroundings)).inner;
    let is_changed = edited.is_changed | take_kept(ui, kept, editor, shown);
    if is_changed {
        session.document.recipes.ramps.set(ramp.name, recipe);
    }
    if let Some(refused) = edited.refused {
        session.messages.complain("ramp", refused);
    } else if is_changed {
        session.messages.withdraw("ramp");
    }
    Some(edited.pointed_at)
}

/// An eyedropper: the selected stop takes the colour of the pixel that the inspector keeps. True if it did.
fn take_kept(ui: &mut Ui, kept: Option<[u8; 3]>, editor: &mut GradientEditor, row: &mut RampRow) -> bool {
    let about = "The selected stop takes the colour of a pixel: inspect (I), and click on it in the picture to keep it";
    let button = ui.add_enabled(kept.is_some(), egui::Button::new("Take the kept pixel"));
    let is_taken = button.on_hover_text(about).on_disabled_hover_text(about).clicked();
    if let Some(colour) = kept.filter(|_| is_taken) {
        editor.set_colour(row, HexColour(colour));
    }
    is_taken
}

/// Which of the rows, where there are more than one.
fn rows(ui: &mut Ui, recipe: &RampRecipe, row: &mut usize) {
    *row = (*row).min(recipe.rows.len().saturating_sub(1));
    if recipe.rows.len() > 1 {
        ui.horizontal_wrapped(|ui| {
            ui.label("row at");
            for (index, of) in recipe.rows.iter().enumerate() {
                ui.selectable_value(row, index, format!("{:.2}", of.at)).on_hover_text("On the second axis");
            }
        });
    }
}

/// Says where stops are written, or offers some.
pub fn offer(ui: &mut Ui, session: &mut Session, ramp: Named<'_>) {
    let folders = session.folders();
    match session.ramps.source(ramp.name, &folders) {
        Source::BuiltIn => {
            let about = "Writes a copy of this ramp and its recipe beside the preset, to be changed here; a preset that is \
                         built in is saved first";
            if button(ui, "Make my own", ramp, about) {
                session.ramps.want_own(ramp.system, ramp.field, session.document.is_built_in());
            }
        }
        Source::Painted => {
            let about = "No recipe beside it makes this picture. Finds stops that do; the picture stays as it is until one is changed";
            if button(ui, "Fit stops to the picture", ramp, about) {
                match session.ramps.fit(ramp.name) {
                    Ok((count, error)) => {
                        let name = ramp.name;
                        session.messages.say("ramp", format!("{name}: {count} stops, at most {error:.1}/255 off"));
                    }
                    Err(error) => session.messages.complain("ramp", error),
                }
            }
        }
        Source::Recipe(_) => {
            ui.weak("Saved with each step").on_hover_text(WRITTEN);
        }
        Source::Missing => {}
    }
}

fn button(ui: &mut Ui, text: &str, ramp: Named<'_>, about: &str) -> bool {
    let button = ui.button(text);
    let name = format!("{text}: {}", ramp.name);
    button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
    button.on_hover_text(about).clicked()
}
