//! Projection of a shadow map.

use glam::Mat4;

/// Projection of a light's shadow map.
#[derive(Clone, Copy, Debug)]
pub struct ShadowProjection<'a> {
    /// Index in `FrameInput::lights`.
    pub light: usize,
    /// From world space to the clip space of each layer, in the convention of the map: one layer for a spot light, one per
    /// cascade for a directional light, six for the faces of a cube. Cascades from fine to coarse: the first layer that
    /// contains a point is read. Points outside of all layers are lit. 1 to 6 layers.
    pub clip_from_world: &'a [Mat4],
    /// True if the map stores the near plane as 1.
    pub reversed: bool,
    /// Depth, in units of the map, by which a surface must be before a point to hide it. From 0 on.
    pub bias: f32,
}
