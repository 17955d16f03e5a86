//! Texture access of the formulas: `textureDimensions` and `textureLoad` of WGSL, for any storage of texels.

use glam::{UVec2, UVec3, Vec4};

/// `texture_2d<f32>`.
pub trait Texture2d {
    /// Width and height, at least 1.
    fn dimensions(&self) -> UVec2;

    /// Texel at a position inside the dimensions.
    fn load(&self, at: UVec2) -> Vec4;
}

/// `texture_2d_array<f32>` with square layers and a full mip chain.
pub trait Texture2dArray {
    /// Number of mip levels, including the full size.
    fn level_count(&self) -> u32;

    /// Side of a level in texels, at least 1.
    fn dimensions(&self, level: u32) -> u32;

    /// Texel at a position inside the level's dimensions.
    fn load(&self, at: UVec2, layer: u32, level: u32) -> Vec4;
}

/// `texture_3d<f32>` with equal sides.
pub trait Texture3d {
    /// Side in texels, at least 1.
    fn dimensions(&self) -> u32;

    /// Texel at a position inside the dimensions.
    fn load(&self, at: UVec3) -> Vec4;
}
