//! Row in the tables of settings without effect.

use glam::UVec2;

/// Reason, its condition, and the fields or groups of fields that have no effect then.
pub struct NoEffectRule<T> {
    pub reason: &'static str,
    pub holds: fn(&T, UVec2) -> bool,
    pub fields: &'static [&'static str],
}

impl<T> NoEffectRule<T> {
    /// True if the row is about a field.
    pub fn applies_to(&self, field: &str) -> bool {
        let is_named =
            |name: &&str| field.strip_prefix(*name).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'));
        self.fields.iter().any(is_named)
    }
}

pub const fn rule<T>(
    reason: &'static str,
    holds: fn(&T, UVec2) -> bool,
    fields: &'static [&'static str],
) -> NoEffectRule<T> {
    NoEffectRule { reason, holds, fields }
}

/// Returns the reason of the first row that holds.
pub fn find_reason<T>(rules: &[NoEffectRule<T>], of: &T, field: &str, size: UVec2) -> Option<&'static str> {
    let holds = |rule: &&NoEffectRule<T>| rule.applies_to(field) && (rule.holds)(of, size);
    rules.iter().find(holds).map(|rule| rule.reason)
}
