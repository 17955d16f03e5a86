//! JSON files with a `version` field. Newer versions are refused; errors name line, column and field.

mod serde_messages;

use std::path::Path;

use serde::de::DeserializeOwned;

use super::bounded_read;
use super::image::is_png;
use crate::error::{AssetError, FieldError};

/// Size limit of most JSON files, bytes. A preset has a few thousand.
pub const MAX_BYTES: u64 = 1 << 20;

/// Parses `text`. `path` is used only in errors.
///
/// # Errors
/// [`AssetError::Text`] with line, column and field, naming what was expected.
pub fn parse<T: DeserializeOwned>(path: &Path, text: &str) -> Result<T, AssetError> {
    let mut json = serde_json::Deserializer::from_str(text);
    let parsed = serde_path_to_error::deserialize(&mut json).map_err(|error| {
        // "." is the whole file, "?" a field that has no name yet.
        (error.path().to_string().trim_end_matches(['.', '?']).to_owned(), error.into_inner())
    });
    let whole = parsed.and_then(|value| json.end().map(|()| value).map_err(|error| (String::new(), error)));
    whole.map_err(|(field, error)| {
        // Strips " at line …" from serde_json's message: the error has line and column already.
        let message = error.to_string();
        let message = message.rsplit_once(" at line ").map_or(message.as_str(), |(message, _)| message);
        // For an unknown field, serde's path includes the unknown name; the error names its parent.
        let unknown = message.strip_prefix("unknown field `").and_then(|rest| rest.rsplit_once("`, expected "));
        let field = field.strip_suffix(unknown.map_or("", |(name, _)| name)).unwrap_or(&field).trim_end_matches('.');
        let line = error.line().max(1);
        let column = error.column().max(1);
        let rest = text.split('\n').nth(line - 1).and_then(|text| text.get(column - 1..));
        let reason = serde_messages::translate(message, field, rest.unwrap_or_default());
        AssetError::Text { path: path.into(), line, column, reason }
    })
}

/// Decodes and parses UTF-8. `path` is used only in errors.
///
/// # Errors
/// As [`parse`], also for other text.
pub fn decode<T: DeserializeOwned>(path: &Path, bytes: &[u8]) -> Result<T, AssetError> {
    parse(path, text(path, bytes)?)
}

/// Converts a value that is parsed already.
///
/// # Errors
/// The reason, with the field.
pub fn from_value<T: DeserializeOwned>(value: serde_json::Value) -> Result<T, String> {
    serde_path_to_error::deserialize(value).map_err(|error| {
        let field = error.path().to_string();
        serde_messages::translate(&error.into_inner().to_string(), field.trim_end_matches(['.', '?']), "")
    })
}

/// Parses a file with a `version` from 1 to `newest`. The version is checked before any other field is parsed.
///
/// # Errors
/// [`AssetError::Text`].
pub fn parse_versioned<T: DeserializeOwned>(path: &Path, text: &str, newest: u32) -> Result<T, AssetError> {
    #[derive(serde::Deserialize)]
    #[serde(expecting = "an object with a \"version\"")]
    struct Versioned {
        version: u32,
    }
    let Versioned { version } = parse(path, text)?;
    if version == 0 || version > newest {
        let (line, column) = key_position(text, "\"version\"");
        let reason = if version == 0 {
            format!("version 0 does not exist; expected 1 to {newest}")
        } else {
            format!("version {version} is newer than this program, which reads up to {newest}; update haze")
        };
        return Err(AssetError::Text { path: path.into(), line, column, reason });
    }
    parse(path, text)
}

/// Reads, parses and validates a versioned file of at most [`MAX_BYTES`].
///
/// # Errors
/// [`AssetError::Io`], [`AssetError::Text`], or [`AssetError::JsonField`] if `validate` fails.
pub fn load<T: DeserializeOwned>(
    path: &Path,
    newest: u32,
    validate: impl FnOnce(&T) -> Result<(), FieldError>,
) -> Result<T, AssetError> {
    let value = parse_versioned(path, &read(path, MAX_BYTES)?, newest)?;
    validate(&value).map_err(|error| AssetError::JsonField { path: path.into(), error })?;
    Ok(value)
}

/// Reads the text of a file of at most `max_bytes` bytes.
///
/// # Errors
/// [`AssetError::Io`], or [`AssetError::Text`] if the file is not UTF-8 text.
pub fn read(path: &Path, max_bytes: u64) -> Result<String, AssetError> {
    text(path, &bounded_read::read(path, "JSON file", max_bytes)?).map(str::to_owned)
}

/// Decodes UTF-8. The error names the kind of file if it is a PNG or UTF-16.
fn text<'a>(path: &Path, bytes: &'a [u8]) -> Result<&'a str, AssetError> {
    let refuse = |(line, column), reason: &str| {
        Err(AssetError::Text {
            path: path.into(),
            line,
            column,
            reason: format!("{reason}; expected JSON as UTF-8 text"),
        })
    };
    if is_png(bytes) {
        return refuse((1, 1), "a PNG image");
    }
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return refuse((1, 1), "text in UTF-16");
    }
    // Some editors write a byte order mark.
    let bytes = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(bytes);
    std::str::from_utf8(bytes).or_else(|error| {
        let before = String::from_utf8_lossy(&bytes[..error.valid_up_to()]);
        refuse(position_after(&before), "not UTF-8")
    })
}

/// Returns the 1-based line and column of the position after `before`.
fn position_after(before: &str) -> (usize, usize) {
    (before.matches('\n').count() + 1, before.len() - before.rfind('\n').map_or(0, |at| at + 1) + 1)
}

/// Returns the 1-based line and column of the first occurrence of `key`.
fn key_position(text: &str, key: &str) -> (usize, usize) {
    position_after(&text[..text.find(key).unwrap_or(0)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Sample {
        #[serde(rename = "version")]
        _version: u32,
        #[serde(rename = "boost")]
        _boost: f32,
    }

    fn message(text: &str) -> String {
        parse_versioned::<Sample>(Path::new("a.json"), text, 1).unwrap_err().to_string()
    }

    #[test]
    fn errors_name_the_position_and_the_expected_value() {
        parse_versioned::<Sample>(Path::new("a.json"), "{\"version\": 1, \"boost\": 3}", 1).unwrap();
        let unknown = message("{\"version\": 1, \"boost\": 3,\n  \"bost\": 4}");
        assert!(unknown.starts_with("a.json:2:8: unknown field `bost`; expected `version` or `boost`"), "{unknown}");
        assert!(message("{\"version\": 1}").contains("missing field `boost`"));
        assert!(message("{\"boost\": 1}").contains("missing field `version`"));
        assert!(message("{").starts_with("a.json:1:1: the file ends inside an object"));
    }

    #[test]
    fn serde_errors_are_translated_to_plain_words() {
        #[derive(Debug, serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        #[allow(dead_code, reason = "only read from files")]
        struct Whole {
            count: u32,
            on: bool,
            names: Vec<String>,
            place: glam::Vec3,
            path: crate::settings::RenderPath,
            parts: Vec<Sample>,
        }
        let said = |text: &str| parse::<Whole>(Path::new("a.json"), text).unwrap_err().to_string();
        for (text, expected) in [
            (r#"{"count": "1"}"#, r#"a.json:1:13: count: "1" is not valid; expected a whole number, 0 to 4294967295"#),
            (r#"{"count": -1}"#, "a.json:1:12: count: -1 is not valid; expected a whole number, 0 to 4294967295"),
            (r#"{"count": 1.5}"#, "a.json:1:13: count: 1.5 is not valid; expected a whole number, 0 to 4294967295"),
            (r#"{"on": 1}"#, "a.json:1:8: on: 1 is not valid; expected true or false"),
            (r#"{"names": {}}"#, "a.json:1:10: names: an object is not valid; expected a list"),
            (r#"{"names": ["a", null]}"#, "a.json:1:20: names[1]: null is not valid; expected a text in double quotes"),
            (r#"{"place": [1, 2]}"#, "a.json:1:16: place: a list of 2 is not valid; expected a list of 3 numbers"),
            (r#"{"place": [1, 2, 3, 4]}"#, "a.json:1:21: place: too many entries; expected the list to end here"),
            (
                r#"{"path": "rastre"}"#,
                r#"a.json:1:17: path: "rastre" is not valid; expected one of auto, raster, tiled, forward"#,
            ),
            (r#"{"path": 3}"#, "a.json:1:10: path: not a text; expected a name in double quotes"),
            (
                r#"{"parts": [{"version": 1, "boost": []}]}"#,
                "a.json:1:35: parts[0].boost: a list is not valid; expected a number",
            ),
            (r#"{"parts": [3]}"#, "a.json:1:12: parts[0]: 3 is not valid; expected an object"),
            (
                r#"{"parts": [{"bost": 1}]}"#,
                "a.json:1:18: parts[0]: unknown field `bost`; expected `version` or `boost`",
            ),
            (r#"{"parts": [{"a.b": 1}]}"#, "a.json:1:17: parts[0]: unknown field `a.b`; expected `version` or `boost`"),
            (r#"{"count": 1, "count": 1}"#, "a.json:1:20: duplicate field `count`"),
            (r#"{"count": 1,}"#, "a.json:1:13: a comma before the closing bracket; expected none"),
            (
                r#"{"count": .5}"#,
                "a.json:1:11: count: not a value; expected a number, a text in double quotes, a list or an object",
            ),
            ("{count: 1}", "a.json:1:2: expected a field's name in double quotes"),
            (
                "{\"a\nb\": 1}",
                "a.json:2:1: a line break, tab or control character in a text; expected an escape, for example \\n",
            ),
            (
                r#"{"a\u001b[2J": 1}"#,
                r"a.json:1:13: unknown field `a\u{1b}[2J`; expected one of `count`, `on`, `names`, `place`, `path`, `parts`",
            ),
        ] {
            assert_eq!(said(text), expected, "{text}");
        }
        let text = r#"{"version": 1, "boost": 2} x"#;
        assert!(
            message(text).starts_with("a.json:1:28: more text after the end; expected nothing"),
            "{}",
            message(text)
        );
        // A very long value is shortened; the expected value is still printed.
        let long = said(&format!("{{\"count\": \"{}\"}}", "x".repeat(1 << 20)));
        assert!(long.len() < 300 && long.ends_with("expected a whole number, 0 to 4294967295"), "{long}");
    }

    #[test]
    fn a_newer_version_is_refused_before_other_fields_are_parsed() {
        let newer = message("{\n  \"version\": 2, \"tint\": []}");
        assert!(newer.starts_with("a.json:2:3: version 2 is newer"), "{newer}");
        assert!(message("{\"version\": 0}").contains("expected 1 to 1"));
    }
}
