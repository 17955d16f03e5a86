//! The camera of a frame.

use std::ops::RangeInclusive;

use glam::{Mat4, UVec2};

/// Vertical fields of view of a perspective camera in presets and in files, degrees.
pub const FOV_RANGE: RangeInclusive<f32> = 1.0..=150.0;

/// Camera of one frame, in the conventions of the host: any world axes, left- or right-handed, any kind of depth
/// buffer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// World to view space: rotation, translation and mirroring, but no scale or shear. Its determinant is −1 in a
    /// left-handed world, and for the camera of a mirror.
    pub view_from_world: Mat4,
    /// View space to clip space, depth 0..1: perspective or orthographic, standard or reversed, finite or infinite far
    /// plane, off-center or jittered. The viewer looks along −z or +z of view space, as the projection says. The
    /// projection may flip the image horizontally or vertically. Near and far plane face the viewer. The projection
    /// must not roll the image; `view_from_world` can.
    pub clip_from_view: Mat4,
    /// Size of the view, pixels.
    pub size: UVec2,
    /// Upper left pixel of the view in the host's color target and scene depth. (0, 0), except for split screens,
    /// viewports of an editor, and images that are drawn into a part of a larger target.
    pub origin: UVec2,
}

impl View {
    /// View that fills its targets.
    pub const fn new(view_from_world: Mat4, clip_from_view: Mat4, size: UVec2) -> Self {
        Self { view_from_world, clip_from_view, size, origin: UVec2::ZERO }
    }
}
