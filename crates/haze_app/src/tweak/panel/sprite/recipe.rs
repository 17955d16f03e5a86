//! The recipe of a sprite as rows, and how a sprite without gets one.

use std::collections::HashSet;
use std::ops::RangeInclusive;
use std::sync::LazyLock;

use eframe::egui::{ProgressBar, Ui};
use glam::Vec3;
use haze::builtin;
use haze::preset::MaterialNames;
use haze::settings::{FieldVisitor, Fields};
use haze_author::preset::Tooltips;
use haze_author::sprite::bake::SpriteRecipe;

use crate::tweak::messages::short;
use crate::tweak::panel::fields::{self, Desk};
use crate::tweak::platform::clock::Duration;
use crate::tweak::session::Session;
use crate::tweak::sprite::files::set_recipe;
use crate::tweak::sprite::source::Source;

static TOOLTIPS: LazyLock<Tooltips> = LazyLock::new(Tooltips::of::<SpriteRecipe>);

/// What is said of all that is changed here.
const WRITTEN: &str = "Seen at once, coarsely; baked whole when it is let go. Then the recipe and its PNGs are written, and again when \
                       it is undone";

/// Most characters of what is said.
const LONGEST: usize = 400;

/// Draws what there is of the selected system's sprite.
pub fn panel(ui: &mut Ui, session: &mut Session, names: &MaterialNames) {
    let (folders, wake) = (session.folders(), session.wake.clone());
    let Some(known) = session.sprites.ask(names, &folders, move || wake.call()) else { return };
    if let Some(broken) = &known.broken {
        ui.colored_label(ui.visuals().error_fg_color, short(broken, LONGEST));
    }
    for finding in &known.findings {
        ui.colored_label(ui.visuals().warn_fg_color, short(finding, LONGEST));
    }
    let file = known.recipe_file();
    let file = short(&file.file_name().unwrap_or_default().to_string_lossy(), 60);
    let (source, is_broken) = (known.source.clone(), known.broken.is_some());
    let progress = known.whole.as_ref().map(|order| (order.frames(), order.recipe.frame_count()));
    let name = &names.sprite;
    match source {
        Source::Reading => {
            ui.weak("It is being read.");
        }
        Source::BuiltIn(recipe) => {
            let about = "Writes a copy of this sprite and its recipe beside the preset, to be changed here; a preset that is \
                         built in is saved first";
            if ui.button("Make my own").on_hover_text(about).clicked() {
                session.sprites.want_own(session.show.system, name, session.document.is_built_in());
            }
            rows(ui, session, name, &recipe, Some("make your own first"));
        }
        Source::Recipe(recipe) => {
            let recipe = session.document.recipes.sprites.get(name).unwrap_or(&recipe).clone();
            match progress {
                Some((done, count)) => {
                    let text = format!("Baking frame {} of {count}", (done + 1).min(count));
                    ui.add(ProgressBar::new(done as f32 / count as f32).text(text));
                    // Frames are told to no one.
                    ui.ctx().request_repaint_after(Duration::from_millis(100));
                }
                None => {
                    ui.weak("Saved with each step").on_hover_text(WRITTEN);
                }
            }
            rows(ui, session, name, &recipe, is_broken.then_some("mend its file first"));
        }
        Source::Apart(_) => {
            ui.label(format!("{file} makes another picture: one of the two was changed elsewhere."));
            let about = "Puts what the recipe makes in the place of the picture";
            if ui.button("Bake the recipe").on_hover_text(about).clicked() {
                known.adopt();
            }
            templates(ui, session);
        }
        Source::Painted => {
            if !is_broken {
                ui.label(format!("There is no recipe: {file} is not beside it."));
            }
            templates(ui, session);
        }
        Source::Missing => templates(ui, session),
    }
}

/// Copies of built-in sprites to begin with.
fn templates(ui: &mut Ui, session: &mut Session) {
    let menu = ui.menu_button("New from template", |ui| {
        for template in builtin::SPRITES {
            if ui.button(template.name).clicked() {
                session.sprites.want_own(session.show.system, template.name, session.document.is_built_in());
                ui.close();
            }
        }
    });
    menu.response
        .on_hover_text("Writes a copy of a built-in sprite and its recipe beside the preset, in place of this one");
}

/// The fields of a recipe, by its own table. `locked`: why none can be changed.
fn rows(ui: &mut Ui, session: &mut Session, name: &str, recipe: &SpriteRecipe, locked: Option<&'static str>) {
    let (mut edited, mut within) = (recipe.clone(), Within::default());
    edited.visit(&mut within);
    let inert = |path: &str| locked.or(within.zero.contains(path).then_some("version 1 cannot do it"));
    let (unchanged, asked) = (HashSet::new(), Vec::new());
    let mut desk = Desk {
        tooltips: &TOOLTIPS,
        thumbnails: &session.thumbnails,
        changed: &unchanged,
        second: None,
        has_sheets: false,
        inert: &inert,
        asked,
        refused: None,
        sought: None,
    };
    if locked.is_none() && edited.version < 2 {
        let about = "Bakes some fifty times as fast, and can do more; what it shows changes a little";
        ui.horizontal(|ui| {
            ui.weak("Version 1 is slow to bake.");
            if ui.button("Convert to version 2").on_hover_text(about).clicked() {
                edited.version = 2;
            }
        });
    }
    fields::show(ui, &mut desk, &[], &mut edited);
    let refused = desk.refused;
    // Ranges may depend on what was changed.
    edited.visit(&mut Within::default());
    if edited != *recipe {
        set_recipe(&mut session.document, name, edited);
        session.messages.withdraw("sprite");
    }
    if let Some(refused) = refused {
        session.messages.complain("typed", refused);
    }
}

/// Brings numbers into their ranges, and notes those that can be 0 only.
#[derive(Default)]
struct Within {
    zero: HashSet<&'static str>,
}

impl Within {
    fn see<T: PartialOrd + Copy + Default>(&mut self, name: &'static str, value: &mut T, range: &RangeInclusive<T>) {
        if *range.end() <= T::default() {
            self.zero.insert(name);
        }
        if *value > *range.end() {
            *value = *range.end();
        }
        if *value < *range.start() {
            *value = *range.start();
        }
    }
}

impl FieldVisitor for Within {
    fn number(&mut self, name: &'static str, value: &mut f32, range: RangeInclusive<f32>, _: &'static str) {
        self.see(name, value, &range);
    }

    fn integer(&mut self, name: &'static str, value: &mut u32, range: RangeInclusive<u32>, _: &'static str) {
        self.see(name, value, &range);
    }

    fn vector(&mut self, _: &'static str, _: &mut Vec3, _: RangeInclusive<f32>, _: &'static str) {}

    fn group(&mut self, _: &'static str, fields: &mut dyn Fields) {
        fields.visit(self);
    }

    fn item(&mut self, _: &'static str, _: usize, fields: &mut dyn Fields) {
        fields.visit(self);
    }
}
