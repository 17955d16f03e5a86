//! Values as text for display and input.

use glam::Vec3;
use haze_core::settings::FieldValue;

use crate::document::display_names::display_name;

/// Formats a number with four significant digits, without trailing zeros.
pub fn shown(value: f64) -> String {
    let digits = if value == 0.0 { 0 } else { (3 - value.abs().log10().floor() as i32).clamp(0, 4) as usize };
    let text = format!("{value:.digits$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".into() } else { text.into() }
}

/// Formats a large integer with its digits in groups of three.
pub fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let groups = digits.as_bytes().rchunks(3).rev().map(String::from_utf8_lossy);
    groups.collect::<Vec<_>>().join("\u{2009}")
}

/// Formats the value of a field with its unit.
pub fn shown_value(value: &FieldValue, unit: &str) -> String {
    let list = |vector: &Vec3| vector.to_array().map(|axis| shown(f64::from(axis))).join(", ");
    match value {
        FieldValue::Number(number) => shown(f64::from(*number)) + &suffix(unit),
        FieldValue::Whole(number) => number.to_string() + &suffix(unit),
        FieldValue::Curve(curve) => curve.to_string(),
        FieldValue::Vector(vector) => list(vector) + &suffix(unit),
        FieldValue::Flag(flag) => if *flag { "on" } else { "off" }.into(),
        FieldValue::Choice(name) => display_name(name),
        FieldValue::Text(text) if text.is_empty() => "none".into(),
        FieldValue::Text(text) => text.clone(),
    }
}

pub fn suffix(unit: &str) -> String {
    match unit {
        "" => String::new(),
        "degrees" => "°".into(),
        "half sides" => " × half size".into(),
        "pixels" => " px".into(),
        unit => format!(" {unit}"),
    }
}

/// Parses a typed number, with or without its unit. Infinite values and NaN are refused.
pub fn parse(text: &str, unit: &str) -> Option<f64> {
    let text = text.trim();
    let text = text.strip_suffix(unit).or(text.strip_suffix(suffix(unit).trim())).unwrap_or(text).trim();
    text.parse().ok().filter(|number: &f64| number.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_numbers_are_grouped_by_three_digits() {
        for (number, text) in [(0, "0"), (999, "999"), (1000, "1 000"), (3_714_705, "3 714 705")] {
            assert_eq!(grouped(number).replace('\u{2009}', " "), text);
        }
    }

    #[test]
    fn numbers_are_shown_without_needless_digits() {
        for (value, text) in [
            (0.0, "0"),
            (34.0, "34"),
            (0.05, "0.05"),
            (1.0 / 3.0, "0.3333"),
            (-2.5, "-2.5"),
            (12345.6, "12346"),
            (-1.0e-6, "0"),
        ] {
            assert_eq!(shown(value), text);
        }
    }

    #[test]
    fn values_are_shown_with_their_units() {
        for (value, unit, text) in [
            (FieldValue::Number(0.25), "m", "0.25 m"),
            (FieldValue::Number(35.0), "degrees", "35°"),
            (FieldValue::Whole(4), "", "4"),
            (FieldValue::Vector(Vec3::new(1.0, -0.5, 0.0)), "m/s", "1, -0.5, 0 m/s"),
            (FieldValue::Flag(true), "", "on"),
            (FieldValue::Choice("depth_sprite_soft"), "", "Depth sprite soft"),
            (FieldValue::Text(String::new()), "", "none"),
        ] {
            assert_eq!(shown_value(&value, unit), text);
        }
    }

    #[test]
    fn numbers_can_be_typed_with_or_without_a_unit() {
        assert_eq!(parse(" 2.5 m/s ", "m/s"), Some(2.5));
        assert_eq!(parse("1e-3", ""), Some(0.001));
        assert_eq!(parse("0.2 × half size", "half sides"), Some(0.2));
        assert_eq!(parse("0.2 half sides", "half sides"), Some(0.2));
        assert_eq!((parse("35°", "degrees"), parse("35 degrees", "degrees")), (Some(35.0), Some(35.0)));
        for wrong in ["nan", "inf", "2,5", "", "m/s", "two"] {
            assert_eq!(parse(wrong, "m/s"), None, "{wrong}");
        }
    }
}
