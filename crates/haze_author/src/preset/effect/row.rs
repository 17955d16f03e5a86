//! A row of the tables of settings that do nothing.

use glam::UVec2;

/// A reason, whether it holds, and what does nothing then: fields, or groups of them.
pub struct Row<T> {
    pub reason: &'static str,
    pub holds: fn(&T, UVec2) -> bool,
    pub fields: &'static [&'static str],
}

impl<T> Row<T> {
    /// Whether it is about a field.
    pub fn names(&self, field: &str) -> bool {
        let is_named =
            |name: &&str| field.strip_prefix(*name).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'));
        self.fields.iter().any(is_named)
    }
}

pub const fn row<T>(reason: &'static str, holds: fn(&T, UVec2) -> bool, fields: &'static [&'static str]) -> Row<T> {
    Row { reason, holds, fields }
}

/// The first row that holds is the reason.
pub fn find<T>(rows: &[Row<T>], of: &T, field: &str, size: UVec2) -> Option<&'static str> {
    let holds = |row: &&Row<T>| row.names(field) && (row.holds)(of, size);
    rows.iter().find(holds).map(|row| row.reason)
}
