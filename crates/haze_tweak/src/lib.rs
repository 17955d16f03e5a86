//! The tweaker: interactive window, or page, for lighting smoke.

#![cfg_attr(target_arch = "wasm32", allow(dead_code, reason = "a page has no command line"))]
// Disk, clock and threads only in platform/, which a build for browsers replaces in part.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

#[cfg(not(target_arch = "wasm32"))]
mod arguments;
mod document;
#[cfg(not(target_arch = "wasm32"))]
#[allow(clippy::disallowed_methods, reason = "it watches the disk, from a thread")]
pub mod file_watcher;
mod files;
#[cfg(target_arch = "wasm32")]
mod page;
#[cfg(target_arch = "wasm32")]
mod page_image;
#[cfg(target_arch = "wasm32")]
mod page_job;
mod panels;
mod platform;
mod session;
mod viewport;
mod viewport_renderer;
mod window;

#[cfg(not(target_arch = "wasm32"))]
pub use arguments::{Arguments, run};
#[cfg(not(target_arch = "wasm32"))]
pub use document::copied_assets::copy_assets;
#[cfg(target_arch = "wasm32")]
pub use page::open_page;
#[cfg(not(target_arch = "wasm32"))]
pub use platform::file_dialog::is_dialog_target as is_of_dialogs;
