//! The panels: what can be set, in rows made from the table of settings.

pub mod fields;
pub mod row;
pub mod settings;
