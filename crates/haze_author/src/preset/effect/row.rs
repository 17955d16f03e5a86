//! Row in the tables of settings without effect.

use glam::UVec2;

/// Reason, its condition, and the fields or groups of fields that have no effect then.
pub struct Row<T> {
    pub reason: &'static str,
    pub holds: fn(&T, UVec2) -> bool,
    pub fields: &'static [&'static str],
}

impl<T> Row<T> {
    /// True if the row is about a field.
    pub fn names(&self, field: &str) -> bool {
        let is_named =
            |name: &&str| field.strip_prefix(*name).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'));
        self.fields.iter().any(is_named)
    }
}

pub const fn row<T>(reason: &'static str, holds: fn(&T, UVec2) -> bool, fields: &'static [&'static str]) -> Row<T> {
    Row { reason, holds, fields }
}

/// Returns the reason of the first row that holds.
pub fn find<T>(rows: &[Row<T>], of: &T, field: &str, size: UVec2) -> Option<&'static str> {
    let holds = |row: &&Row<T>| row.names(field) && (row.holds)(of, size);
    rows.iter().find(holds).map(|row| row.reason)
}
