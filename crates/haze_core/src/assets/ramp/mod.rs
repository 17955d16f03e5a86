//! Ramps: small lookup textures for lighting that an artist can paint. `ramps/README.md` describes axes, sizes and
//! color space.

mod ramp_role;

pub use ramp_role::RampRole;

use std::path::Path;
use std::sync::Arc;

use glam::{UVec2, Vec2, Vec3, Vec4};
use half::f16;
use image::DynamicImage;

use crate::assets::image::{decode_color_png, read_file};
use crate::assets::image_number::ImageNumber;
use crate::assets::measured::Measured;
use crate::assets::ramp_steps::largest_step;
use crate::error::AssetError;
use crate::formula::color::linear_from_srgb;
use crate::formula::diffuse_bake::zonal_coefficients;
use crate::formula::ramp::sample_ramp_2d;
use crate::formula::texture::Texture2d;
use crate::settings::RampFilter;

/// A decoded ramp: linear RGB in half floats, as on the GPU. A 1D ramp has one row. A clone shares its texels.
#[derive(Clone, Debug, PartialEq)]
pub struct Ramp {
    size: UVec2,
    texels: Arc<[[f16; 4]]>,
    number: ImageNumber,
    largest_step: Measured<f32>,
    zonal: Measured<[Vec3; 3]>,
}

impl Ramp {
    /// Builds a ramp from linear colors, row by row, starting with row 0 of the second axis.
    ///
    /// # Panics
    /// Never: missing texels are black, surplus ones are dropped.
    pub fn from_linear(size: UVec2, colors: impl IntoIterator<Item = Vec3>) -> Self {
        let size = size.max(UVec2::ONE);
        let mut texels: Vec<_> = colors
            .into_iter()
            .take((size.x * size.y) as usize)
            .map(|color| [color.x, color.y, color.z, 1.0].map(f16::from_f32))
            .collect();
        texels.resize((size.x * size.y) as usize, [f16::ZERO; 4]);
        let (number, largest_step, zonal) = Default::default();
        Self { size, texels: texels.into(), number, largest_step, zonal }
    }

    /// Converts an sRGB image of 8 or 16 bits per channel. Alpha is ignored;
    /// [`decode_color_png`] applies it. The bottom row is 0 on the second axis.
    pub fn from_image(image: &DynamicImage) -> Self {
        let pixels = image.to_rgb16();
        let size = UVec2::new(pixels.width(), pixels.height());
        let linear = |channel: u16| linear_from_srgb(f32::from(channel) / 65535.0);
        let colors = pixels.rows().rev().flat_map(|row| row.map(|pixel| Vec3::from(pixel.0.map(linear))));
        Self::from_linear(size, colors)
    }

    /// Loads a PNG file.
    ///
    /// # Errors
    /// As [`read_color_png`](crate::assets::image::read_color_png).
    pub fn load(path: &Path) -> Result<Self, AssetError> {
        Self::decode(path, &read_file(path)?)
    }

    /// Decodes the bytes of a PNG file. `path` is only named in errors.
    ///
    /// # Errors
    /// As [`decode_color_png`].
    pub fn decode(path: &Path, bytes: &[u8]) -> Result<Self, AssetError> {
        Ok(Self::from_image(&decode_color_png(path, bytes)?))
    }

    /// Returns the size, texels.
    pub fn size(&self) -> UVec2 {
        self.size
    }

    /// Returns the linear RGB of a texel; y counts from row 0 of the second axis.
    pub fn texel(&self, at: UVec2) -> Vec3 {
        self.load(at).truncate()
    }

    /// True if both share the same memory.
    pub fn shares_memory(&self, other: &Self) -> bool {
        self.number() == other.number()
    }

    /// Returns the number of the image in this process. Clones have the same one, other images another.
    pub fn number(&self) -> u64 {
        self.number.0
    }

    /// Returns the size of the texels, bytes.
    pub fn memory(&self) -> u64 {
        size_of_val(&*self.texels) as u64
    }

    /// Returns the largest step, by which `lighting_resolution` `auto` decides.
    pub fn largest_step(&self) -> f32 {
        *self.largest_step.get_or_measure(|| largest_step(self))
    }

    /// Returns the zonal harmonic coefficients of the row of fully opaque smoke.
    pub fn zonal(&self) -> [Vec3; 3] {
        let color = |cos: f32| sample_ramp_2d(self, RampFilter::Bilinear, Vec2::new(cos * 0.5 + 0.5, 1.0));
        *self.zonal.get_or_measure(|| zonal_coefficients(color))
    }

    /// Returns the texels for upload: `Rgba16Float`, row 0 of the second axis first.
    pub fn bytes(&self) -> Vec<u8> {
        self.texels.iter().flatten().flat_map(|channel| channel.to_le_bytes()).collect()
    }
}

impl Texture2d for Ramp {
    fn dimensions(&self) -> UVec2 {
        self.size
    }

    fn load(&self, at: UVec2) -> Vec4 {
        Vec4::from(self.texels[(at.y * self.size.x + at.x) as usize].map(f16::to_f32))
    }
}
