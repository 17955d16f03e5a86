//! Painting on the smoke: a drag changes the ramp where the smoke of the inspected pixel looks it up.

use eframe::egui::{self, PointerButton, Response, Ui};
use glam::{Vec2, Vec3};
use haze_author::ramp::RampRecipe;
use haze_core::formula::color::luminance;
use haze_reference::SystemProbe;

use crate::document::ramp_edits::{RampOrigin, ramp_name};
use crate::session::{CopiedImage, CopyRequest, Session};
use crate::viewport_renderer::compared_side::ComparedSide;

/// Length of a drag that doubles or halves the light, points.
const DOUBLE: f32 = 120.0;
/// Messages are about this.
const SUBJECT: &str = "paint";

/// Drag in progress.
#[derive(Default)]
pub struct SmokePaint {
    is_active: bool,
    /// `None` if nothing can be painted.
    stroke: Option<Stroke>,
}

/// Stroke on a ramp, and how far the pointer has moved.
struct Stroke {
    name: String,
    before: RampRecipe,
    at: Vec2,
    moved: egui::Vec2,
}

/// Lookup of a ramp by a pixel.
struct Lookup {
    field: &'static str,
    at: Vec2,
    /// Light that it gives.
    light: f32,
}

impl SmokePaint {
    /// Paints while the inspector is on and a drag with Ctrl is in progress. Returns true meanwhile.
    pub fn interact(&mut self, ui: &Ui, response: &Response, session: &mut Session) -> bool {
        if is_begun(ui, response) {
            self.is_active = session.inspect.is_on;
            self.stroke = self.is_active.then(|| begin(session)).flatten();
        }
        if !response.dragged() {
            *self = Self::default();
        }
        session.inspect.is_painting = self.stroke.is_some();
        let Some(stroke) = &mut self.stroke else { return self.is_active };
        // A drag that has just begun has moved since the press.
        let is_new = response.drag_started();
        stroke.moved += if is_new { response.total_drag_delta().unwrap_or_default() } else { response.drag_delta() };
        stroke.apply(session);
        true
    }
}

/// True in the frame in which a drag with Ctrl begins.
fn is_begun(ui: &Ui, response: &Response) -> bool {
    response.drag_started_by(PointerButton::Primary) && ui.input(|input| input.modifiers.command)
}

/// Says how to paint if a drag with Ctrl begins while the inspector is off.
pub fn explain(ui: &Ui, response: &Response, session: &mut Session) {
    if is_begun(ui, response) {
        session.messages.info(SUBJECT, "Ctrl + drag paints on the smoke while Inspect is on");
    }
}

impl Stroke {
    /// Up lightens, down darkens, right warms and left cools.
    fn apply(&self, session: &mut Session) {
        let [warm, light] = [self.moved.x, -self.moved.y].map(|moved| (moved / DOUBLE).exp2());
        match self.before.painted(self.at, Vec3::new(warm, 1.0, 1.0 / warm) * light) {
            Ok(recipe) => {
                session.document.recipes.ramps.set(&self.name, recipe);
                session.document.name_gradient_step(&self.name, "paint on smoke");
            }
            Err(error) => session.messages.error(SUBJECT, error),
        }
    }
}

/// Begins a stroke at the inspected pixel, on the ramp that gives most of its light. If that ramp cannot be changed, says
/// why, or asks to copy it.
fn begin(session: &mut Session) -> Option<Stroke> {
    let values = session.inspect.pixel_values.as_ref().filter(|values| values.side == ComparedSide::First);
    let Some(probe) = values.and_then(|values| values.probe.systems.last()).cloned() else {
        session.messages.info(SUBJECT, "No smoke here. Ctrl + drag on smoke changes the ramp that lights it");
        return None;
    };
    let system = probe.system;
    let path = |field| format!("systems[{system}].material.{field}");
    let preset = &session.document.preset;
    let is_used = |lookup: &Lookup| session.no_effect_reason(preset, &path(lookup.field)).is_none();
    let brightest = lookups(&probe).filter(is_used).max_by(|a, b| a.light.total_cmp(&b.light));
    let named = brightest.and_then(|lookup| Some((ramp_name(preset, system, lookup.field)?, lookup)));
    let Some((name, Lookup { field, at, .. })) = named else {
        session.messages.info(SUBJECT, "No ramp lights this smoke");
        return None;
    };
    let folders = session.folders();
    match session.ramps.source(&name, &folders).clone() {
        RampOrigin::Recipe(read) => {
            session.messages.clear(SUBJECT);
            let before = session.document.recipes.ramps.get(&name).cloned().unwrap_or(read);
            Some(Stroke { name, before, at, moved: egui::Vec2::ZERO })
        }
        RampOrigin::BuiltIn => {
            session.copy_request = Some(CopyRequest { system, name, image: CopiedImage::Ramp(field) });
            None
        }
        RampOrigin::Painted { .. } => {
            let what = format!("{name} is a painted image: fit stops to it on the Ramps tab, then paint on the smoke");
            session.messages.error(SUBJECT, what);
            None
        }
        RampOrigin::Missing => None,
    }
}

/// Ramps that the smoke at a pixel looks up by its own position, with the light that they give.
fn lookups(probe: &SystemProbe) -> impl Iterator<Item = Lookup> {
    let of_lights = probe.lights.iter().flat_map(|light| {
        let at = Vec2::new(light.coordinate, probe.coverage_coordinate);
        let brightness = luminance(light.diffuse);
        let [front, back] = [1.0 - light.backlight, light.backlight].map(|fraction| fraction * brightness);
        [("diffuse_ramp", front), ("backlight_ramp", back)].map(|(field, light)| Lookup { field, at, light })
    });
    let of_fire =
        probe.fire.map(|fire| Lookup { field: "fire_ramp", at: fire.coordinate, light: luminance(fire.light) });
    of_lights.chain(of_fire)
}
