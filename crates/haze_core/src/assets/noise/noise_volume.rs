//! Tiling 3D noise for volumetric particles: density in alpha, negated density gradient in rgb.

use std::path::Path;
use std::sync::Arc;

use glam::{UVec3, Vec4};
use image::RgbaImage;

use crate::assets::image::{decode_png, read_file};
use crate::assets::image_number::ImageNumber;
use crate::error::AssetError;
use crate::formula::texture::Texture3d;

/// Maximum side in voxels. 64 slices of 64 rows reach the maximum image height of 4096 pixels.
pub const MAX_SIZE: u32 = 64;

/// A decoded cube of noise that tiles in every direction. Texels have 8 bits per channel: a = density; rgb = direction
/// towards lower density (negated gradient) / 2 + 1/2, scaled so that the steepest gradient has unit length. A clone
/// shares its texels.
#[derive(Clone, Debug, PartialEq)]
pub struct NoiseVolume {
    size: u32,
    /// Texels in order of slices, then rows.
    texels: Arc<[[u8; 4]]>,
    number: ImageNumber,
}

impl NoiseVolume {
    /// True if both share the same memory.
    pub fn shares_memory(&self, other: &Self) -> bool {
        self.number() == other.number()
    }

    /// Returns the number of the image in this process. Clones have the same one, other images another.
    pub fn number(&self) -> u64 {
        self.number.0
    }

    /// One voxel of density 1/2 without a gradient: noise that changes nothing.
    pub fn even() -> Self {
        Self { size: 1, texels: Arc::new([[128; 4]]), number: ImageNumber::default() }
    }

    /// Cuts an image into slices: the image is `size` texels wide and has `size` slices below each other.
    ///
    /// # Errors
    /// [`AssetError::Image`] if the image is not `size` by `size`², with `size` 1 to [`MAX_SIZE`].
    pub fn from_image(path: &Path, image: &RgbaImage) -> Result<Self, AssetError> {
        let (size, height) = image.dimensions();
        if size == 0 || size > MAX_SIZE || height != size * size {
            let reason = format!(
                "{size}x{height} pixels are not a cube; expected slices below each other, for example 32x1024 pixels, \
                 and at most {MAX_SIZE} a side"
            );
            return Err(AssetError::Image { path: path.into(), reason });
        }
        let texels = image.pixels().map(|pixel| pixel.0).collect();
        Ok(Self { size, texels, number: ImageNumber::default() })
    }

    /// Loads a PNG file.
    ///
    /// # Errors
    /// As [`read_png`](crate::assets::image::read_png) and [`NoiseVolume::from_image`].
    pub fn load(path: &Path) -> Result<Self, AssetError> {
        Self::decode(path, &read_file(path)?)
    }

    /// Decodes the bytes of a PNG file. `path` is only named in errors.
    ///
    /// # Errors
    /// As [`decode_png`] and [`NoiseVolume::from_image`].
    pub fn decode(path: &Path, bytes: &[u8]) -> Result<Self, AssetError> {
        Self::from_image(path, &decode_png(path, bytes)?.to_rgba8())
    }

    /// Returns the number of voxels along each side.
    pub fn size(&self) -> u32 {
        self.size
    }

    /// Returns one texel, 0..1 in each channel.
    pub fn texel(&self, at: UVec3) -> Vec4 {
        let index = (at.z * self.size + at.y) * self.size + at.x;
        Vec4::from(self.texels[index as usize].map(f32::from)) / 255.0
    }

    /// Returns the size of the texels, bytes.
    pub fn memory(&self) -> u64 {
        size_of_val(&*self.texels) as u64
    }

    /// Returns the texels, four bytes each: slices along z, rows along y.
    pub fn bytes(&self) -> &[u8] {
        bytemuck::cast_slice(&self.texels[..])
    }
}

impl Texture3d for NoiseVolume {
    fn dimensions(&self) -> u32 {
        self.size
    }

    fn load(&self, at: UVec3) -> Vec4 {
        self.texel(at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_that_are_not_a_cube_are_refused() {
        let refused = |width, height| {
            let image = RgbaImage::new(width, height);
            NoiseVolume::from_image(Path::new("fbm.png"), &image).unwrap_err().to_string()
        };
        assert!(refused(32, 32).contains("expected slices below each other"));
        assert!(refused(0, 0).contains("fbm.png"));
    }
}
