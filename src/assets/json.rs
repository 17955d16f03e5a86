//! JSON files with a `version`: newer ones are refused untouched, unknown keys are named with line and column.

use std::path::Path;

use serde::de::DeserializeOwned;

use crate::error::{Error, FieldError};

/// Parses `text`. `path` is only named in errors.
///
/// # Errors
/// [`Error::Json`] with line and column, naming what was expected.
pub fn parse<T: DeserializeOwned>(path: &Path, text: &str) -> Result<T, Error> {
    serde_json::from_str(text).map_err(|error| {
        // serde_json ends its message with the place, which the error says already.
        let message = error.to_string();
        let reason = message.rsplit_once(" at line ").map_or(message.as_str(), |(reason, _)| reason).to_owned();
        Error::Json { path: path.into(), line: error.line(), column: error.column().max(1), reason }
    })
}

/// Parses a file whose `version` this program must know. A newer one is refused before anything else is looked at.
///
/// # Errors
/// [`Error::Json`].
pub fn parse_versioned<T: DeserializeOwned>(path: &Path, text: &str, newest: u32) -> Result<T, Error> {
    #[derive(serde::Deserialize)]
    #[serde(expecting = "an object with a \"version\"")]
    struct Versioned {
        version: u32,
    }
    let Versioned { version } = parse(path, text)?;
    if version == 0 || version > newest {
        let (line, column) = place_of(text, "\"version\"");
        let reason = if version == 0 {
            format!("version 0 does not exist; expected 1 to {newest}")
        } else {
            format!("version {version} is newer than this program, which reads up to {newest}; update haze")
        };
        return Err(Error::Json { path: path.into(), line, column, reason });
    }
    parse(path, text)
}

/// Reads, parses and checks a file with a version.
///
/// # Errors
/// [`Error::Io`], [`Error::Json`], or [`Error::JsonField`] for what `validate` finds.
pub fn load<T: DeserializeOwned>(
    path: &Path,
    newest: u32,
    validate: impl FnOnce(&T) -> Result<(), FieldError>,
) -> Result<T, Error> {
    let text = std::fs::read_to_string(path).map_err(|error| Error::Io { path: path.into(), error })?;
    // Some editors begin a file with a byte order mark.
    let value = parse_versioned(path, text.trim_start_matches('\u{feff}'), newest)?;
    validate(&value).map_err(|error| Error::JsonField { path: path.into(), error })?;
    Ok(value)
}

/// Line and column, 1-based, of the first occurrence of a key.
fn place_of(text: &str, key: &str) -> (usize, usize) {
    let before = &text[..text.find(key).unwrap_or(0)];
    let line = before.matches('\n').count() + 1;
    let column = before.len() - before.rfind('\n').map_or(0, |at| at + 1) + 1;
    (line, column)
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
    fn errors_say_where_and_what_would_be_right() {
        parse_versioned::<Sample>(Path::new("a.json"), "{\"version\": 1, \"boost\": 3}", 1).unwrap();
        let unknown = message("{\"version\": 1, \"boost\": 3,\n  \"bost\": 4}");
        assert!(unknown.starts_with("a.json:2:8: unknown field `bost`, expected `version` or `boost`"), "{unknown}");
        assert!(message("{\"version\": 1}").contains("missing field `boost`"));
        assert!(message("{\"boost\": 1}").contains("missing field `version`"));
        assert!(message("{").starts_with("a.json:1:1: EOF"));
    }

    #[test]
    fn a_newer_version_is_refused_whatever_else_is_in_it() {
        let newer = message("{\n  \"version\": 2, \"tint\": []}");
        assert!(newer.starts_with("a.json:2:3: version 2 is newer"), "{newer}");
        assert!(message("{\"version\": 0}").contains("expected 1 to 1"));
    }
}
