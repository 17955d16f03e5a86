//! The fire ramp as painted, or as the camera shows it.

use eframe::egui::Ui;
use glam::Vec3;
use haze_core::formula::color::linear_from_srgb;
use haze_core::formula::tonemap::DisplayTransform;

use crate::session::Session;

/// Fire as the image shows it.
pub struct FireDisplay {
    /// Factor of the fire ramp.
    intensity: f32,
    transform: DisplayTransform,
}

impl FireDisplay {
    /// Draws the choice between the fire ramp as painted and as exposed; `None` for as painted.
    pub fn choose(ui: &mut Ui, session: &mut Session, system: usize) -> Option<Self> {
        ui.checkbox(&mut session.view.fire_as_exposed, "As exposed").on_hover_text(
            "The colors as they are in the image: times the intensity of the fire, with the camera's exposure and tonemap. \
             Off: as painted.",
        );
        let preset = session.view.fire_as_exposed.then(|| session.preset_now())?;
        let intensity = preset.systems.get(system)?.settings.fire.intensity;
        let transform = DisplayTransform { exposure: preset.camera.exposure.exp2(), tonemap: preset.camera.tonemap };
        Some(Self { intensity, transform })
    }

    /// Color of a fire ramp, linear, as the screen shows it: where it is opaque.
    pub fn shown(&self, light: Vec3) -> Vec3 {
        self.transform.code(light * self.intensity).map(linear_from_srgb)
    }
}
