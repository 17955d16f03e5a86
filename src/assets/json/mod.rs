//! JSON files with a `version`: newer ones are refused untouched, unknown keys are named with line and column.

use std::path::Path;

use serde::de::DeserializeOwned;

use super::file;
use super::picture::is_png;
use crate::error::{Error, FieldError};

/// Largest file that is read, bytes: a preset is some thousands.
const MAX_BYTES: u64 = 1 << 20;

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
    let value = parse_versioned(path, text(path, &file::read(path, "JSON file", MAX_BYTES)?)?, newest)?;
    validate(&value).map_err(|error| Error::JsonField { path: path.into(), error })?;
    Ok(value)
}

/// The text of a file. Other encodings and pictures are named.
fn text<'a>(path: &Path, bytes: &'a [u8]) -> Result<&'a str, Error> {
    let refuse = |(line, column), reason: &str| {
        Err(Error::Json { path: path.into(), line, column, reason: format!("{reason}; expected JSON as UTF-8 text") })
    };
    if is_png(bytes) {
        return refuse((1, 1), "a PNG picture");
    }
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return refuse((1, 1), "text in UTF-16; save it as UTF-8");
    }
    // Some editors begin a file with a byte order mark.
    let bytes = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(bytes);
    std::str::from_utf8(bytes).or_else(|error| {
        let before = String::from_utf8_lossy(&bytes[..error.valid_up_to()]);
        refuse(place(&before), "bytes that are no UTF-8 text")
    })
}

/// Line and column, 1-based, of what follows `before`.
fn place(before: &str) -> (usize, usize) {
    (before.matches('\n').count() + 1, before.len() - before.rfind('\n').map_or(0, |at| at + 1) + 1)
}

/// Line and column, 1-based, of the first occurrence of a key.
fn place_of(text: &str, key: &str) -> (usize, usize) {
    place(&text[..text.find(key).unwrap_or(0)])
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
