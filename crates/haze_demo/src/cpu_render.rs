//! Renders a shot, scene and smoke, on the CPU. offscreen_renderer.rs does so on the GPU.

use glam::{Vec3, Vec4};

use super::ray_caster;
use super::shot::Shot;
use haze::assets::image::Image;
use haze::error::Error;
use haze::frame::Particle;
use haze::settings::Settings;

impl Shot {
    /// Renders the shot on the CPU. Returns linear HDR.
    ///
    /// # Errors
    /// [`Error::Field`] if the preset was changed to invalid values.
    pub fn render_on_cpu(&self) -> Result<Image<Vec4>, Error> {
        let view = self.preset.camera.view(self.size);
        let (mut color, depth) = ray_caster::render(&self.scene(), &view);
        if !self.shows_scene() {
            color.texels.fill(Vec4::W);
        }
        let particles = self.systems();
        let systems = self.reference_systems(&particles);
        let frame = self.reference_frame(&depth, &systems);
        haze_reference::render(&frame, &mut color)?;
        Ok(color)
    }

    pub(super) fn reference_systems<'a>(
        &'a self,
        particles: &'a [(Vec<Particle>, Settings)],
    ) -> Vec<haze_reference::ParticleSystem<'a>> {
        let system =
            |((particles, settings), material)| haze_reference::ParticleSystem::new(particles, settings, material);
        let particles = particles.iter().map(|(particles, settings)| (particles.as_slice(), settings));
        particles.zip(&self.materials).map(system).collect()
    }

    pub(super) fn reference_frame<'a>(
        &'a self,
        scene_depth: &'a Image<f32>,
        systems: &'a [haze_reference::ParticleSystem<'a>],
    ) -> haze_reference::FrameInput<'a> {
        haze_reference::FrameInput {
            lights: &self.preset.lights,
            systems,
            time: self.preset.time,
            up: Vec3::Y,
            debug_view: self.debug_view,
            ..haze_reference::FrameInput::new(self.preset.camera.view(self.size), scene_depth)
        }
    }
}
