//! Sprite tab: the sprite of a system as it is lit, findings of its check, and its recipe.

mod flipbook_view;
mod recipe_rows;
mod simulation_recipe;
mod sprite_recipe;

use eframe::egui::{self, Ui};

use haze_preset::MaterialSources;

use crate::session::Session;
use crate::session::messages::truncate_middle;

/// Height up to which the tab scrolls as a whole, points; below it, there is no room for a recipe under the image.
const SMALL: f32 = 360.0;

/// Draws the tab for the sprite of the selected system.
pub fn panel(ui: &mut Ui, session: &mut Session) {
    let index = session.view.system;
    let material = session.materials().into_iter().nth(index);
    let Some((system, material)) = session.document.preset.systems.get(index).zip(material) else {
        ui.weak("This preset has no smoke.");
        return;
    };
    let names = system.material.clone();
    let settings = system.settings;
    let area = egui::ScrollArea::vertical().id_salt(session.view.tab).auto_shrink(false);
    let top = |ui: &mut Ui, session: &mut Session| {
        flipbook_view::panel(ui, &mut session.view.sprite, &mut session.flipbook, &material, &settings);
        ui.separator();
        ui.horizontal(|ui| {
            ui.strong(truncate_middle(&names.sprite, 40));
            let sprite = &material.sprite;
            ui.weak(format!("{} frames, {1}×{1} each", sprite.frame_count(), sprite.size()));
        });
    };
    if ui.available_height() < SMALL {
        area.show(ui, |ui| {
            top(ui, session);
            recipe(ui, session, index, &names);
        });
        return;
    }
    // The image does not scroll, so that it stays visible while sliders far below are moved.
    top(ui, session);
    area.show(ui, |ui| recipe(ui, session, index, &names));
}

/// Draws the recipe of the sprite, or of the simulation that is to replace it.
fn recipe(ui: &mut Ui, session: &mut Session, system: usize, names: &MaterialSources) {
    if session.simulation.of_system(system).is_some() {
        simulation_recipe::panel(ui, session, system);
    } else {
        sprite_recipe::panel(ui, session, names);
    }
}
