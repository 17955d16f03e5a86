//! Bakes a ramp from gradient stops.

use std::path::Path;

use glam::{UVec2, Vec3};
use image::{DynamicImage, ImageBuffer};

use crate::assets::json;
use crate::assets::picture::{MAX_BYTES, MAX_SIDE, Picture};
use crate::error::{Error, FieldError, one_line};
use crate::formula::colour::{linear_from_srgb, srgb_from_linear};
use crate::settings::{FieldVisitor, Fields, validate};

/// The version of the recipe format that this code writes and reads.
pub const RECIPE_VERSION: u32 = 1;

/// How a ramp was made: the contents of a `*.ramp.json`.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "app", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RampRecipe {
    /// Format version.
    pub version: u32,
    /// Texels across.
    pub width: u32,
    /// Texels up: 1 for a ramp of one axis.
    pub height: u32,
    /// Gradients along the second axis, from 0 to 1. One row for a ramp of one axis.
    pub rows: Vec<RampRow>,
}

/// One gradient.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "app", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RampRow {
    /// Place on the second axis, 0 to 1, ascending.
    #[serde(default)]
    pub at: f32,
    /// The gradient's colours, from 0 to 1.
    pub stops: Vec<RampStop>,
}

/// One colour of a gradient.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "app", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RampStop {
    /// Place on the first axis, 0 to 1, ascending.
    pub at: f32,
    /// sRGB, `#rrggbb`.
    pub colour: HexColour,
}

/// An sRGB colour, `#rrggbb` in JSON.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "app", derive(schemars::JsonSchema), schemars(with = "String"))]
#[serde(try_from = "String", into = "String")]
pub struct HexColour(pub [u8; 3]);

impl HexColour {
    /// Linear RGB, 0..1.
    pub fn linear(self) -> Vec3 {
        Vec3::from(self.0.map(|channel| linear_from_srgb(f32::from(channel) / 255.0)))
    }
}

/// A linear colour as a texel of a ramp's picture.
pub(super) fn srgb16_from_linear(colour: Vec3) -> [u16; 3] {
    colour.to_array().map(|channel| (srgb_from_linear(channel.clamp(0.0, 1.0)) * 65535.0).round() as u16)
}

/// The picture to write of sRGB texels.
pub(super) fn image_of(picture: Picture<[u16; 3]>) -> DynamicImage {
    // A texel for every pixel, so never empty.
    ImageBuffer::from_raw(picture.size.x, picture.size.y, picture.texels.into_flattened())
        .map_or_else(DynamicImage::default, DynamicImage::ImageRgb16)
}

impl TryFrom<String> for HexColour {
    /// What is wrong; the field is known to whoever asks.
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        // `from_str_radix` takes a sign too.
        let is_hex = |digits: &&str| digits.len() == 6 && digits.bytes().all(|digit| digit.is_ascii_hexdigit());
        let digits = text.strip_prefix('#').filter(is_hex).and_then(|digits| u32::from_str_radix(digits, 16).ok());
        match digits.map(u32::to_be_bytes) {
            Some([_, r, g, b]) => Ok(Self([r, g, b])),
            None => {
                Err(format!("{} is not valid; expected an sRGB colour, \"#rrggbb\"", one_line(format!("{text:?}"))))
            }
        }
    }
}

impl From<HexColour> for String {
    fn from(HexColour([r, g, b]): HexColour) -> Self {
        format!("#{r:02x}{g:02x}{b:02x}")
    }
}

impl Fields for RampRecipe {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.integer("version", &mut self.version, RECIPE_VERSION..=RECIPE_VERSION, "");
        visitor.integer("width", &mut self.width, 2..=MAX_SIDE, "texels");
        // What is baked must be readable again: three channels of 16 bits.
        let most = MAX_BYTES as u32 / 6 / self.width.max(1);
        visitor.integer("height", &mut self.height, 1..=most.min(MAX_SIDE), "texels");
        for (index, row) in self.rows.iter_mut().enumerate() {
            visitor.item("rows", index, row);
        }
    }
}

impl Fields for RampRow {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.number("at", &mut self.at, 0.0..=1.0, "");
        for (index, stop) in self.stops.iter_mut().enumerate() {
            visitor.item("stops", index, stop);
        }
    }
}

impl Fields for RampStop {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.number("at", &mut self.at, 0.0..=1.0, "");
        visitor.srgb("colour", &mut self.colour.0);
    }
}

impl RampRecipe {
    /// Reads a `*.ramp.json`.
    ///
    /// # Errors
    /// [`Error::Io`], [`Error::Json`] or [`Error::JsonField`].
    pub fn load(path: &Path) -> Result<Self, Error> {
        json::load(path, RECIPE_VERSION, Self::validate)
    }

    /// Checks ranges and the order of rows and stops.
    ///
    /// # Errors
    /// The first field that is not valid.
    pub fn validate(&self) -> Result<(), FieldError> {
        validate(self, String::new)?;
        ascending("rows", self.rows.iter().map(|row| row.at))?;
        for (index, row) in self.rows.iter().enumerate() {
            ascending(&format!("rows[{index}].stops"), row.stops.iter().map(|stop| stop.at))?;
        }
        Ok(())
    }

    /// The colour at a place, linear RGB. Between stops and rows a monotone curve in Oklab: even steps to the eye, and no
    /// crease that light would show as a band.
    ///
    /// # Errors
    /// As [`RampRecipe::validate`].
    pub fn sample(&self, u: f32, v: f32) -> Result<Vec3, FieldError> {
        self.validate()?;
        Ok(Gradient::new(self).sample(u, v))
    }

    /// Bakes the picture: sRGB, 16 bits a channel, the row for 0 at the bottom.
    ///
    /// # Errors
    /// As [`RampRecipe::validate`].
    pub fn bake(&self) -> Result<DynamicImage, FieldError> {
        self.validate()?;
        let gradient = Gradient::new(self);
        let size = UVec2::new(self.width, self.height);
        let last = (size - 1).max(UVec2::ONE).as_vec2();
        let mut picture = Picture::new(size, [0; 3]);
        picture.for_each(|at, texel| {
            *texel = srgb16_from_linear(gradient.sample(at.x as f32 / last.x, (size.y - 1 - at.y) as f32 / last.y));
        });
        Ok(image_of(picture))
    }
}

/// A recipe made ready to be asked for many texels: its colours in Oklab.
struct Gradient {
    rows: Vec<(f32, Vec<(f32, Vec3)>)>,
}

impl Gradient {
    fn new(recipe: &RampRecipe) -> Self {
        let stop = |stop: &RampStop| (stop.at, oklab_from_linear(stop.colour.linear()));
        Self { rows: recipe.rows.iter().map(|row| (row.at, row.stops.iter().map(stop).collect())).collect() }
    }

    fn sample(&self, u: f32, v: f32) -> Vec3 {
        // The curve between two rows looks at one row more on either side.
        let next = self.rows.partition_point(|&(at, _)| at <= v);
        let near = &self.rows[next.saturating_sub(2)..self.rows.len().min(next + 2)];
        let rows: Vec<_> = near.iter().map(|(at, stops)| (*at, monotone_curve(stops, u))).collect();
        linear_from_oklab(monotone_curve(&rows, v)).max(Vec3::ZERO)
    }
}

fn ascending(field: &str, places: impl Iterator<Item = f32>) -> Result<(), FieldError> {
    let places: Vec<f32> = places.collect();
    if places.is_empty() {
        return Err(FieldError::new(field, "[]", "at least one entry"));
    }
    for (index, &at) in places.iter().enumerate() {
        let after = if index == 0 { 0.0 } else { places[index - 1] };
        let ascends = (0.0..=1.0).contains(&at) && (index == 0 || at > after);
        if !ascends {
            let expected = format!("0 to 1 and more than the entry before, {after}");
            return Err(FieldError::new(format!("{field}[{index}].at"), at, expected));
        }
    }
    Ok(())
}

/// Cubic through the points that never overshoots them; constant outside. (Fritsch and Carlson, "Monotone piecewise cubic
/// interpolation", 1980, with the harmonic mean of the slopes)
fn monotone_curve(points: &[(f32, Vec3)], x: f32) -> Vec3 {
    let next = points.partition_point(|&(at, _)| at <= x);
    let (Some(&(x0, y0)), Some(&(x1, y1))) = (points.get(next.wrapping_sub(1)), points.get(next)) else {
        let end = if next == 0 { points.first() } else { points.last() };
        return end.map_or(Vec3::ZERO, |&(_, y)| y);
    };
    let secant = |a: usize, b: usize| {
        let (&(xa, ya), &(xb, yb)) = (points.get(a)?, points.get(b)?);
        // Steeper than this no picture can show, and products of slopes stay far from overflow.
        Some((yb - ya) / (xb - xa).max(1.0e-6))
    };
    let tangent = |at: usize| match (secant(at.wrapping_sub(1), at), secant(at, at + 1)) {
        (Some(before), Some(after)) => {
            let harmonic = |a: f32, b: f32| if a * b > 0.0 { 2.0 * a * b / (a + b) } else { 0.0 };
            Vec3::new(harmonic(before.x, after.x), harmonic(before.y, after.y), harmonic(before.z, after.z))
        }
        // Flat ends: a ramp is held constant beyond them.
        _ => Vec3::ZERO,
    };
    let h = x1 - x0;
    let t = (x - x0) / h;
    let (t2, t3) = (t * t, t * t * t);
    y0 * (2.0 * t3 - 3.0 * t2 + 1.0)
        + y1 * (3.0 * t2 - 2.0 * t3)
        + tangent(next - 1) * (h * (t3 - 2.0 * t2 + t))
        + tangent(next) * (h * (t3 - t2))
}

/// (Ottosson, "A perceptual color space for image processing", 2020)
fn oklab_from_linear(c: Vec3) -> Vec3 {
    let l = (0.412_221_46 * c.x + 0.536_332_55 * c.y + 0.051_445_995 * c.z).cbrt();
    let m = (0.211_903_5 * c.x + 0.680_699_5 * c.y + 0.107_396_96 * c.z).cbrt();
    let s = (0.088_302_46 * c.x + 0.281_718_85 * c.y + 0.629_978_7 * c.z).cbrt();
    Vec3::new(
        0.210_454_26 * l + 0.793_617_8 * m - 0.004_072_047 * s,
        1.977_998_5 * l - 2.428_592_2 * m + 0.450_593_7 * s,
        0.025_904_037 * l + 0.782_771_77 * m - 0.808_675_77 * s,
    )
}

fn linear_from_oklab(lab: Vec3) -> Vec3 {
    let l = lab.x + 0.396_337_78 * lab.y + 0.215_803_76 * lab.z;
    let m = lab.x - 0.105_561_346 * lab.y - 0.063_854_17 * lab.z;
    let s = lab.x - 0.089_484_18 * lab.y - 1.291_485_5 * lab.z;
    let (l, m, s) = (l * l * l, m * m * m, s * s * s);
    Vec3::new(
        4.076_741_7 * l - 3.307_711_6 * m + 0.230_969_94 * s,
        -1.268_438 * l + 2.609_757_4 * m - 0.341_319_4 * s,
        -0.004_196_086_3 * l - 0.703_418_6 * m + 1.707_614_7 * s,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recipe(stops: &[(f32, &str)]) -> RampRecipe {
        let stop = |&(at, colour): &(f32, &str)| RampStop { at, colour: colour.to_owned().try_into().unwrap() };
        let stops = stops.iter().map(stop).collect();
        RampRecipe { version: 1, width: 64, height: 1, rows: vec![RampRow { at: 0.0, stops }] }
    }

    #[test]
    fn stops_come_out_as_they_went_in() {
        let recipe = recipe(&[(0.0, "#102030"), (0.3, "#ff8040"), (1.0, "#ffffff")]);
        for stop in &recipe.rows[0].stops {
            let colour = recipe.sample(stop.at, 0.0).unwrap();
            for (channel, expected) in colour.to_array().into_iter().zip(stop.colour.0) {
                assert!((srgb_from_linear(channel) * 255.0 - f32::from(expected)).abs() < 0.5, "{colour}");
            }
        }
        let picture = recipe.bake().unwrap().to_rgb8();
        assert_eq!(picture.get_pixel(0, 0).0, [0x10, 0x20, 0x30]);
        assert_eq!(picture.get_pixel(63, 0).0, [255, 255, 255]);
    }

    #[test]
    fn the_curve_never_overshoots() {
        let recipe = recipe(&[(0.0, "#000000"), (0.5, "#000000"), (0.55, "#ffffff"), (1.0, "#ffffff")]);
        let mut last = 0.0;
        for step in 0..=400 {
            let grey = recipe.sample(step as f32 / 400.0, 0.0).unwrap().y;
            assert!(grey >= last - 1e-5 && grey <= 1.0 + 1e-4, "{step}: {grey} after {last}");
            last = grey;
        }
    }

    #[test]
    fn stops_that_all_but_meet_are_an_edge() {
        for gap in [f32::from_bits(1), 1.0e-20, 1.0e-7] {
            let recipe = recipe(&[(0.0, "#000000"), (gap, "#404040"), (2.0 * gap, "#808080"), (1.0, "#ffffff")]);
            for u in [0.0, gap / 2.0, gap, 1.5 * gap, 2.0 * gap, 3.0 * gap, 0.5] {
                let colour = recipe.sample(u, 0.0).unwrap();
                assert!(colour.is_finite() && colour.max_element() < 1.001, "{gap:e} {u:e}: {colour}");
            }
            assert!(recipe.sample(0.5, 0.0).unwrap().x > 0.05);
        }
    }

    #[test]
    fn many_stops_and_rows_take_little_longer_than_few() {
        let rows = |rows: u32, stops: u32| {
            let place = |index: u32, count: u32| index as f32 / count as f32;
            let stop = |index| RampStop { at: place(index, stops), colour: HexColour([index as u8; 3]) };
            let stops: Vec<_> = (0..stops).map(stop).collect();
            let row = |index| RampRow { at: place(index, rows), stops: stops.clone() };
            RampRecipe { version: 1, width: 1024, height: 256, rows: (0..rows).map(row).collect() }
        };
        let started = std::time::Instant::now();
        rows(1, 100_000).bake().unwrap();
        rows(2_000, 20).bake().unwrap();
        // Tenths of a second; texels times stops or times rows would be minutes.
        assert!(started.elapsed().as_secs() < 20, "{:?}", started.elapsed());
    }

    #[test]
    fn rows_far_off_do_not_matter() {
        let mut tall = recipe(&[(0.0, "#102030"), (1.0, "#ff8040")]);
        let stops = |colour: &str| vec![RampStop { at: 0.0, colour: colour.to_owned().try_into().unwrap() }];
        let colours = ["#000000", "#404040", "#505050", "#606060", "#ffffff"];
        let row = |(index, colour): (usize, &&str)| RampRow { at: index as f32 / 4.0, stops: stops(colour) };
        tall.rows = colours.iter().enumerate().map(row).collect();
        // The same curve as along one row.
        let long = recipe(&[0, 1, 2, 3, 4].map(|index| (index as f32 / 4.0, colours[index])));
        for step in 0..=64 {
            let at = step as f32 / 64.0;
            assert_eq!(tall.sample(0.3, at).unwrap(), long.sample(at, 0.0).unwrap(), "{at}");
        }
    }

    #[test]
    fn what_is_baked_can_be_read_again() {
        let mut large = recipe(&[(0.0, "#102030")]);
        (large.width, large.height) = (4096, 4096);
        let error = large.validate().unwrap_err().to_string();
        assert_eq!(error, "height: 4096 is not valid; expected 1 to 2730 texels");
        large.height = 2730;
        let mut png = Vec::new();
        let baked = large.bake().unwrap();
        baked.write_to(&mut std::io::Cursor::new(&mut png), image::ImageFormat::Png).unwrap();
        assert_eq!(crate::assets::picture::decode_png(Path::new("large.png"), &png).unwrap().height(), 2730);
    }

    #[test]
    fn stops_out_of_order_and_bad_colours_are_named() {
        let error = recipe(&[(0.5, "#000000"), (0.2, "#ffffff")]).validate().unwrap_err();
        assert_eq!(error.field, "rows[0].stops[1].at");
        assert_eq!(recipe(&[]).validate().unwrap_err().field, "rows[0].stops");
        assert!(HexColour::try_from("red".to_owned()).unwrap_err().contains("#rrggbb"));
        for bad in ["#12é45", "#+1+2+3", "#12345", "#1234567", "123456", "#12 456"] {
            assert!(HexColour::try_from(bad.to_owned()).is_err(), "{bad}");
        }
        assert_eq!(HexColour::try_from("#0aFf80".to_owned()), Ok(HexColour([0x0a, 0xff, 0x80])));
    }
}
