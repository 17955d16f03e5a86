//! The color of a black body.

use std::ops::RangeInclusive;

use glam::{Mat3, Vec2, Vec3, vec2, vec3};

/// Temperatures that [`color_of_temperature`] accepts, kelvin.
pub const KELVIN: RangeInclusive<f32> = 1000.0..=15_000.0;

/// Returns the chromaticity u, v (CIE 1960) of a black body. (Krystek, "An algorithm to calculate correlated color
/// temperature", 1985)
#[allow(clippy::excessive_precision, reason = "the digits of the paper")]
fn planckian_uv(kelvin: f32) -> Vec2 {
    let t = kelvin;
    let u = (0.860_117_757 + 1.541_182_54e-4 * t + 1.286_412_12e-7 * t * t)
        / (1.0 + 8.424_202_35e-4 * t + 7.081_451_63e-7 * t * t);
    let v = (0.317_398_726 + 4.228_062_45e-5 * t + 4.204_816_91e-8 * t * t)
        / (1.0 - 2.897_418_16e-5 * t + 1.614_560_53e-7 * t * t);
    vec2(u, v)
}

/// Converts chromaticity u, v (CIE 1960) to x, y (CIE 1931).
fn xy_from_uv(uv: Vec2) -> Vec2 {
    vec2(3.0 * uv.x, 2.0 * uv.y) / (2.0 * uv.x - 8.0 * uv.y + 4.0)
}

/// Converts linear sRGB to CIE XYZ; the columns are those of red, green and blue. (IEC 61966-2-1)
fn xyz_from_rgb() -> Mat3 {
    Mat3::from_cols(
        vec3(0.412_390_8, 0.212_639, 0.019_330_8),
        vec3(0.357_584_3, 0.715_168_7, 0.119_194_8),
        vec3(0.180_480_8, 0.072_192_3, 0.950_532_2),
    )
}

/// Returns the linear RGB color of a black body, brightest channel 1. Warmer than 1900 K, sRGB has no such saturated color;
/// the nearest one is returned.
pub fn color_of_temperature(kelvin: f32) -> Vec3 {
    let xy = xy_from_uv(planckian_uv(kelvin.clamp(*KELVIN.start(), *KELVIN.end())));
    let xyz = vec3(xy.x, xy.y, 1.0 - xy.x - xy.y) / xy.y;
    let rgb = (xyz_from_rgb().inverse() * xyz).max(Vec3::ZERO);
    rgb / rgb.max_element()
}

/// Returns the temperature whose color is nearest to a linear RGB color, kelvin; `None` for colors far from all of them, such
/// as green.
pub fn temperature_of_color(color: Vec3) -> Option<f32> {
    let xyz = xyz_from_rgb() * color;
    let sum = xyz.x + 15.0 * xyz.y + 3.0 * xyz.z;
    if !(sum > 0.0 && sum.is_finite()) {
        return None;
    }
    let uv = vec2(4.0 * xyz.x, 6.0 * xyz.y) / sum;
    let distance = |kelvin: &f32| planckian_uv(*kelvin).distance_squared(uv);
    // Steps of 0.1 %.
    let steps = (0..=2709).map(|step: u16| KELVIN.start() * 1.001_f32.powi(i32::from(step)));
    let nearest = steps.min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
    (distance(&nearest) < 0.02 * 0.02).then_some(nearest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chromaticities_are_those_of_tables() {
        // Illuminant A, and a black body of 6500 K. (CIE 15)
        for (kelvin, x, y) in [(2856.0, 0.4476, 0.4074), (6500.0, 0.3135, 0.3236)] {
            let xy = xy_from_uv(planckian_uv(kelvin));
            assert!(xy.distance(vec2(x, y)) < 1e-3, "{kelvin} K: {xy}");
        }
    }

    #[test]
    fn warm_is_red_and_cold_is_blue() {
        let candle = color_of_temperature(1900.0);
        let day = color_of_temperature(6500.0);
        let sky = color_of_temperature(12_000.0);
        assert!(candle.x > 0.999 && candle.y < 0.3 && candle.z < 0.05, "{candle}");
        assert!(day.min_element() > 0.9, "{day}");
        assert!(sky.z > 0.999 && sky.x < 0.6, "{sky}");
    }

    #[test]
    fn a_color_finds_its_temperature_again() {
        for kelvin in [2000.0, 2700.0, 4000.0, 6500.0, 10_000.0] {
            let found = temperature_of_color(0.3 * color_of_temperature(kelvin)).unwrap();
            assert!((found / kelvin - 1.0).abs() < 0.02, "{kelvin} {found}");
        }
        assert_eq!(temperature_of_color(Vec3::Y), None);
        assert_eq!(temperature_of_color(Vec3::ZERO), None);
    }
}
