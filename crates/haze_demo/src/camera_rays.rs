//! Rays through the pixels of a perspective camera.

use glam::{Vec2, Vec3, Vec4Swizzles};

use haze_core::frame::View;

/// Rays of a view. Not from the inverse of the projection, which loses all digits if the near plane is close.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CameraRays {
    /// Origin of all rays, world space.
    pub eye: Vec3,
    /// Vector to the middle of the image at view depth 1.
    pub forward: Vec3,
    /// Vector from the middle to the right edge of the image at view depth 1.
    pub right: Vec3,
    /// Vector from the middle to the top edge of the image at view depth 1.
    pub up: Vec3,
}

impl CameraRays {
    pub fn new(view: &View) -> Self {
        let world_from_view = view.view_from_world.inverse();
        let projection = view.clip_from_view;
        let scale = Vec2::new(projection.x_axis.x, projection.y_axis.y).recip();
        let offset = projection.z_axis.xy() * scale;
        Self {
            eye: world_from_view.transform_point3(Vec3::ZERO),
            forward: world_from_view.transform_vector3(offset.extend(-1.0)),
            right: world_from_view.transform_vector3(Vec3::X * scale.x),
            up: world_from_view.transform_vector3(Vec3::Y * scale.y),
        }
    }

    /// Returns the vector from the eye to view depth 1. `uv` is 0..1, from the image's upper left corner.
    pub fn at_unit_depth(&self, uv: Vec2) -> Vec3 {
        self.forward + self.right * (uv.x * 2.0 - 1.0) + self.up * (1.0 - uv.y * 2.0)
    }
}
