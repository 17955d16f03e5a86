//! Clipboard text of a row's stops, in the format of a recipe.

use std::path::Path;

use haze_author::ramp::gradient::check_not_empty;
use haze_author::ramp::{HexColor, RampRow, RampStop};
use haze_core::assets::json;
use haze_core::error::AssetError;
use haze_core::settings::validate;

/// Returns the row as JSON, as in a recipe.
pub fn to_json(row: &RampRow) -> String {
    // Numbers and strings only, so serialisation cannot fail.
    serde_json::to_string_pretty(row).unwrap_or_default()
}

/// Parses a color: `#rrggbb` or `rrggbb`.
pub fn color(text: &str) -> Result<HexColor, String> {
    let text = text.trim();
    HexColor::try_from(format!("#{text}")).or_else(|_| HexColor::try_from(text.to_owned()))
}

/// Parses the stops of a copied row and sorts them.
pub fn parse(text: &str) -> Result<Vec<RampStop>, AssetError> {
    let path = Path::new("pasted text");
    let mut row: RampRow = json::parse(path, text)?;
    let valid = validate(&row, String::new).and_then(|()| check_not_empty("stops", &row.stops));
    valid.map_err(|error| AssetError::JsonField { path: path.into(), error })?;
    super::stop_operations::sort(&mut row.stops);
    Ok(row.stops)
}

#[cfg(test)]
mod tests {
    use super::*;
    use haze_author::ramp::{Curve, HexColor};

    #[test]
    fn copied_stops_are_pasted_unchanged() {
        let stops = vec![
            RampStop::new(0.0, HexColor([255, 240, 210])),
            RampStop { curve: Curve::Constant, ..RampStop::new(0.3, HexColor([1, 2, 3])) },
            RampStop::new(0.3, HexColor([0; 3])),
        ];
        let row = RampRow { at: 0.5, curve: Curve::Ease, stops };
        assert_eq!(parse(&to_json(&row)).unwrap(), row.stops);
    }

    #[test]
    fn a_color_may_be_written_without_the_hash_sign() {
        for text in ["#ff8000", " FF8000\n"] {
            assert_eq!(color(text), Ok(HexColor([255, 128, 0])));
        }
        for text in ["##ff8000", "ff800", "#ff80000", "+f8000"] {
            assert!(color(text).unwrap_err().starts_with(&format!("{text:?} is not valid")), "{text}");
        }
    }

    #[test]
    fn malformed_rows_are_refused_with_a_message() {
        for (text, said) in [
            ("a word", "pasted text:1:1"),
            (r#"{ "stops": [] }"#, "stops"),
            (r##"{ "stops": [{ "at": 2, "color": "#000000" }] }"##, "stops[0].at"),
            (r##"{ "stops": [{ "at": 1, "color": "black" }] }"##, "#rrggbb"),
        ] {
            let error = parse(text).unwrap_err().to_string();
            assert!(error.contains(said), "{text}: {error}");
        }
    }
}
