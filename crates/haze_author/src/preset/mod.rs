//! Presets: checks of the files that they name, settings without effect, the schema and the page of all settings.

mod check;
mod effect;
mod page;
mod role;
mod schema;
mod tooltips;

pub use check::check_files;
pub use effect::without_effect;
pub use page::settings_page;
pub use role::doubts;
pub use schema::schema;
pub use tooltips::Tooltips;
