//! Presets: checks of the files that they name, settings without effect, the schema and the page of all settings.

mod file_check;
mod no_effect;
mod role_check;
mod schema;
mod settings_page;
mod tooltips;

pub use file_check::check_files;
pub use no_effect::{no_effect_reason, no_effect_reason_of_set};
pub use role_check::role_warnings;
pub use schema::schema;
pub use settings_page::settings_page;
pub use tooltips::Tooltips;
