//! Settings panel at the right of the window: the look first, then the parts of the preset.

use eframe::egui::{self, Ui};
use haze_author::backdrop::{BLENDER_SKY_ROTATION, Backdrop};
use haze_author::particle_files::{ParticleFrames, unused_columns};
use haze_core::settings::{Fields, field_path};
use haze_preset::Preset;

use super::rows::key_mark::KeyMarks;
use super::rows::setting_rows::{FieldStep, RowContext, is_at};
use super::rows::{RowRequest, setting_rows, soft_fade_plot};
use super::{lights_panel, look_panel, narrow, ramps_panel, sprite_panel, sun_panel, systems_panel};
use crate::document::display_names::display_name;
use crate::session::Session;
use crate::session::first_run_hints::WindowPart;
use crate::session::setting_search::SMOKE_TAB_GROUPS;
use crate::session::view_options::Tab;

/// Tabs with their names and tooltips.
pub const TABS: [(Tab, &str, &str); 7] = [
    (Tab::Look, "Look", "The controls that shape the look"),
    (Tab::Light, "Light", "Lights, sky, scene and camera"),
    (Tab::Smoke, "Smoke", "Emitter, material and lighting of the smoke"),
    (Tab::Ramps, "Ramps", "Ramps: the gradients that color and light the smoke"),
    (Tab::Sprite, "Sprite", "The animated image of each particle, and its recipe"),
    (
        Tab::Advanced,
        "Advanced",
        "How the smoke is drawn. Technique: how sprites meet surfaces. Path: how they are blended. Six-way: light maps in place of normals.",
    ),
    (Tab::Performance, "Cost", "GPU time and memory, and a time budget"),
];

/// Draws the panel. Returns the path of a field if a sheet of its values is requested.
pub fn panel(ui: &mut Ui, session: &mut Session) -> Option<String> {
    tab_row(ui, session);
    // Some tabs have no list of systems.
    session.hints.record_rect(WindowPart::AddSystem, egui::Rect::NOTHING);
    if session.view.tab == Tab::Performance {
        ui.separator();
        super::performance_panel::panel(ui, session);
        return None;
    }
    systems_panel::panel(ui, session);
    ui.separator();
    session.inspect.ramp_position = None;
    session.thumbnails.follow(session.document.path(), session.assets.as_deref());
    if session.view.tab == Tab::Ramps {
        let area = egui::ScrollArea::vertical().id_salt(session.view.tab).auto_shrink(false);
        let system = session.view.system;
        let shown = area.show(ui, |ui| {
            // Keeps the handle of the last stop beside the scroll bar.
            ui.set_max_width(ui.available_width() - ui.spacing().scroll.bar_width);
            ramps_panel::panel(ui, session, system)
        });
        session.inspect.ramp_position = shown.inner;
        return None;
    }
    if session.view.tab == Tab::Sprite {
        sprite_panel::panel(ui, session);
        return None;
    }
    setting_tab(ui, session)
}

fn tab_row(ui: &mut Ui, session: &mut Session) {
    let tabs = |ui: &mut Ui| {
        // Small gaps, so that all tabs also fit into a narrow panel.
        ui.spacing_mut().item_spacing.x = 3.0;
        ui.spacing_mut().button_padding.x = 5.0;
        for (tab, name, tooltip) in TABS {
            let button = ui.selectable_value(&mut session.view.tab, tab, name).on_hover_text(tooltip);
            if tab == Tab::Ramps {
                session.hints.record_rect(WindowPart::RampsTab, button.rect);
            }
        }
    };
    if narrow::is_narrow(ui.ctx()) {
        narrow::row(ui, "tabs", tabs);
    } else {
        ui.horizontal_wrapped(tabs);
    }
}

/// Draws a tab of rows of settings, and runs their requests. Returns the path of a field if a sheet of its values is
/// requested.
fn setting_tab(ui: &mut Ui, session: &mut Session) -> Option<String> {
    let edit = session.begin_edit();
    let mut shown = std::mem::take(&mut session.view.lights);
    let keys = KeyMarks::new(&session.document.preset, session.playback.key_time());
    let mut smoke_shown = std::mem::take(&mut session.smoke);
    if session.view.tab == Tab::Light {
        session.measure(&mut smoke_shown);
    }
    let mut context = RowContext {
        tooltips: &session.tooltips,
        thumbnails: &session.thumbnails,
        changed: session.changed(),
        reason_without_effect: &|path| session.no_effect_reason(&session.document.preset, path),
        second: session.second_diff(),
        has_sheets: true,
        keys: Some(&keys),
        requests: Vec::new(),
        refused: None,
        searched_path: session.search.found.as_ref().map(|(path, _)| path.as_str()),
    };
    let backdrop = session.backdrop.of(&session.document.preset);
    let frames = session.particle_frames();
    // Panels change a copy, because the rows borrow the session.
    let mut edited = session.document.preset.clone();
    let preset = &mut edited;
    let system = session.view.system;
    egui::ScrollArea::vertical().id_salt(session.view.tab).auto_shrink(false).show(ui, |ui| match session.view.tab {
        Tab::Look => look_panel::panel(ui, &mut context, preset, &mut shown, system),
        Tab::Light => {
            sun_panel::panel(ui, &mut context, preset, &mut shown, smoke_shown.bounds().center());
            ui.separator();
            lights_panel::panel(ui, &mut context, preset, &mut shown, &smoke_shown, session.view.size);
            ui.separator();
            surroundings(ui, &mut context, preset, &backdrop);
        }
        Tab::Smoke => smoke(ui, &mut context, preset, system, frames.get(system).and_then(Option::as_ref)),
        Tab::Advanced => advanced(ui, &mut context, preset, system),
        Tab::Ramps | Tab::Sprite | Tab::Performance => {}
    });
    let RowContext { requests, refused, .. } = context;
    let is_edited = session.document.preset != edited;
    session.document.preset = edited;
    session.end_edit(edit);
    session.view.lights = shown;
    session.smoke = smoke_shown;
    session.report_refused_input(refused, is_edited);
    let mut sheet = None;
    for (request, path) in requests {
        match request {
            RowRequest::Reset => session.reset_field(&path),
            RowRequest::CopySecond => session.copy_from_second(&path),
            RowRequest::Sheet => sheet = Some(path),
            RowRequest::Key => session.toggle_key(&path),
            RowRequest::RemoveKeys => session.remove_track(&path),
            RowRequest::ChooseBackdrop(kind) => session.backdrop_request = Some(kind),
        }
    }
    sheet
}

/// Draws a collapsible part of the preset. Returns true if it is open.
fn section(
    ui: &mut Ui,
    context: &mut RowContext<'_>,
    path: &[FieldStep],
    is_open: bool,
    fields: &mut dyn Fields,
) -> bool {
    let whole = field_path(path);
    let title = path.last().map(|(name, _)| display_name(name)).unwrap_or_default();
    let header =
        setting_rows::header(context, &title, &|field| is_at(field, &whole)).id_salt(path).default_open(is_open);
    header.show(ui, |ui| setting_rows::show(ui, context, path, fields)).fully_open()
}

fn surroundings(ui: &mut Ui, context: &mut RowContext<'_>, preset: &mut Preset, backdrop: &Backdrop) {
    section(ui, context, &[("environment", None)], true, &mut preset.environment);
    if let Some(scene) = backdrop.mesh() {
        ui.label(egui::RichText::new(format!("The scene file has {}.", scene.description())).weak());
        ui.horizontal_wrapped(|ui| {
            let button = |ui: &mut Ui, name, is_there, tooltip| {
                let button = ui.add_enabled(is_there, egui::Button::new(name));
                button.on_hover_text(tooltip).clicked()
            };
            if let [_, _, ..] = &scene.cameras[..] {
                let menu = ui.menu_button("Use its camera", |ui| {
                    for camera in &scene.cameras {
                        if ui.button(&camera.name).clicked() {
                            backdrop.take_camera(Some(&camera.name), preset);
                        }
                    }
                });
                menu.response.on_hover_text("Replaces the camera of the preset by one of the file");
            } else {
                let has_camera = !scene.cameras.is_empty();
                if button(ui, "Use its camera", has_camera, "Replaces the camera of the preset") {
                    backdrop.take_camera(None, preset);
                }
            }
            let has_lights = !scene.lights.is_empty();
            if button(ui, "Use its lights", has_lights, "Replaces the lights of the preset") {
                backdrop.take_lights(preset);
            }
        });
    }
    if backdrop.sky.is_some() {
        let button = ui.button("Sky from Blender");
        let tooltip = "Turns the sky to where it is in Blender, as the world of a scene that was exported as glTF";
        if button.on_hover_text(tooltip).clicked() {
            preset.environment.sky_rotation = BLENDER_SKY_ROTATION;
        }
    }
    section(ui, context, &[("camera", None)], true, &mut preset.camera);
}

fn smoke(
    ui: &mut Ui,
    context: &mut RowContext<'_>,
    preset: &mut Preset,
    index: usize,
    frames: Option<&ParticleFrames>,
) {
    let unused = frames.map(|frames| unused_columns(preset, index, frames)).unwrap_or_default();
    let Some(system) = preset.systems.get_mut(index) else { return };
    let at = ("systems", Some(index));
    section(ui, context, &[at, ("emitter", None)], true, &mut system.emitter);
    section(ui, context, &[at, ("particle_files", None)], false, &mut system.particle_files);
    for note in unused {
        ui.label(egui::RichText::new(note).weak());
    }
    section(ui, context, &[at, ("material", None)], false, &mut system.material);
    let settings = &mut system.settings;
    let at = |name| [at, ("settings", None), (name, None)];
    section(ui, context, &at("grain"), false, &mut settings.grain);
    section(ui, context, &at("diffuse"), false, &mut settings.diffuse);
    section(ui, context, &at("shadow"), false, &mut settings.shadow);
    section(ui, context, &at("ambient"), false, &mut settings.ambient);
    section(ui, context, &at("fire"), false, &mut settings.fire);
    section(ui, context, &at("soft_scatter"), false, &mut settings.soft_scatter);
    section(ui, context, &at("specular_scatter"), false, &mut settings.specular_scatter);
    if section(ui, context, &at("soft_fade"), false, &mut settings.soft_fade) {
        soft_fade_plot::panel(ui, &settings.soft_fade);
    }
}

/// Groups of settings that only programmers need.
const FOR_PROGRAMMERS: [&str; 3] = ["path", "accumulate", "debug"];

fn advanced(ui: &mut Ui, context: &mut RowContext<'_>, preset: &mut Preset, index: usize) {
    let Some(system) = preset.systems.get_mut(index) else { return };
    let at = [("systems", Some(index)), ("settings", None)];
    let is_last = |name: &str| FOR_PROGRAMMERS.contains(&name);
    setting_rows::show_where(ui, context, &at, &mut system.settings, &|name| {
        !is_last(name) && !SMOKE_TAB_GROUPS.contains(&name)
    });
    setting_rows::show_where(ui, context, &at, &mut system.settings, &is_last);
}

#[cfg(test)]
mod tests {
    use eframe::egui::{Role, Theme, Vec2};
    use egui_kittest::kittest::{NodeT as _, Queryable as _};
    use egui_kittest::{Harness, Node};
    use haze_core::settings::{FieldValue, RenderPath};

    use crate::document::display_names::display_name;
    use crate::panels::rows::value_text::shown_value;
    use crate::session::comparison::CompareWith;
    use crate::window::Window;
    use crate::window::testing::{row_menu, window};

    fn control<'h>(harness: &'h Harness<'_, Window>, name: &'h str) -> Node<'h> {
        harness.get_all_by_label(name).find(|node| node.accesskit_node().role() == Role::ComboBox).unwrap()
    }

    #[test]
    fn a_control_without_effect_is_disabled_and_shows_the_reason() {
        let mut harness = window("column", Vec2::new(1000.0, 640.0), Theme::Dark);
        harness.state_mut().session.document.preset.systems[0].settings.path = RenderPath::Forward;
        harness.get_by_label("Advanced").click();
        harness.run_steps(3);
        let is_gray = |name| control(&harness, name).accesskit_node().is_disabled();
        assert!(is_gray("Coverage") && !is_gray("Technique"));
        // The name is to the left of the control.
        let position = control(&harness, "Coverage").rect().left_center();
        harness.hover_at(position - Vec2::new(80.0, 0.0));
        harness.run_steps(8);
        assert!(harness.query_all_by_label_contains("No effect now: deferred only.").next().is_some());
    }

    #[test]
    fn programmer_settings_come_last_and_no_setting_is_on_two_tabs() {
        let mut harness = window("column", Vec2::new(1280.0, 800.0), Theme::Dark);
        harness.get_by_label("Advanced").click();
        harness.run_steps(3);
        let position = |name: &str| harness.get_all_by_label(name).next().unwrap().rect().top();
        let before =
            ["Blend mode", "Technique", "Boost", "Sprite", "Volumetric"].map(position).into_iter().fold(0.0, f32::max);
        assert!(["Path", "Smoke buffer"].into_iter().all(|name| position(name) > before));
        for name in super::SMOKE_TAB_GROUPS {
            // The strip below the image has labels of its own.
            let is_row = |node: &Node<'_>| node.rect().left() > 900.0 && node.rect().bottom() < 660.0;
            let rows = harness.query_all_by_label(&display_name(name)).filter(is_row).count();
            assert_eq!(rows, 0, "{name}");
        }
    }

    #[test]
    fn smoke_settings_are_collapsible_and_a_search_expands_them() {
        let size = Vec2::new(1280.0, 800.0);
        let mut harness = window("column", size, Theme::Dark);
        harness.get_by_label("Smoke").click();
        harness.run_steps(4);
        let window = eframe::egui::Rect::from_min_size(Default::default(), size);
        for heading in [
            "Emitter",
            "Birth",
            "Motion",
            "Turbulence",
            "Flow",
            "Radius",
            "Appearance",
            "Sprite and ramps",
            "Soft fade",
        ] {
            assert!(window.contains_rect(harness.get_by_label(heading).rect()), "{heading}");
        }
        let sliders = harness.query_all_by_role(Role::Slider).filter(|node| node.rect().left() > 800.0).count();
        assert!(sliders < 10, "{sliders} sliders in one run");
        assert!(harness.query_by_label("Turbulence speed").is_none());
        // A changed field in a collapsed part is marked.
        harness.state_mut().session.document.preset.systems[0].emitter.turbulence_speed = 0.4;
        harness.state_mut().session.search.go_to("systems[0].material.specular_ramp".into());
        harness.run_steps(8);
        assert!(harness.query_by_label("Turbulence •").is_some() && harness.query_by_label("Motion").is_some());
        assert!(window.contains_rect(control(&harness, "Specular ramp").rect()));
        assert!(harness.query_by_label("Y down").is_some(), "the first heading is open, too");
        harness.state_mut().session.search.go_to("systems[0].emitter.turbulence_speed".into());
        harness.run_steps(8);
        let row = harness.get_all_by_label("Turbulence speed").next().unwrap().rect();
        assert!(window.contains_rect(row), "{row:?}");
    }

    #[test]
    fn the_image_is_the_largest_part_of_the_smallest_window() {
        let size = Vec2::new(640.0, 400.0);
        let mut harness = window("column", size, Theme::Dark);
        let mut width = None;
        for (_, name, _) in super::TABS {
            harness.get_all_by_label(name).next().unwrap().click();
            harness.run_steps(4);
            let image = harness.get_by_label("viewport").rect();
            // The strip takes the full width.
            let others = [size.x - image.width(), size.y - image.bottom()];
            assert!(image.width() > others[0] && image.height() > others[1], "{name}: {image}");
            // Nothing on the tab is wider than the panel.
            let width = *width.get_or_insert(image.width());
            assert!((width - image.width()).abs() < 0.5, "{name}: {width} {image}");
            for (_, name, _) in super::TABS {
                let tab = harness.get_all_by_label(name).next().unwrap().rect();
                assert!(tab.left() >= image.right() && tab.right() <= size.x, "{name}: {tab}, beside {image}");
            }
        }
    }

    #[test]
    fn columns_of_particle_files_that_are_not_used_are_told_on_the_smoke_tab() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a.csv"), "x,y,z,nx\n0,1,0,0\n").unwrap();
        let path = folder.path().join("my.json");
        let system = r#"{"name": "s", "particle_files": {"path": "a.csv"}}"#;
        std::fs::write(&path, format!(r#"{{"version": 1, "name": "x", "systems": [{system}]}}"#)).unwrap();
        let mut harness = window(path.to_str().unwrap(), Vec2::new(1000.0, 640.0), Theme::Dark);
        harness.get_by_label("Smoke").click();
        harness.run_steps(4);
        let note = "systems[0].particle_files.path: a.csv: nx: not read; expected names that docs/particles.md lists";
        assert!(harness.query_by_label(note).is_some());
    }

    fn undo_name(harness: &Harness<'_, Window>) -> Option<String> {
        harness.state().session.document.history().undo_name().map(str::to_owned)
    }

    #[test]
    fn values_of_the_second_image_are_marked_and_can_be_copied_field_by_field() {
        let mut harness = window("column", Vec2::new(1000.0, 640.0), Theme::Dark);
        let saved = harness.state().session.document.preset.clone();
        let is_marked = |harness: &Harness<'_, Window>, name| harness.query_by_label(name).is_some();
        let exposure = "Copy Exposure from image B";
        let buoyancy = "Copy Rise from image B";
        let preset = &mut harness.state_mut().session.document.preset;
        preset.camera.exposure = 3.0;
        preset.systems[0].emitter.buoyancy += 1.0;
        harness.run_steps(3);
        assert!(!is_marked(&harness, exposure), "nothing is compared");
        harness.state_mut().session.compare.against = Some(CompareWith::Forward);
        harness.run_steps(3);
        assert!(!is_marked(&harness, exposure), "the same settings, drawn in another way");
        harness.state_mut().session.compare.against = Some(CompareWith::Saved);
        harness.run_steps(3);
        assert!(is_marked(&harness, exposure) && is_marked(&harness, buoyancy));
        assert!(!is_marked(&harness, "Copy Glow from image B"));
        harness.get_by_label(exposure).click();
        harness.run_steps(3);
        let now = |harness: &Harness<'_, Window>| harness.state().session.document.preset.clone();
        assert_eq!(now(&harness).camera, saved.camera);
        assert_ne!(now(&harness).systems, saved.systems);
        assert!(!is_marked(&harness, exposure) && is_marked(&harness, buoyancy));
        assert_eq!(undo_name(&harness).as_deref(), Some("Exposure"));
        // The menu shows the value that would be copied.
        row_menu(&mut harness, "Rise");
        let value = shown_value(&FieldValue::Number(saved.systems[0].emitter.buoyancy), "m/s²");
        harness.get_by_label(&format!("Copy {value} from image B")).click();
        harness.run_steps(3);
        assert_eq!(now(&harness), saved);
        harness.state_mut().session.undo();
        assert_ne!(now(&harness).systems, saved.systems);
    }
}
