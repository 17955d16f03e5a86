//! Shadow maps of a host's lights.

use haze_core::frame::ShadowProjection;

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
