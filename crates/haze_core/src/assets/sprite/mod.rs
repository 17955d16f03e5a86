//! Sprites: flipbooks of normal maps with the amount in alpha.

pub mod alpha_bounds;
pub mod sprite_density;
pub mod sprite_detail;

use std::path::Path;
use std::sync::Arc;

use glam::{UVec2, Vec3, Vec4, Vec4Swizzles};
use image::RgbaImage;

use crate::assets::image::{Image, decode_png, read_file};
use crate::assets::image_number::ImageNumber;
use crate::assets::measured::Measured;
use crate::error::AssetError;
use crate::formula::texture::Texture2dArray;
use alpha_bounds::{AlphaBounds, AlphaBoundsTexel, alpha_bounds_texel};
use sprite_density::SpriteDensity;
use sprite_detail::SpriteDetail;

/// Layout of frames in a sprite's image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub struct SpriteLayout {
    /// Columns of frames.
    pub columns: u32,
    /// Rows of frames. Frames run left to right, then down.
    pub rows: u32,
    /// True if green points down (DirectX convention).
    pub y_down: bool,
}

impl Default for SpriteLayout {
    fn default() -> Self {
        Self { columns: 1, rows: 1, y_down: false }
    }
}

/// A decoded flipbook with its mip levels. Texels: rgb = normal / 2 + 1/2 (x right, y up, z towards the viewer), a =
/// amount, 8 bits per channel, not premultiplied. A clone shares its texels.
#[derive(Clone, Debug, PartialEq)]
pub struct Sprite {
    size: u32,
    frame_count: u32,
    /// Mip levels. Each level holds its frames in order, row by row from the top.
    levels: Vec<Arc<[[u8; 4]]>>,
    number: ImageNumber,
    alpha_bounds: Measured<Vec<AlphaBoundsTexel>>,
    density: Measured<SpriteDensity>,
    detail: Measured<SpriteDetail>,
}

/// Maximum number of frames: the number of array layers that WebGL2 guarantees.
pub const MAX_FRAMES: u32 = 256;

impl Sprite {
    /// True if both share the same memory.
    pub fn shares_memory(&self, other: &Self) -> bool {
        self.number() == other.number()
    }

    /// Returns the number of the image in this process. Clones have the same one, other images another.
    pub fn number(&self) -> u64 {
        self.number.0
    }

    /// Cuts an image into frames and builds their mip levels.
    ///
    /// # Errors
    /// [`AssetError::Image`] if the layout does not fit the image, frames are not square, or a frame is not clear at its
    /// border (the sprite would be visible as a square).
    pub fn from_image(path: &Path, image: &RgbaImage, layout: SpriteLayout) -> Result<Self, AssetError> {
        let error = |reason: String| Err(AssetError::Image { path: path.into(), reason });
        let columns = layout.columns;
        let rows = layout.rows;
        let (width, height) = image.dimensions();
        if !columns.checked_mul(rows).is_some_and(|frames| (1..=MAX_FRAMES).contains(&frames)) {
            return error(format!("{columns}x{rows} frames; expected 1 to {MAX_FRAMES} frames"));
        }
        if width == 0 || width % columns != 0 || height % rows != 0 || width / columns != height / rows {
            return error(format!(
                "{width}x{height} pixels do not divide into {columns}x{rows} square frames; \
                 expected columns and rows that give square frames"
            ));
        }
        let size = width / columns;
        let mut texels = Vec::with_capacity((width * height) as usize);
        for frame in 0..columns * rows {
            let origin = UVec2::new(frame % columns, frame / columns) * size;
            for y in 0..size {
                for x in 0..size {
                    let mut texel = image.get_pixel(origin.x + x, origin.y + y).0;
                    if layout.y_down {
                        texel[1] = 255 - texel[1];
                    }
                    if texel[3] != 0 && size > 2 && (x == 0 || y == 0 || x == size - 1 || y == size - 1) {
                        return error(format!(
                            "frame {frame} has alpha {} on its border at ({x}, {y}); expected a border of alpha 0, \
                             or the sprite shows as a square",
                            texel[3]
                        ));
                    }
                    texels.push(texel);
                }
            }
        }
        Ok(Self::with_levels(size, columns * rows, texels))
    }

    /// Loads a PNG file.
    ///
    /// # Errors
    /// As [`read_png`](crate::assets::image::read_png) and [`Sprite::from_image`].
    pub fn load(path: &Path, layout: SpriteLayout) -> Result<Self, AssetError> {
        Self::decode(path, &read_file(path)?, layout)
    }

    /// Decodes the bytes of a PNG file. `path` is only named in errors.
    ///
    /// # Errors
    /// As [`decode_png`] and [`Sprite::from_image`].
    pub fn decode(path: &Path, bytes: &[u8], layout: SpriteLayout) -> Result<Self, AssetError> {
        Self::from_image(path, &decode_png(path, bytes)?.to_rgba8(), layout)
    }

    /// Builds the mip levels of frames below each other, `size` texels a side each.
    pub fn with_levels(size: u32, frame_count: u32, texels: Vec<[u8; 4]>) -> Self {
        let (number, alpha_bounds, density, detail) = Default::default();
        let levels = vec![texels.into()];
        let mut sprite = Self { size, frame_count, levels, number, alpha_bounds, density, detail };
        for level in 1..=size.ilog2() {
            let coarse = sprite.level_size(level);
            let fine = sprite.level_size(level - 1);
            // Frames below each other.
            let mut texels = Image::new(UVec2::new(coarse, coarse * frame_count), [0; 4]);
            texels.for_each(|at, texel| {
                let near = |dx: u32, dy: u32| {
                    let x = (2 * at.x + dx).min(fine - 1);
                    let y = (2 * (at.y % coarse) + dy).min(fine - 1);
                    sprite.texel(level - 1, at.y / coarse, x, y)
                };
                *texel = average([near(0, 0), near(1, 0), near(0, 1), near(1, 1)]);
            });
            sprite.levels.push(texels.texels.into());
        }
        sprite
    }

    /// Returns the side of a frame in texels, at mip level 0.
    pub fn size(&self) -> u32 {
        self.size
    }

    /// Returns the number of frames.
    pub fn frame_count(&self) -> u32 {
        self.frame_count
    }

    /// Returns the number of mip levels, including level 0.
    pub fn level_count(&self) -> u32 {
        self.levels.len() as u32
    }

    /// Returns the side of a frame in texels at a mip level.
    pub fn level_size(&self, level: u32) -> u32 {
        (self.size >> level).max(1)
    }

    /// Returns one texel, 0..1 in each channel.
    pub fn texel(&self, level: u32, frame: u32, x: u32, y: u32) -> Vec4 {
        let size = self.level_size(level);
        let texel = self.levels[level as usize][((frame * size + y) * size + x) as usize];
        Vec4::from(texel.map(f32::from)) / 255.0
    }

    /// Returns the size of the texels, bytes.
    pub fn memory(&self) -> u64 {
        self.levels.iter().map(|level| size_of_val(&**level) as u64).sum()
    }

    /// Returns the bounds of its frames and mip levels, followed by those of `after`: its six-way maps.
    pub fn alpha_bounds(&self, after: Option<&Self>) -> AlphaBounds {
        let texels = std::iter::once(self).chain(after).flat_map(|sprite| {
            sprite.alpha_bounds.get_or_measure(|| {
                let positions = (0..sprite.frame_count)
                    .flat_map(|frame| (0..sprite.level_count()).map(move |level| (level, frame)));
                let bounds =
                    |(level, frame)| alpha_bounds_texel(sprite.frame_texels(level, frame), sprite.level_size(level));
                positions.map(bounds).collect()
            })
        });
        AlphaBounds::new(self.level_count(), texels.copied().collect())
    }

    /// Returns its density, for shadow.
    pub fn density(&self) -> &SpriteDensity {
        self.density.get_or_measure(|| SpriteDensity::new(self.size, &self.levels[0]))
    }

    /// Returns the detail of its image that coarse targets lose.
    pub fn detail(&self) -> &SpriteDetail {
        self.detail.get_or_measure(|| SpriteDetail::new(self, self.frame_count))
    }

    /// Returns the texels of a frame, row by row from the top.
    fn frame_texels(&self, level: u32, frame: u32) -> &[[u8; 4]] {
        let texels = self.level_size(level).pow(2) as usize;
        &self.levels[level as usize][frame as usize * texels..][..texels]
    }

    /// Returns the texels of a mip level, RGBA of 8 bits: frames below each other.
    pub fn level_bytes(&self, level: u32) -> &[u8] {
        bytemuck::cast_slice(&self.levels[level as usize])
    }
}

/// The layout of a sprite's six-way maps.
pub fn six_way_layout(sprite: SpriteLayout) -> SpriteLayout {
    SpriteLayout { rows: sprite.rows.saturating_mul(2), y_down: false, ..sprite }
}

impl Texture2dArray for Sprite {
    fn level_count(&self) -> u32 {
        self.levels.len() as u32
    }

    fn dimensions(&self, level: u32) -> u32 {
        self.level_size(level)
    }

    fn load(&self, at: UVec2, layer: u32, level: u32) -> Vec4 {
        self.texel(level, layer, at.x, at.y)
    }
}

/// Averages texels for the next mip level. Normals are weighted by amount, so that clear texels do not affect them.
fn average(texels: [Vec4; 4]) -> [u8; 4] {
    let amount = texels.iter().map(|texel| texel.w).sum::<f32>() / 4.0;
    let weighted = |weight: fn(&Vec4) -> f32| texels.iter().map(|texel| texel.xyz() * weight(texel)).sum::<Vec3>();
    let normal = if amount > 0.0 { weighted(|t| t.w) / (4.0 * amount) } else { weighted(|_| 0.25) };
    normal.extend(amount).to_array().map(|channel| (channel * 255.0).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgba;

    fn image(width: u32, height: u32) -> RgbaImage {
        RgbaImage::from_pixel(width, height, Rgba([128, 200, 255, 0]))
    }

    fn message(image: &RgbaImage, layout: SpriteLayout) -> String {
        Sprite::from_image(Path::new("wisp.png"), image, layout).unwrap_err().to_string()
    }

    #[test]
    fn frames_run_left_to_right_then_down() {
        let mut sheet = image(8, 8);
        sheet.put_pixel(5, 2, Rgba([10, 20, 30, 40]));
        let sprite = Sprite::from_image(Path::new(""), &sheet, SpriteLayout { columns: 2, rows: 2, y_down: true });
        let sprite = sprite.unwrap();
        assert_eq!((sprite.size(), sprite.frame_count(), sprite.level_count()), (4, 4, 3));
        let texel = sprite.texel(0, 1, 1, 2) * 255.0;
        assert_eq!(texel, Vec4::new(10.0, 235.0, 30.0, 40.0));
    }

    #[test]
    fn mip_levels_weight_normals_by_amount() {
        let mut sheet = image(4, 4);
        sheet.put_pixel(1, 1, Rgba([255, 0, 0, 200]));
        let sprite = Sprite::from_image(Path::new(""), &sheet, SpriteLayout::default()).unwrap();
        assert_eq!(sprite.texel(1, 0, 0, 0) * 255.0, Vec4::new(255.0, 0.0, 0.0, 50.0));
        assert_eq!(sprite.texel(1, 0, 1, 1) * 255.0, Vec4::new(128.0, 200.0, 255.0, 0.0));
    }

    #[test]
    fn layouts_that_do_not_fit_and_opaque_borders_are_refused() {
        assert!(message(&image(8, 8), SpriteLayout { columns: 3, rows: 1, y_down: false }).contains("3x1 square"));
        assert!(message(&image(8, 8), SpriteLayout { columns: 0, rows: 1, y_down: false }).contains("1 to 256"));
        let mut square = image(8, 8);
        square.put_pixel(0, 3, Rgba([0, 0, 0, 9]));
        assert!(message(&square, SpriteLayout::default()).contains("alpha 9 on its border at (0, 3)"));
    }
}
