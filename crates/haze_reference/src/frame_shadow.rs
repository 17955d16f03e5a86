//! Computation of the volume of a frame's shadow.

use glam::Vec3;
use haze_core::view_setup::{SmokeShadow, cell_optical_depths, density_splat};

use super::input::FrameInput;
use super::optical_depths::OpticalDepths;
use super::pass::shadow_march::{march_to_lights, march_to_sky};
use super::pass::shadow_visibility::shadow_visibility;
use super::visible_system::PlacedSystems;

impl PlacedSystems<'_> {
    /// Computes all blocks of the volume.
    pub fn shadow_volume(&self, frame: &FrameInput<'_>, shadow: &SmokeShadow) -> OpticalDepths {
        let density = self.density(shadow);
        let openness = shadow.has_openness.then(|| march_to_sky(&density, shadow));
        let blocks = (0..shadow.used_light_blocks()).map(|block| march_to_lights(&density, shadow, block)).collect();
        OpticalDepths { size: shadow.grid.size, blocks, visible: visibility(frame, shadow), openness }
    }

    /// As [`shadow_volume`](Self::shadow_volume), without optical depths if the sprites accumulated all that are read.
    pub fn shadow_volume_of_texels(&self, frame: &FrameInput<'_>, shadow: &SmokeShadow) -> OpticalDepths {
        if shadow.light_blocks > 1 {
            return self.shadow_volume(frame, shadow);
        }
        let openness = shadow.has_openness.then(|| march_to_sky(&self.density(shadow), shadow));
        OpticalDepths { size: shadow.grid.size, blocks: Vec::new(), visible: visibility(frame, shadow), openness }
    }

    /// Optical depths across the cells of the density grid.
    fn density(&self, shadow: &SmokeShadow) -> Vec<f32> {
        let size = shadow.grid.size;
        let mut steps = vec![0; size.element_product() as usize];
        let visible = self.visible.iter().map(|(_, visible)| (&visible.system, visible.particles.as_slice()));
        let hidden = self.hidden.iter().map(|(uniform, particles)| (uniform, *particles));
        visible.chain(hidden).for_each(|(system, particles)| density_splat(system, particles, size, &mut steps));
        cell_optical_depths(&steps).collect()
    }
}

/// By block of lights.
fn visibility(frame: &FrameInput<'_>, shadow: &SmokeShadow) -> Option<Vec<Vec<Vec3>>> {
    let of_block = |block| shadow_visibility(frame.shadow_maps, shadow, block);
    shadow.has_visibility.then(|| (0..shadow.used_light_blocks()).map(of_block).collect())
}
