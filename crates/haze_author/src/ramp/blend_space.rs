//! Colors of gradients: hexadecimal notation, and conversion to and from the blend spaces. Uses only
//! `deterministic_math.rs` for powers, so bakes are bit-identical on every machine.

use glam::Vec3;
use haze_core::error::one_line;
use haze_core::settings::choice;

use crate::deterministic_math::{power, power_f64};

choice! {
    /// Color space in which a gradient is blended.
    Blend {
        /// Perceptually even; stays colorful between complementary colors.
        #[default]
        Oklab = "oklab",
        /// Linear light: bright colors dominate. Blender's ramps blend this way.
        Linear = "linear",
        /// sRGB code values. Most paint programs blend this way.
        Srgb = "srgb",
        /// HSV, along the shorter arc of hues.
        HsvNear = "hsv_near",
        /// HSV, along the longer arc of hues. Equal hues stay.
        HsvFar = "hsv_far",
    }
}

/// An sRGB color, `#rrggbb` in JSON.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(with = "String"))]
#[serde(try_from = "String", into = "String")]
pub struct HexColor(pub [u8; 3]);

impl HexColor {
    /// Returns linear RGB, 0..1.
    pub fn linear(self) -> Vec3 {
        self.srgb().map(linear_from_srgb)
    }

    /// Returns the sRGB code, 0..1.
    pub fn srgb(self) -> Vec3 {
        Vec3::from(self.0.map(|channel| f32::from(channel) / 255.0))
    }

    /// Returns hue in turns, saturation and value of the sRGB code, each 0..1.
    pub fn hsv(self) -> Vec3 {
        let hsv = hsv_from_rgb(self.srgb());
        hsv.with_x(hsv.x.rem_euclid(1.0))
    }

    /// Rounds a hue in turns, saturation and value to the nearest color.
    pub fn from_hsv(hsv: Vec3) -> Self {
        Self::from_srgb(rgb_from_hsv(hsv))
    }

    /// Rounds an sRGB code, 0..1, to the nearest color. Values outside are clamped.
    pub fn from_srgb(code: Vec3) -> Self {
        Self(code.to_array().map(|channel| (channel * 255.0).round() as u8))
    }
}

impl TryFrom<String> for HexColor {
    /// Message without the field's name; the caller adds it.
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        // `from_str_radix` would also accept a sign.
        let is_hex = |digits: &&str| digits.len() == 6 && digits.bytes().all(|digit| digit.is_ascii_hexdigit());
        let digits = text.strip_prefix('#').filter(is_hex).and_then(|digits| u32::from_str_radix(digits, 16).ok());
        match digits.map(u32::to_be_bytes) {
            Some([_, r, g, b]) => Ok(Self([r, g, b])),
            None => Err(format!("{} is not valid; expected an sRGB color, \"#rrggbb\"", one_line(format!("{text:?}")))),
        }
    }
}

impl From<HexColor> for String {
    fn from(HexColor([r, g, b]): HexColor) -> Self {
        format!("#{r:02x}{g:02x}{b:02x}")
    }
}

impl Blend {
    pub(super) fn is_default(&self) -> bool {
        *self == Self::default()
    }

    /// True if the first component is a hue, in turns.
    pub(super) fn has_hue(self) -> bool {
        matches!(self, Self::HsvNear | Self::HsvFar)
    }

    /// Converts a color to the blend space.
    pub(super) fn of(self, color: HexColor) -> Vec3 {
        self.of_code(color.srgb())
    }

    /// Converts an sRGB code, 0..1, to the blend space.
    pub(super) fn of_code(self, code: Vec3) -> Vec3 {
        match self {
            Self::Oklab => oklab_from_linear(code.map(linear_from_srgb)),
            Self::Linear => code.map(linear_from_srgb),
            Self::Srgb => code,
            Self::HsvNear | Self::HsvFar => hsv_from_rgb(code),
        }
    }

    /// Converts from the blend space to linear RGB, at least 0.
    pub(super) fn linear(self, blended: Vec3) -> Vec3 {
        let linear = match self {
            Self::Oklab => linear_from_oklab(blended),
            Self::Linear => blended,
            Self::Srgb => blended.map(linear_from_srgb),
            Self::HsvNear | Self::HsvFar => rgb_from_hsv(blended).map(linear_from_srgb),
        };
        linear.max(Vec3::ZERO)
    }
}

/// Encodes a linear color as a texel of a ramp's image: sRGB, 16 bits per channel.
pub(super) fn srgb16_from_linear(color: Vec3) -> [u16; 3] {
    color.to_array().map(|channel| (srgb_from_linear(channel.clamp(0.0, 1.0)) * 65535.0).round() as u16)
}

/// Same as [`haze_core::formula::color::linear_from_srgb`], but bit-identical on every machine.
fn linear_from_srgb(encoded: f32) -> f32 {
    if encoded <= 0.04045 { encoded / 12.92 } else { power((encoded + 0.055) / 1.055, 2.4) }
}

/// Same as [`haze_core::formula::color::srgb_from_linear`], but bit-identical on every machine.
pub(super) fn srgb_from_linear(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * power(linear, 1.0 / 2.4) - 0.055 }
}

/// Converts linear RGB to Oklab. (Ottosson, "A perceptual color space for image processing", 2020)
pub(super) fn oklab_from_linear(c: Vec3) -> Vec3 {
    let root = |x: f32| power_f64(x, 1.0 / 3.0) as f32;
    let l = root(0.412_221_46 * c.x + 0.536_332_55 * c.y + 0.051_445_995 * c.z);
    let m = root(0.211_903_5 * c.x + 0.680_699_5 * c.y + 0.107_396_96 * c.z);
    let s = root(0.088_302_46 * c.x + 0.281_718_85 * c.y + 0.629_978_7 * c.z);
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
    let l = l * l * l;
    let m = m * m * m;
    let s = s * s * s;
    Vec3::new(
        4.076_741_7 * l - 3.307_711_6 * m + 0.230_969_94 * s,
        -1.268_438 * l + 2.609_757_4 * m - 0.341_319_4 * s,
        -0.004_196_086_3 * l - 0.703_418_6 * m + 1.707_614_7 * s,
    )
}

/// Converts to hue in turns, saturation and value.
fn hsv_from_rgb(c: Vec3) -> Vec3 {
    let value = c.max_element();
    let least = c.min_element();
    let range = value - least;
    let saturation = if value > 0.0 { range / value } else { 0.0 };
    let sixth = match () {
        () if range <= 0.0 => 0.0,
        () if c.x >= value => (c.y - c.z) / range,
        () if c.y >= value => (c.z - c.x) / range + 2.0,
        () => (c.x - c.y) / range + 4.0,
    };
    Vec3::new(sixth / 6.0, saturation, value)
}

pub(super) fn rgb_from_hsv(c: Vec3) -> Vec3 {
    let sixth = (c.x - c.x.floor()) * 6.0;
    let pure = Vec3::new((sixth - 3.0).abs() - 1.0, 2.0 - (sixth - 2.0).abs(), 2.0 - (sixth - 4.0).abs());
    c.z * (Vec3::ONE + c.y * (pure.clamp(Vec3::ZERO, Vec3::ONE) - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_blend_space_round_trips() {
        for blend in Blend::ALL.iter().copied() {
            for code in 0..4096_u32 {
                let color = HexColor([code % 16, code / 16 % 16, code / 256].map(|channel| (channel * 17) as u8));
                let linear = blend.linear(blend.of(color));
                let back = HexColor::from_srgb(linear.map(srgb_from_linear));
                assert_eq!(back, color, "{}", blend.name());
                assert_eq!(HexColor::from_hsv(color.hsv()), color);
                assert!((0.0..1.0).contains(&color.hsv().x), "{color:?}");
                assert!(
                    srgb16_from_linear(linear).iter().zip(color.0).all(|(&a, b)| a.abs_diff(u16::from(b) * 257) < 4)
                );
            }
        }
    }
}
