//! What can be set, at the right of the window: the look first, then the parts of the preset.

use eframe::egui::{self, Ui};
use haze::preset::Preset;
use haze::settings::{Fields, path_of};

use super::fields::{self, Desk};
use super::{curve, lights, look, ramps};
use crate::app::tweak::messages::short;
use crate::app::tweak::session::Session;
use crate::app::tweak::show::Tab;

/// The tabs, their names, and what is on them.
pub const TABS: [(Tab, &str, &str); 6] = [
    (Tab::Look, "Look", "The few controls that make a look"),
    (Tab::Light, "Light", "Lights, the sky, the camera"),
    (Tab::Smoke, "Smoke", "Where smoke comes from, and how it takes light"),
    (Tab::Ramps, "Ramps", "What smoke is lit from, and which part of it this picture looks up"),
    (Tab::Advanced, "Advanced", "How smoke reaches the picture: techniques, targets, formats"),
    (Tab::Performance, "Cost", "What the picture costs, and a budget for it"),
];

pub fn panel(ui: &mut Ui, session: &mut Session) {
    ui.horizontal(|ui| {
        for (tab, name, tooltip) in TABS {
            ui.selectable_value(&mut session.show.tab, tab, name).on_hover_text(tooltip);
        }
    });
    if session.show.tab == Tab::Performance {
        ui.separator();
        return super::performance::panel(ui, session);
    }
    let systems = session.document.preset.systems.len();
    session.show.system = session.show.system.min(systems.saturating_sub(1));
    if let Some(index) = session.search.found.as_ref().and_then(|(path, _)| system_of(path)) {
        session.show.system = index;
    }
    if systems > 1 && session.show.tab != Tab::Light {
        ui.horizontal_wrapped(|ui| {
            for (index, system) in session.document.preset.systems.iter().enumerate() {
                ui.selectable_value(&mut session.show.system, index, short(&system.name, 30));
            }
        });
    }
    ui.separator();
    let (time, mut shown) = (session.playback.time, std::mem::take(&mut session.show.lights));
    session.thumbnails.follow(session.document.path());
    let mut desk = Desk {
        tooltips: &session.tooltips,
        thumbnails: &session.thumbnails,
        changed: session.changed(),
        inert: &|path| session.document.preset.without_effect(path, session.show.size),
        reset: Vec::new(),
        refused: None,
        sought: session.search.found.as_ref().map(|(path, _)| path.as_str()),
    };
    // Panels change a copy: the desk reads the session meanwhile.
    let mut edited = session.document.preset.clone();
    let preset = &mut edited;
    let system = session.show.system;
    let mut spot = None;
    egui::ScrollArea::vertical().id_salt(session.show.tab).auto_shrink(false).show(ui, |ui| match session.show.tab {
        Tab::Look => look::panel(ui, &mut desk, preset, system),
        Tab::Light => {
            lights::panel(ui, &mut desk, preset, &mut shown, time);
            ui.separator();
            surroundings(ui, &mut desk, preset);
        }
        Tab::Smoke => smoke(ui, &mut desk, preset, system),
        Tab::Ramps => spot = ramps::panel(ui, session, system),
        Tab::Advanced => advanced(ui, &mut desk, preset, system),
        Tab::Performance => {}
    });
    let Desk { reset, refused, .. } = desk;
    session.document.preset = edited;
    session.show.lights = shown;
    session.inspect.spot = spot;
    reset.iter().for_each(|path| session.set_back(path));
    if let Some(refused) = refused {
        session.messages.complain("typed", refused);
    }
}

/// The system that a setting belongs to: 1 of `systems[1].settings.boost`.
fn system_of(path: &str) -> Option<usize> {
    path.strip_prefix("systems[")?.split_once(']')?.0.parse().ok()
}

/// A part of the preset that folds.
fn section(ui: &mut Ui, desk: &mut Desk<'_>, title: &str, path: &[fields::Step], fields: &mut dyn Fields) {
    let is_sought = desk.sought.is_some_and(|sought| sought.starts_with(&path_of(path)));
    let header = egui::CollapsingHeader::new(title).id_salt(path).default_open(true);
    let header = if is_sought { header.open(Some(true)) } else { header };
    header.show(ui, |ui| fields::show(ui, desk, path, fields));
}

fn surroundings(ui: &mut Ui, desk: &mut Desk<'_>, preset: &mut Preset) {
    section(ui, desk, "Sky and scene", &[("environment", None)], &mut preset.environment);
    section(ui, desk, "Camera", &[("camera", None)], &mut preset.camera);
}

fn smoke(ui: &mut Ui, desk: &mut Desk<'_>, preset: &mut Preset, index: usize) {
    let Some(system) = preset.systems.get_mut(index) else { return };
    let at = ("systems", Some(index));
    section(ui, desk, "Emitter", &[at, ("emitter", None)], &mut system.emitter);
    section(ui, desk, "Sprite and ramps", &[at, ("material", None)], &mut system.material);
    let settings = &mut system.settings;
    let at = |name| [at, ("settings", None), (name, None)];
    section(ui, desk, "Diffuse", &at("diffuse"), &mut settings.diffuse);
    section(ui, desk, "Soft scatter", &at("soft_scatter"), &mut settings.soft_scatter);
    section(ui, desk, "Specular scatter", &at("specular_scatter"), &mut settings.specular_scatter);
    section(ui, desk, "Soft fade", &at("soft_fade"), &mut settings.soft_fade);
    curve::panel(ui, &settings.soft_fade);
}

fn advanced(ui: &mut Ui, desk: &mut Desk<'_>, preset: &mut Preset, index: usize) {
    let Some(system) = preset.systems.get_mut(index) else { return };
    let at = [("systems", Some(index)), ("settings", None)];
    fields::show(ui, desk, &at, &mut system.settings);
}

#[cfg(test)]
mod tests {
    use eframe::egui::{Role, Theme, Vec2};
    use egui_kittest::kittest::{NodeT as _, Queryable as _};
    use egui_kittest::{Harness, Node};

    use crate::app::tweak::testing::window;
    use crate::app::tweak::window::Window;

    fn control<'h>(harness: &'h Harness<'_, Window>, name: &'h str) -> Node<'h> {
        harness.get_all_by_label(name).find(|node| node.accesskit_node().role() == Role::ComboBox).unwrap()
    }

    #[test]
    fn a_control_without_effect_is_grey_and_says_why() {
        let mut harness = window("column", Vec2::new(1000.0, 640.0), Theme::Dark);
        harness.get_by_label("Advanced").click();
        harness.run_steps(3);
        let is_grey = |name| control(&harness, name).accesskit_node().is_disabled();
        assert!(is_grey("blend mode") && !is_grey("technique"));
        // Its name stands at its left.
        let place = control(&harness, "blend mode").rect().left_center();
        harness.hover_at(place - Vec2::new(80.0, 0.0));
        harness.run_steps(8);
        assert!(harness.query_all_by_label_contains("No effect here: forward only.").next().is_some());
    }
}
