//! All access to disk, clock and threads. The rest of the tweaker has no dependency on the operating system.
//!
//! On a page, `web` replaces what a browser does not have.

#![allow(clippy::disallowed_methods)]

pub mod asset_loading;
pub mod clock;
mod dialog_answer;
#[cfg(not(target_arch = "wasm32"))]
mod disk;
#[cfg(not(target_arch = "wasm32"))]
pub mod file_dialog;
pub mod file_io;
pub mod json_store;
#[cfg(not(target_arch = "wasm32"))]
pub mod lock_file;
pub mod portable_job;
pub mod render_job;
pub mod repaint_handle;
#[cfg(not(target_arch = "wasm32"))]
pub mod state_folder;
#[cfg(target_arch = "wasm32")]
pub mod web;
#[cfg(not(target_arch = "wasm32"))]
pub mod worker;

#[cfg(target_arch = "wasm32")]
use web::disk;
#[cfg(target_arch = "wasm32")]
pub use web::{file_dialog, lock_file, worker};

/// The program runs on a page: it has no threads, must not wait for the graphics device, and sees only files that the user
/// gives it.
pub const IS_PAGE: bool = cfg!(target_arch = "wasm32");
