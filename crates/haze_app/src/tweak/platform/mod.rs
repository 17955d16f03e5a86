//! All access to disk, clock and threads. The rest of the tweaker has no dependency on the operating system.

#![allow(clippy::disallowed_methods)]

pub mod asset_loading;
pub mod clock;
pub mod file_dialog;
pub mod file_io;
pub mod json_store;
pub mod lock_file;
pub mod render_job;
pub mod repaint_handle;
pub mod state_folder;
pub mod worker;
