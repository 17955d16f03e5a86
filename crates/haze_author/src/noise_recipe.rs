//! Tiling noise volumes, baked.

use std::path::Path;

use glam::{UVec3, Vec3, Vec4, Vec4Swizzles};
use haze_core::assets::json;
use haze_core::error::{AssetError, FieldError};
use haze_core::formula::gradient_noise::tiling_noise;
use haze_core::settings::{FieldVisitor, Fields, validate};
use image::{Rgba, RgbaImage};

/// Recipe format version that this code writes and reads.
pub const RECIPE_VERSION: u32 = 1;

/// Recipe of a noise volume: the contents of a `*.noise.json`.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct NoiseRecipe {
    /// Format version.
    pub version: u32,
    /// Different seeds give different noise of the same kind.
    pub seed: u32,
    /// Voxels along each side.
    pub size: u32,
    /// Cells of the coarsest octave along each side.
    pub cells: u32,
    /// Number of octaves, each at twice the frequency of the previous one.
    pub octaves: u32,
    /// Weight of an octave relative to the coarser one.
    pub gain: f32,
}

impl Fields for NoiseRecipe {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.integer("version", &mut self.version, RECIPE_VERSION..=RECIPE_VERSION, "");
        visitor.seed("seed", &mut self.seed);
        visitor.integer("size", &mut self.size, 4..=64, "voxels");
        visitor.integer("cells", &mut self.cells, 1..=64, "");
        visitor.integer("octaves", &mut self.octaves, 1..=8, "");
        visitor.number("gain", &mut self.gain, 0.0..=1.0, "");
    }
}

impl NoiseRecipe {
    /// Loads a `*.noise.json`.
    ///
    /// # Errors
    /// [`AssetError::Io`], [`AssetError::Text`] or [`AssetError::JsonField`].
    pub fn load(path: &Path) -> Result<Self, AssetError> {
        json::load(path, RECIPE_VERSION, |recipe: &Self| validate(recipe, String::new))
    }

    /// Bakes the image of slices below each other.
    ///
    /// # Errors
    /// The first field of the recipe that is out of range.
    pub fn bake(&self) -> Result<RgbaImage, FieldError> {
        validate(self, String::new)?;
        let size = self.size;
        // Gradient in xyz, density in w.
        let sample = |index: u32| self.sample(UVec3::new(index % size, index / size % size, index / (size * size)));
        let field: Vec<Vec4> = (0..size.pow(3)).map(sample).collect();
        let least = field.iter().map(|v| v.w).fold(f32::INFINITY, f32::min);
        let most = field.iter().map(|v| v.w).fold(f32::NEG_INFINITY, f32::max);
        let steepest = field.iter().map(|v| v.xyz().length()).fold(f32::MIN_POSITIVE, f32::max);
        let channel = |value: f32| (value.clamp(0.0, 1.0) * 255.0).round() as u8;
        // With the slices below each other, the image's pixels are in the order of the voxels.
        Ok(RgbaImage::from_fn(size, size * size, |x, y| {
            let value = field[(y * size + x) as usize];
            let away = -value.xyz() / steepest * 0.5 + 0.5;
            let density = (value.w - least) / (most - least).max(f32::MIN_POSITIVE);
            Rgba([channel(away.x), channel(away.y), channel(away.z), channel(density)])
        }))
    }

    fn sample(&self, voxel: UVec3) -> Vec4 {
        let position = (voxel.as_vec3() + 0.5) / self.size as f32;
        let mut sum = Vec4::ZERO;
        let mut period = self.cells;
        let mut weight = 1.0;
        for octave in 0..self.octaves {
            let noise = tiling_noise(position * period as f32, period, self.seed.wrapping_add(octave * 7919));
            let gradient: Vec3 = noise.gradient * period as f32;
            sum += gradient.extend(noise.value) * weight;
            period *= 2;
            weight *= self.gain;
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use haze_core::assets::noise::NoiseVolume;

    use super::*;

    fn recipe() -> NoiseRecipe {
        NoiseRecipe { version: 1, seed: 1, size: 16, cells: 2, octaves: 3, gain: 0.5 }
    }

    #[test]
    fn the_gradient_points_towards_lower_density() {
        let baked = recipe().bake().unwrap();
        let volume = NoiseVolume::from_image(Path::new("test"), &baked).unwrap();
        let mut agreeing = 0;
        for index in 0..16 * 16 * 16_u32 {
            let at = UVec3::new(index % 16, index / 16 % 16, index / 256);
            // Central differences that wrap at the border of the tile.
            let density = |step: UVec3| volume.texel((at + step) % 16).w;
            let slope = Vec3::new(
                density(UVec3::new(1, 0, 0)) - density(UVec3::new(15, 0, 0)),
                density(UVec3::new(0, 1, 0)) - density(UVec3::new(0, 15, 0)),
                density(UVec3::new(0, 0, 1)) - density(UVec3::new(0, 0, 15)),
            );
            agreeing += u32::from((volume.texel(at).xyz() - 0.5).dot(-slope) >= 0.0);
        }
        // Not all 4096 agree: differences over two voxels blur the finest octave.
        assert!(agreeing > 3900, "{agreeing} of 4096");
    }
}
