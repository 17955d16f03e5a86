//! The report as JSON, and the schema that describes it.

use super::report::Report;

/// For jq and spreadsheets: see [`schema`].
pub fn json(report: &Report) -> String {
    // Numbers and text are all that it holds.
    serde_json::to_string_pretty(report).unwrap_or_default() + "\n"
}

/// JSON schema of a report.
pub fn schema() -> String {
    serde_json::to_string_pretty(&schemars::schema_for!(Report)).unwrap_or_default()
}
