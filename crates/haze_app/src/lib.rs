//! The program `haze`, and the tweaker on a page.

#![cfg_attr(target_arch = "wasm32", allow(dead_code, reason = "a page has no command line"))]

#[cfg(not(target_arch = "wasm32"))]
mod backdrop_options;
mod backend;
#[cfg(not(target_arch = "wasm32"))]
mod bake_job;
#[cfg(not(target_arch = "wasm32"))]
mod bench;
#[cfg(not(target_arch = "wasm32"))]
mod command_line;
#[cfg(not(target_arch = "wasm32"))]
mod commands;
mod contact_sheet;
mod debug_view_sheet;
mod engine;
#[cfg(not(target_arch = "wasm32"))]
mod exr_export;
mod file_kind;
#[cfg(not(target_arch = "wasm32"))]
mod file_watcher;
#[cfg(not(target_arch = "wasm32"))]
mod findings;
#[cfg(not(target_arch = "wasm32"))]
mod flip;
#[cfg(not(target_arch = "wasm32"))]
mod flipbook_export;
mod frame_range;
#[cfg(not(target_arch = "wasm32"))]
mod frame_timer;
mod image_export;
mod image_format;
mod inputs;
mod interrupt;
#[cfg(not(target_arch = "wasm32"))]
mod material_export;
#[cfg(not(target_arch = "wasm32"))]
mod medium_options;
mod memory_check;
#[cfg(not(target_arch = "wasm32"))]
mod options;
#[cfg(not(target_arch = "wasm32"))]
mod output;
#[cfg(target_arch = "wasm32")]
mod page_renderer;
#[cfg(not(target_arch = "wasm32"))]
mod plot;
mod progress;
#[cfg(not(target_arch = "wasm32"))]
mod puff_error;
mod puff_sheet;
mod recipe_files;
mod share_link;
mod smoke_alone;
#[cfg(not(target_arch = "wasm32"))]
mod smoke_layers;
mod sprite_by_name;
#[cfg(not(target_arch = "wasm32"))]
mod startup;
mod text_drawing;
mod tweak;

#[cfg(not(target_arch = "wasm32"))]
pub use startup::run;
#[cfg(target_arch = "wasm32")]
pub use tweak::open_page;
