//! Texture of a sprite: its frames on a sheet.

use glam::{UVec2, Vec4};
use haze_core::assets::sprite::Sprite;
use image::{Rgba, RgbaImage};

/// Name of the file.
pub const SPRITE: &str = "sprite.png";

/// Frames of a sprite on one image: rgb = normal / 2 + 1/2 (x right, y up, z towards the viewer), a = amount. Not sRGB.
pub struct SpriteTexture {
    pub image: RgbaImage,
    /// Columns and rows. Frames run left to right, then down; cells after the last frame are clear.
    pub cells: UVec2,
    /// Number of frames, at least 1.
    pub frames: u32,
}

impl SpriteTexture {
    pub fn new(sprite: &Sprite) -> Self {
        let size = sprite.size();
        let frames = sprite.frame_count();
        let columns = (1..).find(|columns| columns * columns >= frames).unwrap_or(1);
        let cells = UVec2::new(columns, frames.div_ceil(columns));
        let image = RgbaImage::from_fn(cells.x * size, cells.y * size, |x, y| {
            let frame = y / size * cells.x + x / size;
            let texel = if frame < frames { sprite.texel(0, frame, x % size, y % size) } else { Vec4::ZERO };
            Rgba(texel.to_array().map(|channel| (channel * 255.0).round() as u8))
        });
        Self { image, cells, frames }
    }
}
