//! The report as JSON, and the schema that describes it.

use std::path::Path;

use haze::Error;
use haze::assets::json::load;

use super::report::{Report, VERSION};

/// What [`json`] made.
///
/// # Errors
/// With file, line and what is wrong.
pub fn read(path: &Path) -> Result<Report, Error> {
    load(path, VERSION, |_: &Report| Ok(()))
}

/// For jq and spreadsheets: see [`schema`].
pub fn json(report: &Report) -> String {
    // Numbers and text are all that it holds.
    serde_json::to_string_pretty(report).unwrap_or_default() + "\n"
}

/// JSON schema of a report.
pub fn schema() -> String {
    serde_json::to_string_pretty(&schemars::schema_for!(Report)).unwrap_or_default()
}
