//! Errors of the glTF reader in plain words. Its own messages assume knowledge of its code.

use gltf::binary;
use gltf::json::validation;
use haze_core::error::{AssetError, one_line};

/// Expected file.
pub const WHOLE: &str = "a whole glTF 2.0 file";

/// Reason why the container or the document is refused.
pub fn gltf_problem(error: &gltf::Error) -> String {
    match error {
        gltf::Error::Binary(
            binary::Error::Io(_) | binary::Error::Length { .. } | binary::Error::ChunkLength { .. },
        ) => format!("the file ends too early; expected {WHOLE}"),
        gltf::Error::Binary(binary::Error::Version(version)) => {
            format!("version {version} of the container; expected 2, that of glTF 2.0")
        }
        gltf::Error::Validation(all) => {
            let Some((field, error)) = all.first() else { return format!("damaged; expected {WHOLE}") };
            let problem = match error {
                validation::Error::IndexOutOfBounds => "names what the file does not have",
                validation::Error::Missing => "lacks a part",
                validation::Error::Oversize => "is too large",
                validation::Error::Invalid | validation::Error::Unsupported => "is not valid",
            };
            let more = match all.len() - 1 {
                0 => String::new(),
                more => format!(", and {more} more"),
            };
            format!("{} {problem}{more}; expected {WHOLE}", one_line(field))
        }
        _ => format!("damaged; expected {WHOLE}"),
    }
}

/// Reason why text is no JSON, with its position.
pub fn json_problem(error: &AssetError) -> String {
    match error {
        AssetError::Text { line, column, reason, .. } => {
            format!("line {line}, column {column}: {}", field_problem(reason.clone()))
        }
        other => other.to_string(),
    }
}

/// Problem of a field, with what is expected.
pub fn field_problem(reason: String) -> String {
    if reason.contains("expected ") { reason } else { format!("{reason}; expected {WHOLE}") }
}
