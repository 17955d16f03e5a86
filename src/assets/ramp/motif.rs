//! Bakes a motif: a picture of a lit sphere, looked up by the normal's xy. (OTEE "Diffuse lighting", "motif lighting")

use std::path::Path;

use glam::{Vec2, Vec3};
use image::{DynamicImage, ImageBuffer};

use super::bake::{HexColour, srgb16_from_linear};
use crate::assets::json;
use crate::error::{Error, FieldError};
use crate::formula::diffuse_bake::motif_normal;
use crate::formula::saturate;
use crate::settings::{FieldVisitor, Fields, validate};

/// The version of the recipe format that this code writes and reads.
pub const RECIPE_VERSION: u32 = 1;

/// How a motif was made: the contents of a `*.motif.json`.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "app", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct MotifRecipe {
    /// Format version.
    pub version: u32,
    /// Side of the picture.
    pub size: u32,
    /// sRGB, where no light reaches.
    pub ambient: HexColour,
    /// Lights on the sphere.
    pub lights: Vec<MotifLight>,
}

/// One light of a motif.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "app", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct MotifLight {
    /// Towards the light, view space: x right, y up, z to the viewer. Need not be unit length.
    #[cfg_attr(feature = "app", schemars(with = "[f32; 3]"))]
    pub direction: Vec3,
    /// sRGB at the brightest point.
    pub colour: HexColour,
    /// How far the light wraps round: 0 ends at the terminator, 1 reaches the far side.
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
        visitor.srgb("colour", &mut self.colour.0);
        visitor.number("wrap", &mut self.wrap, 0.0..=1.0, "");
    }
}

impl MotifRecipe {
    /// Reads a `*.motif.json`.
    ///
    /// # Errors
    /// [`Error::Io`], [`Error::Json`] or [`Error::JsonField`].
    pub fn load(path: &Path) -> Result<Self, Error> {
        json::load(path, RECIPE_VERSION, |recipe: &Self| validate(recipe, String::new))
    }

    /// Bakes the picture: sRGB, 16 bits a channel.
    ///
    /// # Errors
    /// The first field that is not valid.
    pub fn bake(&self) -> Result<DynamicImage, FieldError> {
        validate(self, String::new)?;
        let last = (self.size - 1) as f32;
        let picture = ImageBuffer::from_fn(self.size, self.size, |x, y| {
            let normal = motif_normal(Vec2::new(x as f32 / last * 2.0 - 1.0, 1.0 - y as f32 / last * 2.0));
            let lit = self.lights.iter().map(|light| {
                let facing = normal.dot(light.direction.normalize_or(Vec3::Z));
                let amount = saturate((facing + light.wrap) / (1.0 + light.wrap));
                light.colour.linear() * amount * amount
            });
            let colour = self.ambient.linear() + lit.sum::<Vec3>();
            srgb16_from_linear(colour)
        });
        Ok(DynamicImage::ImageRgb16(picture))
    }
}
