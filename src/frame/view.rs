//! The camera of a frame.

use glam::{Mat4, UVec2};

/// The camera of one frame, in the conventions of the host: any world, either hand, any depth buffer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// World to view space: turns, moves and mirrors, but neither scales nor shears. A left-handed world, or a mirror's
    /// camera, makes its determinant −1.
    pub view_from_world: Mat4,
    /// View space to clip space, depth 0..1: perspective or orthographic, standard or reversed, finite or infinite far
    /// plane, off-centre or jittered. The viewer looks along −z or +z of view space, whichever the projection says; it may
    /// also turn the picture over, left to right or upside down. Near and far plane face the viewer, and nothing is rolled:
    /// turn `view_from_world` for that.
    pub clip_from_view: Mat4,
    /// Pixels of the view.
    pub size: UVec2,
    /// The view's upper left pixel in the host's colour target and scene depth: (0, 0), but for split screens, viewports of an
    /// editor, and pictures that are drawn into a part of a larger target.
    pub origin: UVec2,
}

impl View {
    /// A view that fills its targets.
    pub const fn new(view_from_world: Mat4, clip_from_view: Mat4, size: UVec2) -> Self {
        Self { view_from_world, clip_from_view, size, origin: UVec2::ZERO }
    }
}
