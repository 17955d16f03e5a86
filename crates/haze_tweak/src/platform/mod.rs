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
pub mod idle_timer;
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

use haze_core::error::Error;
#[cfg(target_arch = "wasm32")]
use web::disk;
#[cfg(target_arch = "wasm32")]
pub use web::{file_dialog, lock_file, worker};

/// Writes an error that the window may not be able to show: to standard error, or to the console of the browser.
pub fn print_error(error: &Error) {
    #[cfg(not(target_arch = "wasm32"))]
    haze_export::output::print_error(error);
    #[cfg(target_arch = "wasm32")]
    web_sys::console::error_1(&error.to_string().into());
}

/// The program runs on a page: it has no threads, must not wait for the graphics device, and sees only files that the user
/// gives it.
pub const IS_PAGE: bool = cfg!(target_arch = "wasm32");
