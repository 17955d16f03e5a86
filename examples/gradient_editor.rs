//! The editor of gradients in a window of its own: give it a `*.ramp.json` to begin with. It changes no file; Copy gives its stops as
//! text.

use std::path::PathBuf;

use eframe::egui;
use haze::gradient_editor::{GradientEditor, Surroundings};
use haze::ramp::bake::RampRecipe;
use haze::ramp::template::TEMPLATES;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let recipe = match std::env::args_os().nth(1) {
        Some(path) => RampRecipe::load(&PathBuf::from(path))?,
        None => TEMPLATES[1].recipe(),
    };
    let app =
        App { editor: GradientEditor::default(), recipe: recipe.clone(), past: vec![recipe], said: String::new() };
    eframe::run_native("gradient editor", eframe::NativeOptions::default(), Box::new(|_| Ok(Box::new(app))))?;
    Ok(())
}

struct App {
    editor: GradientEditor,
    recipe: RampRecipe,
    /// The recipe after each step.
    past: Vec<RampRecipe>,
    said: String,
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        if ui.input_mut(|input| input.consume_key(egui::Modifiers::COMMAND, egui::Key::Z)) && self.past.len() > 1 {
            self.past.pop();
            self.recipe = self.past[self.past.len() - 1].clone();
        }
        egui::CentralPanel::default().show(ui, |ui| {
            let surroundings = Surroundings { blend: self.recipe.blend, ..Surroundings::default() };
            let edited = self.editor.show(ui, &mut self.recipe.rows[0], &surroundings);
            if let Some(step) = edited.committed {
                self.past.push(self.recipe.clone());
                self.said = format!("{step}; Ctrl+Z takes it back");
            }
            self.said = edited.refused.unwrap_or(std::mem::take(&mut self.said));
            ui.label(&self.said);
        });
    }
}
