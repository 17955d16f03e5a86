//! CPU version of `shaders/lib/shadow_views.wgsl`.

use glam::{Vec2, Vec3, Vec4};
use haze_core::formula::saturate;
use haze_core::formula::shadow::channel_of_slot;
use haze_core::formula::view::pixels_per_metre;
use haze_core::view_setup::AttachmentRole;

use crate::visible_system::VisibleSystem;

/// Brightness of the borders between the cells of the grid.
const CELL_BORDER: f32 = 0.7;

impl VisibleSystem<'_> {
    /// 1 for each channel whose light is there.
    fn channels_with_light(&self) -> Vec3 {
        self.lights.iter().map(|light| channel_of_slot(light.shadow_slot)).sum::<Vec3>().min(Vec3::ONE)
    }

    /// Fractions of the lights that come through smoke and past the scene. White without shadow.
    pub fn fractions_of_lights(&self, optical_depths: Vec3, visible: Vec3) -> Vec3 {
        if !AttachmentRole::OpticalDepths.is_used(&self.settings) {
            return Vec3::ONE;
        }
        let fraction = Vec3::from((-optical_depths).to_array().map(f32::exp2)) * visible;
        Vec3::ONE + (fraction - Vec3::ONE) * self.channels_with_light()
    }

    /// Light in the grid on the plane of the system's center, and 1 in w; or 0 outside of the grid.
    pub fn slice_of_light(&self, pixel: Vec2) -> Vec4 {
        let system = &self.system;
        let position = self.view_position(pixel, -system.center.z);
        let cell_position = system.grid_from_view.transform_point3(position);
        let is_outside = cell_position.cmplt(Vec3::ZERO).any() || cell_position.cmpgt(system.grid_size).any();
        let Some(volume) = self.optical_depths.as_ref().filter(|_| !is_outside) else { return Vec4::ZERO };
        if !AttachmentRole::OpticalDepths.is_used(&self.settings) {
            return Vec4::ZERO;
        }
        let pixels = pixels_per_metre(self.view.size.y, self.view.ray_scale.y, -position.z, self.view.orthographic);
        let fractions =
            self.fractions_of_lights(volume.sample(0, cell_position), volume.sample_visible(0, cell_position));
        let normal = system.grid_from_view.transform_vector3(Vec3::Z);
        (fractions * cell_pattern(cell_position, normal, system.cells_per_metre / pixels)).extend(1.0)
    }
}

/// Brightness of a cell_position on a plane through the grid: darker along the borders of cells, but for those that are nearly
/// parallel to the plane. `normal`: of the plane, any length. `pixel`: its size in cells.
fn cell_pattern(position: Vec3, normal: Vec3, pixel: f32) -> f32 {
    let inside = position - position.floor();
    let is_steepest = normal.abs().cmpeq(Vec3::splat(normal.abs().max_element()));
    let nearest = Vec3::select(is_steepest, Vec3::ONE, inside.min(1.0 - inside)).min_element();
    CELL_BORDER + (1.0 - CELL_BORDER) * saturate(nearest / pixel.max(1.0e-6))
}
