//! What is edited: its steps, and what differs in it.

mod difference;
mod history;

pub use difference::{changed_fields, copy_field, step_name};
pub use history::History;
