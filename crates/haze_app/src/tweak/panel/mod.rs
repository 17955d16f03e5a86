//! Panels of the window: settings as rows made from the table of fields, menus and dialogs.

pub mod browser;
pub mod compare;
pub mod control;
pub mod curve;
pub mod export;
pub mod fields;
pub mod file;
pub mod gallery;
pub mod help;
pub mod hints;
pub mod lights;
pub mod look;
pub mod notice;
pub mod performance;
pub mod ramps;
pub mod row;
pub mod search;
pub mod settings;
pub mod sprite;
pub mod stops;
pub mod time;
pub mod value;
