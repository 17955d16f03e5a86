//! Recipe of a sprite as rows, and ways to get one for a sprite that has none.

use std::sync::LazyLock;

use eframe::egui::{ProgressBar, Ui};
use haze_author::preset::Tooltips;
use haze_author::sprite::bake::SpriteRecipe;
use haze_preset::{MaterialSources, builtin};

use super::recipe_rows::rows;
use super::simulation_recipe;
use crate::document::simulation_edit::SimulationSource;
use crate::document::sprite_edits::set_recipe;
use crate::document::sprite_edits::sprite_source::SpriteOrigin;
use crate::platform::clock::Duration;
use crate::session::messages::truncate_middle;
use crate::session::{CopiedImage, CopyRequest, Session};

static TOOLTIPS: LazyLock<Tooltips> = LazyLock::new(Tooltips::of::<SpriteRecipe>);

/// Tooltip about saving.
const WRITTEN: &str = "Changes are visible at once at low resolution. The sprite is baked at full resolution and written when the control \
                       is released, and again after an undo.";

/// Longest finding or error that is shown, characters.
const MAX_CHARACTERS: usize = 400;

/// Draws the recipe of the selected system's sprite, or the ways to get one.
pub fn panel(ui: &mut Ui, session: &mut Session, names: &MaterialSources) {
    let folders = session.folders();
    let wake = session.repaint.clone();
    let Some(known) = session.sprites.ask(names, &folders, move || wake.call()) else { return };
    if let Some(broken) = &known.broken {
        ui.colored_label(ui.visuals().error_fg_color, truncate_middle(broken, MAX_CHARACTERS));
    }
    for finding in &known.findings {
        ui.colored_label(ui.visuals().warn_fg_color, truncate_middle(finding, MAX_CHARACTERS));
    }
    let file = known.recipe_file();
    let file = truncate_middle(&file.file_name().unwrap_or_default().to_string_lossy(), 60);
    let source = known.source.clone();
    let image = known.image.clone();
    let is_broken = known.broken.is_some();
    let progress = known.full.as_ref().map(|order| (order.frames(), order.recipe.frame_count()));
    let name = &names.sprite;
    match source {
        SpriteOrigin::Reading => {
            ui.weak("Reading the sprite…");
        }
        SpriteOrigin::BuiltIn(recipe) => {
            let about = "Built-in sprites cannot be changed. Makes an editable copy; asks first.";
            ui.horizontal(|ui| {
                if ui.button("Make my own…").on_hover_text(about).clicked() {
                    request_copy(session, name);
                }
                simulation_recipe::menu(ui, session);
            });
            sprite_rows(
                ui,
                session,
                name,
                &recipe,
                Some("a built-in sprite cannot be changed; make your own copy first"),
            );
        }
        SpriteOrigin::Recipe(recipe) => {
            let recipe = session.document.recipes.sprites.get(name).unwrap_or(&recipe).clone();
            match progress {
                Some((done, count)) => {
                    let text = format!("Baking frame {} of {count}", (done + 1).min(count));
                    ui.add(ProgressBar::new(done as f32 / count as f32).text(text));
                    // The bake does not request frames, so the progress bar does.
                    ui.ctx().request_repaint_after(Duration::from_millis(100));
                }
                None => {
                    ui.weak("Saved automatically").on_hover_text(WRITTEN);
                }
            }
            sprite_rows(ui, session, name, &recipe, is_broken.then_some("the recipe file has an error; fix it first"));
        }
        SpriteOrigin::Apart(_) => {
            ui.label(format!("The image does not match {file}: another program changed one of them."));
            let about = "Replaces the image by the one that the recipe makes";
            if ui.button("Bake recipe").on_hover_text(about).clicked() {
                known.adopt();
            }
            templates(ui, session);
        }
        SpriteOrigin::Simulated(recipe) => {
            let about = "Changes the simulation, with a preview that plays; the images are replaced when it is baked";
            if ui.button("Edit simulation").on_hover_text(about).clicked() {
                session.simulation.open(session.view.system, SimulationSource::Image(image), *recipe);
            }
            templates(ui, session);
        }
        SpriteOrigin::Painted => {
            if !is_broken {
                ui.label(format!("This sprite has no recipe ({file}), so it cannot be edited here."));
            }
            templates(ui, session);
        }
        SpriteOrigin::Missing => templates(ui, session),
    }
}

fn request_copy(session: &mut Session, name: &str) {
    let system = session.view.system;
    session.copy_request = Some(CopyRequest { system, name: name.into(), image: CopiedImage::Sprite });
}

/// Menus of built-in sprites to copy, and of simulations.
fn templates(ui: &mut Ui, session: &mut Session) {
    ui.horizontal(|ui| {
        let menu = ui.menu_button("New from template", |ui| {
            for template in builtin::SPRITES {
                if ui.button(template.name).clicked() {
                    request_copy(session, template.name);
                    ui.close();
                }
            }
        });
        menu.response.on_hover_text("Replaces this sprite by an editable copy of a built-in one");
        simulation_recipe::menu(ui, session);
    });
}

/// Draws the recipe of a sprite, and takes the changes.
fn sprite_rows(ui: &mut Ui, session: &mut Session, name: &str, recipe: &SpriteRecipe, locked: Option<&'static str>) {
    let edited = rows(ui, session, &TOOLTIPS, recipe, locked);
    if edited != *recipe {
        set_recipe(&mut session.document, name, edited);
        session.messages.clear("sprite");
    }
}
