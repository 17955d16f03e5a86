//! Recipes of ramps, and the pictures that are baked from them.

use std::path::Path;

use glam::{UVec2, Vec3};
use image::{DynamicImage, ImageBuffer};

use super::colour::srgb16_from_linear;
pub use super::colour::{Blend, HexColour};
use super::formula::Formula;
pub use super::gradient::{Curve, RampRow, RampStop};
use super::gradient::{Rows, not_empty};
use haze::assets::json;
use haze::assets::picture::{MAX_BYTES, MAX_SIDE, Picture};
use haze::error::{Error, FieldError};
use haze::settings::{FieldVisitor, Fields, validate};

/// The version of the recipe format that this code writes. It reads 1 as well: rows of monotone curves in Oklab, 16 bits.
pub const RECIPE_VERSION: u32 = 2;

/// Largest recipe that is read, bytes: 100 rows of 1000 stops take 9 MB in the longest way to write them.
const MAX_RECIPE: u64 = 16 << 20;

/// How a ramp was made: the contents of a `*.ramp.json`.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RampRecipe {
    /// Format version.
    pub version: u32,
    /// Texels across.
    pub width: u32,
    /// Texels up: 1 for a ramp of one axis.
    pub height: u32,
    /// Bits a channel: 16, or 8, which are dithered.
    #[serde(default = "most_bits", skip_serializing_if = "is_most_bits")]
    pub bits: u32,
    /// The space that colours are blended in, along rows and from row to row; where that is through hues, rows are blended in
    /// Oklab.
    #[serde(default, skip_serializing_if = "Blend::is_default")]
    pub blend: Blend,
    /// The place along the rows, as a formula of both axes, `u` and `v`: `u / (0.2 + v)`. What it gives is clamped to 0 to 1.
    /// Empty is `u`.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub place: String,
    /// A gradient along the second axis, whose light multiplies that of the rows. Empty is white.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub times: Vec<RampStop>,
    /// Gradients along the second axis, from 0 to 1. One row for a ramp of one axis.
    pub rows: Vec<RampRow>,
}

fn most_bits() -> u32 {
    16
}

fn is_most_bits(bits: &u32) -> bool {
    *bits == most_bits()
}

/// A black strip.
impl Default for RampRecipe {
    fn default() -> Self {
        let stops = vec![RampStop::new(0.0, HexColour([0; 3]))];
        Self {
            version: RECIPE_VERSION,
            width: 256,
            height: 1,
            bits: most_bits(),
            blend: Blend::default(),
            place: String::new(),
            times: Vec::new(),
            rows: vec![RampRow { stops, ..RampRow::default() }],
        }
    }
}

impl Fields for RampRecipe {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.integer("version", &mut self.version, 1..=RECIPE_VERSION, "");
        visitor.integer("width", &mut self.width, 2..=MAX_SIDE, "texels");
        // What is baked must be readable again: three channels of 16 bits.
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
    /// Reads a `*.ramp.json`, of at most 16 MiB.
    ///
    /// # Errors
    /// [`Error::Io`], [`Error::Json`] or [`Error::JsonField`].
    pub fn load(path: &Path) -> Result<Self, Error> {
        Self::parse(path, &json::read(path, MAX_RECIPE)?)
    }

    /// The same of its text; `path` is only named in errors.
    ///
    /// # Errors
    /// [`Error::Json`] or [`Error::JsonField`].
    pub fn parse(path: &Path, text: &str) -> Result<Self, Error> {
        let recipe: Self = json::parse_versioned(path, text, RECIPE_VERSION)?;
        recipe.validate().map_err(|error| Error::JsonField { path: path.into(), error })?;
        Ok(recipe)
    }

    /// The JSON that [`RampRecipe::parse`] makes this recipe from, ending with a line break: a line for each stop, and nothing
    /// that is at its default.
    pub fn to_text(&self) -> String {
        // Numbers and texts: there is nothing that could fail.
        let pretty = serde_json::to_string_pretty(self).unwrap_or_default();
        let mut text = String::new();
        let mut lines = pretty.lines().peekable();
        while let Some(line) = lines.next() {
            text += line;
            // What opens with a place and a colour is a stop.
            let is_stop = line.trim_start() == "{" && {
                let mut ahead = lines.clone();
                ahead.next().is_some_and(|line| line.contains("\"at\""))
                    && ahead.next().is_some_and(|line| line.contains("\"colour\""))
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

    /// Checks ranges, the formula, and that no gradient is without stops.
    ///
    /// # Errors
    /// The first field that is not valid.
    pub fn validate(&self) -> Result<(), FieldError> {
        validate(self, String::new)?;
        if ![8, 16].contains(&self.bits) {
            return Err(FieldError::new("bits", self.bits, "8 or 16"));
        }
        if let Some(field) = self.newest_field().filter(|_| self.version < 2) {
            return Err(FieldError::new("version", self.version, format!("2, for the field `{field}`")));
        }
        self.formula()?;
        not_empty("rows", &self.rows)?;
        let mut rows = self.rows.iter().enumerate();
        rows.try_for_each(|(index, row)| not_empty(format!("rows[{index}].stops"), &row.stops))
    }

    /// What version 1 did not have.
    fn newest_field(&self) -> Option<&'static str> {
        let mut curves = self.rows.iter().flat_map(|row| row.stops.iter().map(|stop| stop.curve).chain([row.curve]));
        let has_curves = curves.any(|curve| curve != Curve::default());
        let used = [
            ("bits", !is_most_bits(&self.bits)),
            ("blend", !self.blend.is_default()),
            ("place", !self.place.is_empty()),
            ("times", !self.times.is_empty()),
            ("curve", has_curves),
        ];
        used.into_iter().find(|used| used.1).map(|used| used.0)
    }

    fn formula(&self) -> Result<Option<Formula>, FieldError> {
        (!self.place.is_empty()).then(|| Formula::parse("place", &self.place)).transpose()
    }

    /// Makes the recipe ready to be asked for many colours.
    ///
    /// # Errors
    /// As [`RampRecipe::validate`].
    pub fn gradient(&self) -> Result<Gradient, FieldError> {
        self.validate()?;
        let row = |stops: &Vec<RampStop>| RampRow { stops: stops.clone(), ..RampRow::default() };
        let times = (!self.times.is_empty()).then(|| Rows::new(self.blend, &[row(&self.times)]));
        Ok(Gradient { rows: Rows::new(self.blend, &self.rows), place: self.formula()?, times })
    }

    /// Bakes the picture: sRGB, the row for 0 at the bottom.
    ///
    /// # Errors
    /// As [`RampRecipe::validate`].
    pub fn bake(&self) -> Result<DynamicImage, FieldError> {
        let gradient = self.gradient()?;
        let size = UVec2::new(self.width, self.height);
        let last = (size - 1).max(UVec2::ONE).as_vec2();
        let mut picture = Picture::new(size, [0; 3]);
        picture.for_each(|at, texel| {
            *texel = srgb16_from_linear(gradient.sample(at.x as f32 / last.x, (size.y - 1 - at.y) as f32 / last.y));
        });
        Ok(if self.bits == 8 { dithered(&picture) } else { image_of(picture) })
    }
}

/// A recipe made ready: its stops sorted, their colours converted.
#[derive(Clone, Debug)]
pub struct Gradient {
    rows: Rows,
    place: Option<Formula>,
    times: Option<Rows>,
}

impl Gradient {
    /// The colour at a place, 0 to 1 on both axes, linear RGB.
    pub fn sample(&self, u: f32, v: f32) -> Vec3 {
        let place = self.place.as_ref().map_or(u, |formula| formula.place(u, v));
        let light = self.rows.sample(place, v);
        self.times.as_ref().map_or(light, |times| light * times.sample(v, 0.0))
    }
}

/// The picture to write of sRGB texels.
pub(super) fn image_of(picture: Picture<[u16; 3]>) -> DynamicImage {
    // A texel for every pixel, so never empty.
    ImageBuffer::from_raw(picture.size.x, picture.size.y, picture.texels.into_flattened())
        .map_or_else(DynamicImage::default, DynamicImage::ImageRgb16)
}

/// The same in 8 bits: rounded up as often as the rest of each texel says, so that slopes show no steps.
fn dithered(picture: &Picture<[u16; 3]>) -> DynamicImage {
    let dither = |(index, texel): (u32, &[u16; 3])| {
        // Thresholds that are even along any line: multiples of the two powers of the plastic number, in parts of 2^32. (Roberts,
        // "The unreasonable effectiveness of quasirandom sequences", 2018)
        let (x, y) = (index % picture.size.x, index / picture.size.x);
        let threshold = x.wrapping_mul(3_242_174_889).wrapping_add(y.wrapping_mul(2_447_445_414)) >> 16;
        // Colours of 8 bits are whole here, and stay.
        texel.map(|channel| ((u32::from(channel) * 255 + threshold.min(65534)) / 65535) as u8)
    };
    let texels: Vec<_> = (0..).zip(&picture.texels).flat_map(dither).collect();
    ImageBuffer::from_raw(picture.size.x, picture.size.y, texels)
        .map_or_else(DynamicImage::default, DynamicImage::ImageRgb8)
}

#[cfg(test)]
mod tests;
