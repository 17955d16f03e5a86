//! Shows haze's gradient editor in its own window. Takes the path of a `*.ramp.json` to start with. Changes no file:
//! *Copy* copies the stops as text.

use std::path::PathBuf;

use eframe::egui;
use egui_gradient::{DisplayOptions, GradientEditor};
use haze_author::ramp::RampRecipe;
use haze_author::ramp::template::TEMPLATES;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let recipe = match std::env::args_os().nth(1) {
        Some(path) => RampRecipe::load(&PathBuf::from(path))?,
        None => TEMPLATES[1].recipe(),
    };
    let app = App { recipe, ..App::default() };
    eframe::run_native("gradient editor", eframe::NativeOptions::default(), Box::new(|_| Ok(Box::new(app))))?;
    Ok(())
}

/// Name of an undo step, and the recipe to restore.
type Step = (&'static str, RampRecipe);

#[derive(Default)]
struct App {
    editor: GradientEditor,
    recipe: RampRecipe,
    /// Recipe before the edit that is in progress.
    before: Option<RampRecipe>,
    past: Vec<Step>,
    future: Vec<Step>,
    refused: String,
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        egui::CentralPanel::default().show(ui, |ui| {
            ui.horizontal(|ui| {
                let redo = egui::Modifiers::COMMAND | egui::Modifiers::SHIFT;
                step(ui, "Redo", redo, &mut self.future, &mut self.past, &mut self.recipe);
                step(ui, "Undo", egui::Modifiers::COMMAND, &mut self.past, &mut self.future, &mut self.recipe);
            });
            let before = self.recipe.clone();
            let options = DisplayOptions { blend: self.recipe.blend, ..DisplayOptions::default() };
            let edited = self.editor.show(ui, &mut self.recipe.rows[0], &options);
            if edited.is_changed {
                self.before.get_or_insert(before);
                self.refused.clear();
            }
            if let (Some(step), Some(before)) = (edited.committed, self.before.take_if(|_| edited.committed.is_some()))
            {
                self.past.push((step, before));
                self.future.clear();
            }
            self.refused = edited.refused.unwrap_or(std::mem::take(&mut self.refused));
            ui.label(&self.refused);
        });
    }
}

/// Shows the *Undo* or *Redo* button; moves one step from `from` to `to` when it is clicked or its shortcut is pressed.
fn step(
    ui: &mut egui::Ui,
    name: &str,
    keys: egui::Modifiers,
    from: &mut Vec<Step>,
    to: &mut Vec<Step>,
    recipe: &mut RampRecipe,
) {
    let text = from.last().map_or(name.to_owned(), |(step, _)| format!("{name} {step}"));
    let is_clicked = ui.add_enabled(!from.is_empty(), egui::Button::new(text)).clicked();
    let is_pressed = ui.input_mut(|input| input.consume_key(keys, egui::Key::Z));
    if let Some((step, other)) = (is_clicked || is_pressed).then(|| from.pop()).flatten() {
        to.push((step, std::mem::replace(recipe, other)));
    }
}
