//! Reads and writes the report as JSON, and prints its schema.

use std::path::Path;

use haze_core::assets::json::load;
use haze_core::error::Error;

use super::report::{Report, VERSION};

/// Reads a report that [`json`] wrote.
///
/// # Errors
/// Names the file, the line and what is wrong.
pub fn read(path: &Path) -> Result<Report, Error> {
    Ok(load(path, VERSION, |_: &Report| Ok(()))?)
}

/// Serializes a report, for jq and spreadsheets; [`schema`] describes the format.
pub fn json(report: &Report) -> String {
    // Serialization cannot fail: a report holds only numbers and text.
    serde_json::to_string_pretty(report).unwrap_or_default() + "\n"
}

/// Returns the JSON schema of a report.
pub fn schema() -> String {
    serde_json::to_string_pretty(&schemars::schema_for!(Report)).unwrap_or_default()
}
