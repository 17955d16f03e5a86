//! Toolbar on the image: overlays, turntable, scene.

use std::ops::RangeInclusive;

use eframe::egui::containers::menu::{MenuButton, MenuConfig};
use eframe::egui::{self, PopupCloseBehavior, Rect, Ui};
use glam::Vec3;
use haze_author::preset::Tooltips;
use haze_core::settings::{Choice, FieldVisitor, Fields};

use crate::document::display_names::display_name;
use crate::panels::narrow::is_narrow;
use crate::session::Session;
use crate::session::action::{Action, InView, keys_of};
use crate::session::view_options::Overlay;

/// Switches with their names and tooltips.
const SWITCHES: [(InView, &str, &str); 5] = [
    (InView::Overlay(Overlay::Bounds), "Bounds", "Box around each system"),
    (InView::Overlay(Overlay::LitPlane), "Lit plane", "Plane at which the smoke is lit"),
    (InView::Overlay(Overlay::Particles), "Particles", "Centers of the sprites: warm colors are young, cold ones old"),
    (InView::Overlay(Overlay::Grid), "Grid", "Pixels of the smoke buffer"),
    (InView::Turntable, "Turntable", "Rotates all lights around the smoke. The preset does not change."),
];

/// Draws the toolbar into the upper left corner of the image. Returns the action of a clicked switch.
pub fn toolbar(ui: &mut Ui, rect: Rect, session: &mut Session) -> Option<InView> {
    let mut asked = None;
    let builder = egui::UiBuilder::new().max_rect(rect.shrink(6.0)).layout(egui::Layout::top_down(egui::Align::Min));
    ui.scope_builder(builder, |ui| {
        let fill = ui.visuals().panel_fill;
        egui::Frame::new().fill(fill).corner_radius(4.0).inner_margin(3.0).show(ui, |ui| {
            ui.horizontal_wrapped(|ui| {
                ui.spacing_mut().item_spacing = egui::vec2(3.0, 3.0);
                // They would hide the image of a narrow window.
                let switches = if is_narrow(ui.ctx()) { &[][..] } else { &SWITCHES };
                for &(action, name, tooltip) in switches {
                    let keys = keys_of(Action::InView(action)).map(|keys| ui.ctx().format_shortcut(&keys));
                    let keys = keys.unwrap_or_default();
                    let button = ui.selectable_label(is_on(session, action), name);
                    if button.on_hover_text(format!("{tooltip} ({keys})")).clicked() {
                        asked = Some(action);
                    }
                }
                // The menu stays open, so that several switches can be changed.
                let config = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
                MenuButton::new("Scene").config(config).ui(ui, |ui| {
                    let tooltips = &session.tooltips;
                    session.document.preset.environment.visit(&mut Switches { ui, tooltips });
                });
            });
        });
    });
    asked
}

fn is_on(session: &Session, action: InView) -> bool {
    match action {
        InView::Overlay(overlay) => session.view.overlays.has(overlay),
        _ => session.view.lights.turn.is_some(),
    }
}

/// Draws the choices and flags of a struct as switches.
struct Switches<'a> {
    ui: &'a mut Ui,
    tooltips: &'a Tooltips,
}

impl FieldVisitor for Switches<'_> {
    fn number(&mut self, _: &'static str, _: &mut f32, _: RangeInclusive<f32>, _: &'static str) {}

    fn integer(&mut self, _: &'static str, _: &mut u32, _: RangeInclusive<u32>, _: &'static str) {}

    fn vector(&mut self, _: &'static str, _: &mut Vec3, _: RangeInclusive<f32>, _: &'static str) {}

    fn flag(&mut self, name: &'static str, value: &mut bool) {
        let tooltip = self.tooltips.field(&format!("environment.{name}")).unwrap_or_default();
        self.ui.checkbox(value, display_name(name)).on_hover_text(tooltip);
    }

    fn choice(&mut self, name: &'static str, value: &mut dyn Choice) {
        let mut index = value.index();
        for (position, &choice) in value.names().iter().enumerate() {
            let tooltip = self.tooltips.choice(&format!("environment.{name}"), choice).unwrap_or_default();
            self.ui.radio_value(&mut index, position, display_name(choice)).on_hover_text(tooltip);
        }
        value.set_index(index);
        self.ui.separator();
    }

    fn group(&mut self, _: &'static str, fields: &mut dyn Fields) {
        fields.visit(self);
    }

    fn item(&mut self, _: &'static str, _: usize, fields: &mut dyn Fields) {
        fields.visit(self);
    }
}
