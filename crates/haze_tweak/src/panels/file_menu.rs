//! File menu and its questions.

use std::path::Path;

use eframe::egui::{self, Key, Ui};
use haze_preset::backdrop_endings;

use crate::files::file_actions::FileActions;
use crate::platform::file_dialog::{Purpose, backdrop_title};
use crate::platform::{IS_PAGE, file_io};
use crate::session::Session;
use crate::session::action::{ACTIONS, Action};
use crate::session::messages::truncate_middle;

/// Shown above a path that is typed.
const NO_DIALOG: &str = "This system has no file dialog. Type the path.";

/// Draws the menu. Returns the chosen action.
pub fn menu(ui: &mut Ui, session: &mut Session) -> Option<Action> {
    let mut chosen = None;
    ui.menu_button("File", |ui| {
        let mut entry = |ui: &mut Ui, action: Action| {
            let Some(entry) = ACTIONS.iter().find(|entry| entry.action == action) else { return };
            let keys = ui.ctx().format_shortcut(&entry.keys);
            if ui.add(egui::Button::new(entry.name).shortcut_text(keys)).clicked() {
                chosen = Some(action);
                ui.close();
            }
        };
        entry(ui, Action::Presets);
        entry(ui, Action::Open);
        ui.separator();
        entry(ui, Action::Save);
        entry(ui, Action::SaveAs);
        let can_revert = session.document.is_dirty() && session.document.saved().is_some();
        let revert = ui.add_enabled(can_revert, egui::Button::new("Revert"));
        if revert.on_hover_text("Reloads the saved file. Undo restores your changes.").clicked() {
            session.revert();
            ui.close();
        }
        ui.separator();
        entry(ui, Action::Copy);
        entry(ui, Action::CopyLink);
        entry(ui, Action::Paste);
        ui.separator();
        entry(ui, Action::Screenshot);
        entry(ui, Action::Seeds);
        if !IS_PAGE {
            entry(ui, Action::EngineFlipbook);
        }
        entry(ui, Action::Export);
        if !IS_PAGE {
            ui.separator();
            if ui.button("Quit").clicked() {
                ui.ctx().send_viewport_cmd(egui::ViewportCommand::Close);
            }
        }
    });
    chosen
}

/// Asks about unsaved work, or for a path, while that is needed.
pub fn questions(ui: &Ui, file_actions: &mut FileActions, session: &mut Session) {
    if file_actions.waiting.is_some() {
        unsaved(ui, file_actions, session);
    }
    if file_actions.typed.is_some() {
        type_path(ui, file_actions, session);
    }
}

fn unsaved(ui: &Ui, file_actions: &mut FileActions, session: &mut Session) {
    let mut answer = None;
    let response = egui::Modal::new(egui::Id::unique("unsaved")).show(ui.ctx(), |ui| {
        ui.heading(format!("Save changes to {}?", truncate_middle(&session.document.file_name(), 60)));
        ui.add_space(8.0);
        ui.horizontal(|ui| {
            for (text, value) in [("Save", Some(true)), ("Don't Save", Some(false)), ("Cancel", None)] {
                if ui.button(text).clicked() {
                    answer = Some(value);
                }
            }
        });
    });
    if let Some(is_saved) = answer.or(response.should_close().then_some(None)) {
        file_actions.answer(is_saved, session);
        ui.ctx().request_repaint();
    }
}

fn type_path(ui: &Ui, file_actions: &mut FileActions, session: &mut Session) {
    let Some(typed) = &mut file_actions.typed else { return };
    let mut is_done = false;
    let response = egui::Modal::new(egui::Id::unique("path")).show(ui.ctx(), |ui| {
        ui.set_width(460.0);
        let (title, button) = match typed.purpose {
            Purpose::Open => ("Open", "Open"),
            Purpose::SaveAs if file_io::exists(Path::new(&typed.text)) => ("Save As", "Replace"),
            Purpose::SaveAs => ("Save As", "Save"),
            Purpose::Export if file_io::exists(Path::new(&typed.text)) => ("Export", "Replace"),
            Purpose::Export => ("Export", "Export"),
            Purpose::Backdrop(kind) => (backdrop_title(kind), "Show"),
        };
        ui.heading(title);
        ui.weak(if IS_PAGE { "The browser downloads the file." } else { NO_DIALOG });
        let hint = match typed.purpose {
            Purpose::Export => "Path to export to".to_owned(),
            Purpose::Backdrop(kind) => format!("Path of a .{} file", backdrop_endings(kind).join(" or .")),
            Purpose::Open | Purpose::SaveAs => "Path of a JSON file".to_owned(),
        };
        let edit = egui::TextEdit::singleline(&mut typed.text).hint_text(hint).desired_width(f32::INFINITY);
        let edit = ui.add(edit);
        edit.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Path"));
        edit.request_focus();
        if matches!(typed.purpose, Purpose::SaveAs | Purpose::Export) && !IS_PAGE {
            ui.weak(format!("In {}", truncate_middle(&folder_of(&typed.text), 80)));
        }
        // Enter alone does not replace an existing file.
        let is_entered = button != "Replace" && ui.input(|input| input.key_pressed(Key::Enter));
        is_done = ui.add_enabled(!typed.text.is_empty(), egui::Button::new(button)).clicked() || is_entered;
    });
    if is_done && !typed.text.is_empty() {
        let path = typed.text.clone();
        file_actions.finish_typing(Some(Path::new(&path)), session);
        ui.ctx().request_repaint();
    } else if response.should_close() {
        file_actions.finish_typing(None, session);
    }
}

/// Returns the folder of a file path.
fn folder_of(path: &str) -> String {
    let path = file_io::absolute(Path::new(path));
    path.parent().unwrap_or(&path).display().to_string()
}
