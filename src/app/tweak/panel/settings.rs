//! Everything that can be set, at the right of the window.

use std::collections::HashSet;

use eframe::egui::{self, Ui};
use haze::settings::Fields;

use super::fields::{Desk, show};
use crate::app::tweak::document::{changed_fields, copy_field};
use crate::app::tweak::session::Session;

pub fn panel(ui: &mut Ui, session: &mut Session) {
    let changed: HashSet<_> = changed_fields(&session.saved, &session.preset).into_iter().collect();
    let mut desk = Desk {
        tooltips: &session.tooltips,
        changed: &changed,
        inert: &|_| None,
        reset: Vec::new(),
        refused: None,
        sought: None,
    };
    let preset = &mut session.preset;
    egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        let mut section = |title: &str, step: &'static str, fields: &mut dyn Fields| {
            egui::CollapsingHeader::new(title).show(ui, |ui| show(ui, &mut desk, &[(step, None)], fields));
        };
        section("Camera", "camera", &mut preset.camera);
        section("Environment", "environment", &mut preset.environment);
        for (index, light) in preset.lights.iter_mut().enumerate() {
            let title = format!("Light {}", index + 1);
            egui::CollapsingHeader::new(title).show(ui, |ui| show(ui, &mut desk, &[("lights", Some(index))], light));
        }
        for (index, system) in preset.systems.iter_mut().enumerate() {
            let header = egui::CollapsingHeader::new(system.name.clone()).id_salt(("system", index)).default_open(true);
            header.show(ui, |ui| show(ui, &mut desk, &[("systems", Some(index))], system));
        }
    });
    let Desk { reset, refused, .. } = desk;
    for path in reset {
        copy_field(&session.saved, &mut session.preset, &path);
    }
    if let Some(refused) = refused {
        session.messages.complain("typed", refused);
    }
}
