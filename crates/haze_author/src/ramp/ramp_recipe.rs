//! Recipes of ramps, and baking them to images.

use std::path::Path;

use glam::{UVec2, Vec2, Vec3};
use haze_core::assets::image::{Image, MAX_BYTES, MAX_SIDE};
use haze_core::assets::json;
use haze_core::error::{AssetError, FieldError};
use haze_core::settings::{FieldVisitor, Fields, validate};
use image::{DynamicImage, ImageBuffer};

use super::blend_space::srgb16_from_linear;
pub use super::blend_space::{Blend, HexColor};
pub use super::gradient::{Curve, RampRow, RampStop};
use super::gradient::{PreparedRows, check_not_empty};
use super::place_formula::Formula;

/// Recipe format version that this code writes and reads.
pub const RECIPE_VERSION: u32 = 1;

/// Size limit of a recipe file, bytes. 100 rows of 1000 stops in the longest notation take 9 MB.
const MAX_RECIPE: u64 = 16 << 20;

/// Recipe of a ramp: the contents of a `*.ramp.json`.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RampRecipe {
    /// Format version.
    pub version: u32,
    /// Width, texels.
    pub width: u32,
    /// Height, texels. 1 for a ramp of one axis.
    pub height: u32,
    /// Bits per channel: 16, or 8 with dithering.
    #[serde(default = "default_bits", skip_serializing_if = "is_default_bits")]
    pub bits: u32,
    /// Color space for blending along rows and between rows. With an HSV space, rows are blended with each other in
    /// Oklab.
    #[serde(default, skip_serializing_if = "Blend::is_default")]
    pub blend: Blend,
    /// Formula for the position along the rows in terms of both axes `u` and `v`, for example `u / (0.2 + v)`. The
    /// result is clamped to 0 to 1. Empty means `u`.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub place: String,
    /// Gradient along the second axis. Its linear color is multiplied with that of the rows. Empty means white.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub times: Vec<RampStop>,
    /// Gradients, placed along the second axis from 0 to 1. One row for a ramp of one axis.
    pub rows: Vec<RampRow>,
}

fn default_bits() -> u32 {
    16
}

fn is_default_bits(bits: &u32) -> bool {
    *bits == default_bits()
}

/// A black ramp of one axis.
impl Default for RampRecipe {
    fn default() -> Self {
        let stops = vec![RampStop::new(0.0, HexColor([0; 3]))];
        Self {
            version: RECIPE_VERSION,
            width: 256,
            height: 1,
            bits: default_bits(),
            blend: Blend::default(),
            place: String::new(),
            times: Vec::new(),
            rows: vec![RampRow { stops, ..RampRow::default() }],
        }
    }
}

impl Fields for RampRecipe {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.integer("version", &mut self.version, RECIPE_VERSION..=RECIPE_VERSION, "");
        visitor.integer("width", &mut self.width, 2..=MAX_SIDE, "texels");
        // The baked image (three channels of 16 bits) must stay within the size limit for reading.
        let most = MAX_BYTES as u32 / 6 / self.width.max(1);
        visitor.integer("height", &mut self.height, 1..=most.min(MAX_SIDE), "texels");
        visitor.integer("bits", &mut self.bits, 8..=16, "");
        visitor.choice("blend", &mut self.blend);
        visitor.text("place", &mut self.place);
        for (index, stop) in self.times.iter_mut().enumerate() {
            visitor.item("times", index, stop);
        }
        for (index, row) in self.rows.iter_mut().enumerate() {
            visitor.item("rows", index, row);
        }
    }
}

impl RampRecipe {
    /// Loads a `*.ramp.json` of at most 16 MiB.
    ///
    /// # Errors
    /// [`AssetError::Io`], [`AssetError::Text`] or [`AssetError::JsonField`].
    pub fn load(path: &Path) -> Result<Self, AssetError> {
        Self::parse(path, &json::read(path, MAX_RECIPE)?)
    }

    /// Parses the text of a recipe. `path` is used only in errors.
    ///
    /// # Errors
    /// [`AssetError::Text`] or [`AssetError::JsonField`].
    pub fn parse(path: &Path, text: &str) -> Result<Self, AssetError> {
        let recipe: Self = json::parse_versioned(path, text, RECIPE_VERSION)?;
        recipe.validate().map_err(|error| AssetError::JsonField { path: path.into(), error })?;
        Ok(recipe)
    }

    /// Returns the recipe as JSON that [`RampRecipe::parse`] reads, ending with a line break. Each stop takes one line;
    /// fields at their default are omitted.
    pub fn to_json(&self) -> String {
        // Numbers and strings only, so serialisation cannot fail.
        let pretty = serde_json::to_string_pretty(self).unwrap_or_default();
        let mut text = String::new();
        let mut lines = pretty.lines().peekable();
        while let Some(line) = lines.next() {
            text += line;
            // An object that begins with `at` and `color` is a stop.
            let is_stop = line.trim_start() == "{" && {
                let mut ahead = lines.clone();
                ahead.next().is_some_and(|line| line.contains("\"at\""))
                    && ahead.next().is_some_and(|line| line.contains("\"color\""))
            };
            if is_stop {
                for line in lines.by_ref() {
                    text += " ";
                    text += line.trim_start();
                    if line.trim_start().starts_with('}') {
                        break;
                    }
                }
            }
            text += "\n";
        }
        text
    }

    /// Checks ranges, the formula, and that every gradient has stops.
    ///
    /// # Errors
    /// The first field that is not valid.
    pub fn validate(&self) -> Result<(), FieldError> {
        validate(self, String::new)?;
        if ![8, 16].contains(&self.bits) {
            return Err(FieldError::new("bits", self.bits, "8 or 16"));
        }
        self.formula()?;
        check_not_empty("rows", &self.rows)?;
        let mut rows = self.rows.iter().enumerate();
        rows.try_for_each(|(index, row)| check_not_empty(format!("rows[{index}].stops"), &row.stops))
    }

    fn formula(&self) -> Result<Option<Formula>, FieldError> {
        (!self.place.is_empty()).then(|| Formula::parse("place", &self.place)).transpose()
    }

    /// Prepares the recipe for sampling.
    ///
    /// # Errors
    /// As [`RampRecipe::validate`].
    pub fn gradient(&self) -> Result<Gradient, FieldError> {
        self.validate()?;
        let row = |stops: &Vec<RampStop>| RampRow { stops: stops.clone(), ..RampRow::default() };
        let times = (!self.times.is_empty()).then(|| PreparedRows::new(self.blend, &[row(&self.times)]));
        Ok(Gradient { rows: PreparedRows::new(self.blend, &self.rows), place: self.formula()?, times })
    }

    /// Bakes the image: sRGB, row 0 of the second axis at the bottom.
    ///
    /// # Errors
    /// As [`RampRecipe::validate`].
    pub fn bake(&self) -> Result<DynamicImage, FieldError> {
        let gradient = self.gradient()?;
        let size = UVec2::new(self.width, self.height);
        let last = (size - 1).max(UVec2::ONE).as_vec2();
        let mut image = Image::new(size, [0; 3]);
        image.for_each(|at, texel| {
            *texel = srgb16_from_linear(gradient.sample(at.x as f32 / last.x, (size.y - 1 - at.y) as f32 / last.y));
        });
        Ok(if self.bits == 8 { dithered(&image) } else { image_of(image) })
    }
}

/// A recipe prepared for sampling: stops sorted, colors converted to the blend space.
#[derive(Clone, Debug)]
pub struct Gradient {
    rows: PreparedRows,
    place: Option<Formula>,
    times: Option<PreparedRows>,
}

impl Gradient {
    /// Returns the position along the rows at a position, 0 to 1 on both axes.
    pub(super) fn place(&self, at: Vec2) -> f32 {
        self.place.as_ref().map_or(at.x, |formula| formula.place(at.x, at.y))
    }

    /// Returns the linear RGB color at a position, 0 to 1 on both axes.
    pub fn sample(&self, u: f32, v: f32) -> Vec3 {
        let light = self.rows.sample(self.place(Vec2::new(u, v)), v);
        self.times.as_ref().map_or(light, |times| light * times.sample(v, 0.0))
    }
}

/// Step of a baked channel, of 65535: a 32nd of a step of 8 bits. Files of smooth gradients are 40 % smaller than with all
/// bits.
const BAKED_STEP: u16 = 8;

/// Converts sRGB texels to an image of 16 bits per channel, rounded to [`BAKED_STEP`]. Colors that are exact in
/// 8 bits stay unchanged.
pub(super) fn image_of(image: Image<[u16; 3]>) -> DynamicImage {
    let rounded = |channel: u16| match channel % 257 {
        0 => channel,
        _ => channel.saturating_add(BAKED_STEP / 2) / BAKED_STEP * BAKED_STEP,
    };
    let texels = image.texels.into_iter().flatten().map(rounded).collect();
    // Never the default: there is one texel per pixel.
    ImageBuffer::from_raw(image.size.x, image.size.y, texels)
        .map_or_else(DynamicImage::default, DynamicImage::ImageRgb16)
}

/// Converts sRGB texels to an image of 8 bits per channel with ordered dithering, so that gradients show no bands.
fn dithered(image: &Image<[u16; 3]>) -> DynamicImage {
    let dither = |(index, texel): (u32, &[u16; 3])| {
        // R2 sequence: multiples of the inverse plastic number and of its square, in units of 2^-32. Thresholds are
        // evenly distributed along any line. (Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018)
        let x = index % image.size.x;
        let y = index / image.size.x;
        let threshold = x.wrapping_mul(3_242_174_889).wrapping_add(y.wrapping_mul(2_447_445_414)) >> 16;
        // Colors that are exact in 8 bits stay unchanged.
        texel.map(|channel| ((u32::from(channel) * 255 + threshold.min(65534)) / 65535) as u8)
    };
    let texels: Vec<_> = (0..).zip(&image.texels).flat_map(dither).collect();
    ImageBuffer::from_raw(image.size.x, image.size.y, texels)
        .map_or_else(DynamicImage::default, DynamicImage::ImageRgb8)
}

#[cfg(test)]
mod tests;
