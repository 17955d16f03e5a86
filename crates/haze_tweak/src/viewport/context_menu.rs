//! Context menu of the image.

use eframe::egui::{Pos2, Response, Ui};
use glam::Vec3;
use haze::{Light, LightKind};

use super::screen_projection::ScreenProjection;
use crate::document::light_defaults::new_light;
use crate::session::Session;
use crate::session::action::InView;
use crate::session::smoke_geometry::SmokeGeometry;

/// Context menu, and the position where it was opened.
#[derive(Default)]
pub struct Menu {
    pub at: Option<Pos2>,
}

/// Entries that add a light.
const ADDED: [(LightKind, &str); 3] = [
    (LightKind::Point, "Add Point Light Here"),
    (LightKind::Spot, "Add Spot Light Here"),
    (LightKind::Directional, "Add Sun from Here"),
];

impl Menu {
    /// Draws the menu while it is open. Returns an action that the caller has to do.
    pub fn show(
        &mut self,
        response: &Response,
        projection: &ScreenProjection,
        session: &mut Session,
        smoke: &mut SmokeGeometry,
    ) -> Option<InView> {
        if response.secondary_clicked() {
            self.at = response.interact_pointer_pos();
        }
        let at = self.at?;
        let mut asked = None;
        response.context_menu(|ui| asked = entries(ui, at, projection, session, smoke));
        asked
    }
}

fn entries(
    ui: &mut Ui,
    at: Pos2,
    projection: &ScreenProjection,
    session: &mut Session,
    smoke: &mut SmokeGeometry,
) -> Option<InView> {
    for (kind, name) in ADDED {
        if ui.button(name).clicked() {
            let middle = session.measure(smoke).bounds().center();
            let light = here(new_light(kind, &session.document.preset.lights), at, projection, middle);
            session.add_light(light);
        }
    }
    let mut asked = None;
    let rim = ui.button("Add Rim Light").on_hover_text("Adds a light behind the smoke, which draws its outline");
    if rim.clicked() {
        session.view.lights.selected = None;
        asked = Some(InView::Behind);
    }
    ui.separator();
    for (action, name) in [(InView::Behind, "Move Light behind Smoke"), (InView::Frame, "Frame Smoke")] {
        if ui.button(name).clicked() {
            asked = Some(action);
        }
    }
    asked
}

/// Returns a light under the pointer, on the plane through the smoke's center that faces the camera. A sun shines from
/// that position on the sun sphere.
fn here(mut light: Light, at: Pos2, projection: &ScreenProjection, middle: Vec3) -> Light {
    let (center, radius) = projection.sun_sphere;
    light.position = projection.unproject_to_facing_plane(at, middle);
    let to_middle = middle - light.position;
    light.direction = match light.kind {
        LightKind::Directional => center - projection.ray(at).on_sphere(center, radius, true),
        _ if to_middle.length() > 0.1 => to_middle,
        _ => projection.ahead,
    };
    light.direction = light.direction.normalize_or(Vec3::NEG_Y);
    light
}
