//! Shadow maps of a host's lights.

use glam::Mat4;

/// Projection of a light's shadow map.
#[derive(Clone, Copy, Debug)]
pub struct ShadowProjection<'a> {
    /// Index in [`FrameInput::lights`](crate::FrameInput::lights).
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

/// Shadow map of a light: depth of the opaque scene as the light sees it.
#[derive(Clone, Copy, Debug)]
pub struct ShadowMap<'a> {
    /// 2D texture of a depth format with `TEXTURE_BINDING` usage, single-sampled. A layer per matrix, from `first_layer` on.
    /// On OpenGL, it has one layer more than a light needs, because wgpu takes a texture of one layer for one without layers,
    /// and six for the faces of a cube. Drawn in this encoder before the smoke is prepared, or in an earlier one.
    pub depth: &'a wgpu::Texture,
    /// First layer of the light in `depth`.
    pub first_layer: u32,
    /// Projection of the map.
    pub projection: ShadowProjection<'a>,
}
