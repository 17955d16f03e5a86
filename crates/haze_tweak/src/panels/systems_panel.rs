//! List of systems: select, add, duplicate, rename, delete, move, mute and solo.

use eframe::egui::containers::menu::MenuButton;
use eframe::egui::{self, Button, Key, RichText, Sense, Ui, Vec2};
use haze_preset::MAX_SYSTEMS;
use haze_preset::layers::{Layer, layers};
use haze_preset::system_list::system_of;

use crate::session::Session;
use crate::session::first_run_hints::WindowPart;
use crate::session::view_options::Tab;

/// Edit that is made after the list is drawn.
enum Edit {
    Select(usize),
    Add(&'static Layer),
    Duplicate(usize),
    Remove(usize),
    Move(usize, usize),
    BeginRename(usize),
    /// `None`: the name stays.
    EndRename(usize, Option<String>),
}

/// Fraction of the panel's height that the list takes at most, and rows that it shows at least.
const MAX_FRACTION: f32 = 0.3;
const MIN_ROWS: f32 = 2.0;

/// Size of the image of a system, points.
const IMAGE: Vec2 = Vec2::new(36.0, 24.0);

/// Width of the buttons of a letter and of the button that adds a system; gap between them, points.
const LETTER: f32 = 22.0;
const ADD: f32 = 42.0;
const GAP: f32 = 3.0;

/// Draws the list, and selects the system of a setting that was searched for.
pub fn panel(ui: &mut Ui, session: &mut Session) {
    session.follow_systems();
    if let Some(index) = session.search.found.as_ref().and_then(|(path, _)| system_of(path)) {
        session.view.system = index.min(session.document.preset.systems.len().saturating_sub(1));
    }
    if session.view.tab == Tab::Light {
        return;
    }
    let count = session.document.preset.systems.len();
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing = Vec2::splat(GAP);
        // Narrow enough that the widths of buttons below hold their texts.
        ui.spacing_mut().button_padding.x = 4.0;
        if count == 0 {
            ui.horizontal(|ui| {
                ui.weak("No systems");
                let edit = add_button(ui, session);
                apply(session, edit);
            });
            return;
        }
        // Rows are as high as their images.
        ui.spacing_mut().interact_size.y = ui.spacing().interact_size.y.max(IMAGE.y);
        let row_height = ui.spacing().interact_size.y + GAP;
        let most = (MAX_FRACTION * ui.available_height()).max(MIN_ROWS * row_height);
        let area = egui::ScrollArea::vertical().id_salt("systems").max_height(most).auto_shrink([false, true]);
        let mut edit = None;
        area.show(ui, |ui| {
            if count as f32 * row_height > most {
                // Beside the scroll bar.
                ui.set_max_width(ui.available_width() - ui.spacing().scroll.bar_width);
            }
            for index in 0..count {
                let row = ui.horizontal(|ui| row(ui, session, index));
                edit = row.inner.or(edit.take());
                if session.view.systems.reveals_selected && index == session.view.system {
                    row.response.scroll_to_me(None);
                    session.view.systems.reveals_selected = false;
                }
            }
        });
        apply(session, edit);
    });
}

/// Draws a system. Returns the edit that is requested.
fn row(ui: &mut Ui, session: &mut Session, index: usize) -> Option<Edit> {
    let count = session.document.preset.systems.len();
    let name = session.document.preset.systems.get(index)?.name.clone();
    let is_selected = session.view.system == index;
    image(ui, session, index);
    let size =
        Vec2::new((ui.available_width() - 3.0 * LETTER - ADD - 4.0 * GAP).max(40.0), ui.spacing().interact_size.y);
    let mut edit = None;
    if session.view.systems.renaming.as_ref().is_some_and(|(renamed, _)| *renamed == index) {
        edit = name_field(ui, session, index, size);
    } else {
        let is_shown = session.view.systems.is_shown(&session.document.preset.systems, index);
        let text = if is_shown { RichText::new(&name) } else { RichText::new(&name).weak().strikethrough() };
        let button = ui.add_sized(size, Button::selectable(is_selected, text).truncate().right_text(""));
        let hidden = if is_shown { "" } else { "\nNot in the image." };
        let button = button.on_hover_text(format!("{name}{hidden}\n\nDouble-click to rename. Right-click for more."));
        let button = button.accessible_name(format!("System {name}"));
        if button.double_clicked() {
            edit = Some(Edit::BeginRename(index));
        } else if button.clicked() {
            edit = Some(Edit::Select(index));
        }
        button.context_menu(|ui| edit = entries(ui, index, count).or(edit.take()));
    }
    mute_and_solo(ui, session, index, &name);
    let button = Button::new("…").min_size(Vec2::new(LETTER, size.y));
    let (button, chosen) = MenuButton::from_button(button).ui(ui, |ui| entries(ui, index, count));
    button.on_hover_text("Rename, duplicate, move or delete").accessible_name(format!("Edit {name}"));
    edit = chosen.and_then(|chosen| chosen.inner).or(edit);
    if is_selected {
        edit = add_button(ui, session).or(edit);
    }
    edit
}

/// Draws the image of a system alone.
fn image(ui: &mut Ui, session: &Session, index: usize) {
    let (rect, _) = ui.allocate_exact_size(IMAGE, Sense::hover());
    let corner = ui.visuals().widgets.inactive.corner_radius;
    match session.view.systems.images.get(index).copied().flatten() {
        Some(texture) => {
            let image = egui::Image::new(egui::load::SizedTexture::new(texture, IMAGE));
            let tint = if session.view.systems.is_shown(&session.document.preset.systems, index) { 1.0 } else { 0.3 };
            image.corner_radius(corner).tint(egui::Color32::WHITE.gamma_multiply(tint)).paint_at(ui, rect);
        }
        None => _ = ui.painter().rect_filled(rect, corner, ui.visuals().extreme_bg_color),
    }
}

/// Draws the field in which a name is typed.
fn name_field(ui: &mut Ui, session: &mut Session, index: usize, size: Vec2) -> Option<Edit> {
    let (_, text) = session.view.systems.renaming.as_mut()?;
    let field = ui.add_sized(size, egui::TextEdit::singleline(text));
    let field = field.accessible_name("Name of the system");
    if field.lost_focus() {
        // Escape, which the window has taken, leaves the name.
        let is_done = ui.input(|input| {
            [Key::Enter, Key::Tab].iter().any(|key| input.key_pressed(*key))
                || input.pointer.any_pressed()
                || input.pointer.any_released()
        });
        return Some(Edit::EndRename(index, is_done.then(|| text.clone())));
    }
    field.request_focus();
    None
}

/// Draws the buttons that hide systems in the image.
fn mute_and_solo(ui: &mut Ui, session: &mut Session, index: usize, name: &str) {
    let systems = &session.document.preset.systems;
    let before = session.view.systems.flags_of(systems, index);
    let mut flags = before;
    let size = Vec2::new(LETTER, ui.spacing().interact_size.y);
    let mut toggle = |letter: &str, is_on: &mut bool, what: &str| {
        let button = ui.add_sized(size, Button::selectable(*is_on, letter));
        let button = button.on_hover_text(format!("{what}. The preset does not change, and exports draw all systems."));
        if button.accessible_name(format!("{what}: {name}")).clicked() {
            *is_on = !*is_on;
        }
    };
    toggle("S", &mut flags.is_solo, "Solo: show only this system");
    toggle("M", &mut flags.is_muted, "Mute: hide this system");
    if flags != before {
        *session.view.systems.mute_solo(systems, index) = flags;
    }
}

/// Draws the entries of a system's menu.
fn entries(ui: &mut Ui, index: usize, count: usize) -> Option<Edit> {
    let mut chosen = None;
    let mut entry = |ui: &mut Ui, name: &str, is_enabled: bool, edit: Edit| {
        if ui.add_enabled(is_enabled, Button::new(name)).clicked() {
            chosen = Some(edit);
            ui.close();
        }
    };
    entry(ui, "Rename", true, Edit::BeginRename(index));
    entry(ui, "Duplicate", count < MAX_SYSTEMS, Edit::Duplicate(index));
    entry(ui, "Move Up", index > 0, Edit::Move(index, index.saturating_sub(1)));
    entry(ui, "Move Down", index + 1 < count, Edit::Move(index, index + 1));
    ui.separator();
    entry(ui, "Delete", true, Edit::Remove(index));
    chosen
}

/// Draws the button with the shelf of layers.
fn add_button(ui: &mut Ui, session: &mut Session) -> Option<Edit> {
    let is_full = session.document.preset.systems.len() >= MAX_SYSTEMS;
    let button = Button::new("Add").min_size(Vec2::new(ADD, ui.spacing().interact_size.y));
    let (button, chosen) = ui.add_enabled_ui(!is_full, |ui| MenuButton::from_button(button).ui(ui, shelf)).inner;
    session.hints.record_rect(WindowPart::AddSystem, button.rect);
    let button = button.on_hover_text("Add a system: smoke, flame, sparks …");
    button.on_disabled_hover_text(format!("A preset has at most {MAX_SYSTEMS} systems")).accessible_name("Add system");
    chosen.and_then(|chosen| chosen.inner).map(Edit::Add)
}

/// Width of the shelf, points.
const SHELF: f32 = 250.0;

/// Draws the layers, each with its description.
fn shelf(ui: &mut Ui) -> Option<&'static Layer> {
    let mut chosen = None;
    let most = ui.ctx().content_rect().height() - 24.0;
    ui.set_max_width(SHELF.min(ui.ctx().content_rect().width() - 24.0));
    egui::ScrollArea::vertical().max_height(most).show(ui, |ui| {
        for layer in layers() {
            let mut text = egui::text::LayoutJob::default();
            let style = ui.style();
            let lines = [RichText::new(format!("{}\n", layer.title)), RichText::new(&layer.description).small()];
            for line in lines {
                line.append_to(&mut text, style, egui::FontSelection::Default, egui::Align::Min);
            }
            let button = ui.add(Button::new(text).wrap());
            if button.accessible_name(&layer.title).clicked() {
                chosen = Some(layer);
                ui.close();
            }
        }
    });
    chosen
}

fn apply(session: &mut Session, edit: Option<Edit>) {
    match edit {
        Some(Edit::Select(index)) => session.view.system = index,
        Some(Edit::Add(layer)) => session.add_layer(layer),
        Some(Edit::Duplicate(index)) => session.duplicate_system(index),
        Some(Edit::Remove(index)) => session.remove_system(index),
        Some(Edit::Move(from, to)) => session.move_system(from, to),
        Some(Edit::BeginRename(index)) => {
            let name = session.document.preset.systems.get(index).map(|system| system.name.clone());
            session.view.systems.renaming = name.map(|name| (index, name));
        }
        Some(Edit::EndRename(index, name)) => {
            session.view.systems.renaming = None;
            if let Some(name) = name {
                session.rename_system(index, &name);
            }
        }
        None => {}
    }
}

#[cfg(test)]
mod tests;
