//! Recipe of a simulation as rows, with its progress, and the menu that opens one.

use std::sync::LazyLock;

use eframe::egui::{ProgressBar, Ui};
use haze_author::preset::Tooltips;
use haze_author::simulation::SimRecipe;
use haze_preset::builtin;

use super::recipe_rows::rows;
use crate::document::display_names::display_name;
use crate::document::simulation_edit::SimulationSource;
use crate::platform::clock::Duration;
use crate::session::Session;
use crate::session::messages::truncate_middle;

static TOOLTIPS: LazyLock<Tooltips> = LazyLock::new(Tooltips::of::<SimRecipe>);

/// Draws the menu of built-in simulations. The chosen one is opened for the selected system.
pub fn menu(ui: &mut Ui, session: &mut Session) {
    let menu = ui.menu_button("Simulate", |ui| {
        for template in builtin::SIMULATIONS {
            if !ui.button(display_name(template.name)).clicked() {
                continue;
            }
            ui.close();
            match SimRecipe::of_built_in(template) {
                Ok(recipe) => {
                    let source = SimulationSource::BuiltIn(template.name.into());
                    session.simulation.open(session.view.system, source, recipe);
                }
                Err(error) => session.messages.error("simulation", error),
            }
        }
    });
    let about =
        "Simulates smoke or fire for this system: a preview plays while you change it, and Bake makes the sprite";
    menu.response.on_hover_text(about);
}

/// Draws the open simulation of a system.
pub fn panel(ui: &mut Ui, session: &mut Session, system: usize) {
    let is_built_in = session.document.is_built_in();
    let is_six_way = session.document.preset.systems.get(system).is_some_and(|system| system.settings.is_six_way());
    let Some(open) = session.simulation.of_system(system) else { return };
    let recipe = open.recipe.clone();
    let title = format!("Simulation: {}", truncate_middle(&open.name(), 30));
    let is_baking = open.is_baking();
    let progress = open.running().map(|running| (running.finished(), running.count));
    ui.horizontal(|ui| {
        ui.strong(title);
        if is_baking {
            if ui.button("Stop").on_hover_text("Writes nothing").clicked() {
                session.simulation.stop();
            }
            return;
        }
        let about = "Simulates all frames, writes sprite, detail map and recipe beside the preset, and uses them here. Takes \
                     minutes.";
        let label = if is_built_in { "Save Preset and Bake…" } else { "Bake" };
        if ui.button(label).on_hover_text(about).clicked() {
            session.simulation.bake(is_built_in);
        }
        if ui.button("Close").on_hover_text("Back to the sprite as it was; nothing is written").clicked() {
            session.simulation.close();
        }
    });
    if let Some((finished, count)) = progress {
        let text = format!("Simulating frame {} of {count}", (finished + 1).min(count));
        ui.add(ProgressBar::new(finished as f32 / count.max(1) as f32).text(text));
        // The simulation does not request frames, so the progress bar does.
        ui.ctx().request_repaint_after(Duration::from_millis(100));
    } else if is_six_way {
        ui.weak("No preview with six-way light, which the bake turns off");
    } else {
        ui.weak("Preview: half the grid, a quarter of the frames");
    }
    let locked = is_baking.then_some("it is being baked");
    let mut edited = rows(ui, session, &TOOLTIPS, &recipe, locked);
    ui.add_enabled_ui(!is_baking, |ui| sources(ui, &mut edited));
    if let Some(open) = session.simulation.of_system(system)
        && edited != recipe
    {
        open.recipe = edited;
        session.messages.clear("simulation");
    }
}

/// Draws the buttons that add and remove sources.
fn sources(ui: &mut Ui, recipe: &mut SimRecipe) {
    ui.horizontal(|ui| {
        let add = ui.button("Add source").on_hover_text("Copies the last source");
        if add.clicked()
            && let Some(last) = recipe.sources.last().cloned()
        {
            recipe.sources.push(last);
        }
        let can_remove = recipe.sources.len() > 1;
        if can_remove && ui.button("Remove source").on_hover_text("Removes the last source").clicked() {
            recipe.sources.pop();
        }
    });
}
