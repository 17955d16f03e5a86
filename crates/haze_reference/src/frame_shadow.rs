//! Computation of the volume of a frame's shadow.

use glam::Vec3;

use super::input::FrameInput;
use super::optical_depths::OpticalDepths;
use super::pass::density_splat::{density_from_steps, density_splat};
use super::pass::shadow_march::{march_to_lights, march_to_sky};
use super::pass::shadow_visibility::shadow_visibility;
use super::visible_system::PlacedSystems;
use haze::view_setup::SmokeShadow;

impl PlacedSystems<'_> {
    /// Computes all blocks of the volume.
    pub fn shadow_volume(&self, frame: &FrameInput<'_>, shadow: &SmokeShadow) -> OpticalDepths {
        let density = self.density(shadow);
        let openness = shadow.has_openness.then(|| march_to_sky(&density, shadow));
        let cells = march_to_lights(&density, shadow);
        OpticalDepths { size: shadow.grid.size, cells, visible: visibility(frame, shadow), openness }
    }

    /// As [`shadow_volume`](Self::shadow_volume), without the optical depths towards the lights.
    pub fn shadow_volume_without_lights(&self, frame: &FrameInput<'_>, shadow: &SmokeShadow) -> OpticalDepths {
        let openness = shadow.has_openness.then(|| march_to_sky(&self.density(shadow), shadow));
        OpticalDepths { size: shadow.grid.size, cells: Vec::new(), visible: visibility(frame, shadow), openness }
    }

    /// Optical depths across the cells of the density grid.
    fn density(&self, shadow: &SmokeShadow) -> Vec<f32> {
        let size = shadow.grid.size;
        let mut steps = vec![0; size.element_product() as usize];
        let visible = self.visible.iter().map(|(_, visible)| (&visible.system, visible.particles.as_slice()));
        let hidden = self.hidden.iter().map(|(uniform, particles)| (uniform, *particles));
        visible.chain(hidden).for_each(|(system, particles)| density_splat(system, particles, size, &mut steps));
        density_from_steps(&steps)
    }
}

fn visibility(frame: &FrameInput<'_>, shadow: &SmokeShadow) -> Option<Vec<Vec3>> {
    shadow.has_visibility.then(|| shadow_visibility(frame.shadow_maps, shadow))
}
