//! Writes the rows as CSV with the columns of the JSON; each pass has its own column.

use std::collections::BTreeSet;

use serde_json::Value;

use super::report::Report;

pub fn csv(report: &Report) -> String {
    let rows: Vec<Vec<(String, String)>> =
        report.rows.iter().filter_map(|row| Some(columns(&serde_json::to_value(row).ok()?))).collect();
    // Columns that identify a row come first, passes come last.
    let mut names = vec!["suite", "case", "size"];
    let mut passes = BTreeSet::new();
    for (name, _) in rows.iter().flatten() {
        if name.starts_with("passes.") {
            passes.insert(name.as_str());
        } else if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    names.extend(passes);
    let mut text = names.join(",") + "\n";
    for row in &rows {
        let cell = |name: &&str| row.iter().find(|(column, _)| column == name).map_or("", |(_, cell)| cell.as_str());
        text += &names.iter().map(cell).collect::<Vec<_>>().join(",");
        text.push('\n');
    }
    text
}

/// Returns column names and cells of a row.
fn columns(row: &Value) -> Vec<(String, String)> {
    let mut columns = Vec::new();
    flatten("", row, &mut columns);
    columns
}

fn flatten(name: &str, value: &Value, columns: &mut Vec<(String, String)>) {
    let inside = |part: &str| if name.is_empty() { part.to_owned() } else { format!("{name}.{part}") };
    match value {
        Value::Object(fields) => fields.iter().for_each(|(part, value)| flatten(&inside(part), value, columns)),
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(index, value)| flatten(&inside(&index.to_string()), value, columns));
        }
        Value::Null => columns.push((name.into(), String::new())),
        Value::String(text) => columns.push((name.into(), quoted(text))),
        other => columns.push((name.into(), other.to_string())),
    }
}

/// Quotes a cell as RFC 4180 says, if it needs quotes.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.into() }
}
