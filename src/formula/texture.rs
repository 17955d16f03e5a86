//! What formulas read textures by: `textureDimensions` and `textureLoad` of WGSL, whoever holds the texels.

use glam::{UVec2, UVec3, Vec4};

/// `texture_2d<f32>`.
pub trait Texture2d {
    /// Width and height, at least 1.
    fn dimensions(&self) -> UVec2;

    /// A texel inside the dimensions.
    fn load(&self, at: UVec2) -> Vec4;
}

/// `texture_2d_array<f32>`, square, with the whole mip chain.
pub trait Texture2dArray {
    /// Mip levels, the full size included.
    fn level_count(&self) -> u32;

    /// Side of a level, at least 1.
    fn dimensions(&self, level: u32) -> u32;

    /// A texel inside the dimensions.
    fn load(&self, at: UVec2, layer: u32, level: u32) -> Vec4;
}

/// `texture_3d<f32>`, a cube.
pub trait Texture3d {
    /// Side, at least 1.
    fn dimensions(&self) -> u32;

    /// A texel inside the dimensions.
    fn load(&self, at: UVec3) -> Vec4;
}
