//! Bakes a motif: an image of a lit sphere, looked up by the normal's xy. (OTEE "Diffuse lighting", "motif lighting")

use std::path::Path;

use glam::{UVec2, Vec2, Vec3};
use haze_core::assets::image::Image;
use haze_core::assets::json;
use haze_core::error::{AssetError, FieldError};
use haze_core::formula::diffuse_bake::motif_normal;
use haze_core::formula::saturate;
use haze_core::settings::{FieldVisitor, Fields, validate};
use image::DynamicImage;

use super::blend_space::{HexColor, srgb16_from_linear};
use super::ramp_recipe::image_of;

/// Recipe format version that this code writes and reads.
pub const RECIPE_VERSION: u32 = 1;

/// Maximum number of lights of a motif. Every texel sums all lights.
const MAX_LIGHTS: usize = 256;

/// Recipe of a motif: the contents of a `*.motif.json`.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct MotifRecipe {
    /// Format version.
    pub version: u32,
    /// Side of the image, pixels.
    pub size: u32,
    /// sRGB color where no light reaches.
    pub ambient: HexColor,
    /// Lights on the sphere.
    pub lights: Vec<MotifLight>,
}

/// One light of a motif.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct MotifLight {
    /// Direction towards the light in view space: x right, y up, z towards the viewer. Need not have unit length.
    #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
    pub direction: Vec3,
    /// sRGB color at the brightest point.
    pub color: HexColor,
    /// Wrap of the light around the sphere: 0 ends at the terminator, 1 reaches the far side.
    pub wrap: f32,
}

impl Fields for MotifRecipe {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.integer("version", &mut self.version, RECIPE_VERSION..=RECIPE_VERSION, "");
        visitor.integer("size", &mut self.size, 8..=1024, "texels");
        visitor.srgb("ambient", &mut self.ambient.0);
        for (index, light) in self.lights.iter_mut().enumerate() {
            visitor.item("lights", index, light);
        }
    }
}

impl Fields for MotifLight {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.vector("direction", &mut self.direction, -1.0e3..=1.0e3, "");
        visitor.srgb("color", &mut self.color.0);
        visitor.number("wrap", &mut self.wrap, 0.0..=1.0, "");
    }
}

impl MotifRecipe {
    /// Loads a `*.motif.json`.
    ///
    /// # Errors
    /// [`AssetError::Io`], [`AssetError::Text`] or [`AssetError::JsonField`].
    pub fn load(path: &Path) -> Result<Self, AssetError> {
        json::load(path, RECIPE_VERSION, Self::validate)
    }

    /// Checks ranges and the number of lights.
    ///
    /// # Errors
    /// The first field that is not valid.
    pub fn validate(&self) -> Result<(), FieldError> {
        validate(self, String::new)?;
        if self.lights.len() > MAX_LIGHTS {
            let problem = format!("{} lights are too many", self.lights.len());
            return Err(FieldError::from_problem("lights", problem, format!("at most {MAX_LIGHTS}")));
        }
        Ok(())
    }

    /// Bakes the image: sRGB, 16 bits per channel.
    ///
    /// # Errors
    /// The first field that is not valid.
    pub fn bake(&self) -> Result<DynamicImage, FieldError> {
        self.validate()?;
        let last = (self.size - 1) as f32;
        let light = |light: &MotifLight| (light.direction.normalize_or(Vec3::Z), light.color.linear(), light.wrap);
        let lights: Vec<_> = self.lights.iter().map(light).collect();
        let mut image = Image::new(UVec2::splat(self.size), [0; 3]);
        image.for_each(|at, texel| {
            let normal = motif_normal(Vec2::new(at.x as f32 / last * 2.0 - 1.0, 1.0 - at.y as f32 / last * 2.0));
            let lit = lights.iter().map(|&(direction, color, wrap)| {
                let amount = saturate((normal.dot(direction) + wrap) / (1.0 + wrap));
                color * amount * amount
            });
            *texel = srgb16_from_linear(self.ambient.linear() + lit.sum::<Vec3>());
        });
        Ok(image_of(image))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn too_many_lights_are_refused() {
        let light = MotifLight { direction: Vec3::Z, color: HexColor([9; 3]), wrap: 0.0 };
        let recipe = |lights| MotifRecipe {
            version: 1,
            size: 8,
            ambient: HexColor([0; 3]),
            lights: vec![light.clone(); lights],
        };
        assert!(recipe(MAX_LIGHTS).bake().is_ok());
        let error = recipe(20_000).bake().unwrap_err().to_string();
        assert_eq!(error, "lights: 20000 lights are too many; expected at most 256");
    }
}
