//! Shots rendered to files: images, sequences, flipbooks, EXR, materials for engines; and the options and lines of a command line that
//! choose and report them. Commands, window and benchmark share it.

#[cfg(not(target_arch = "wasm32"))]
pub mod backdrop_options;
pub mod backend;
pub mod contact_sheet;
pub mod debug_view_sheet;
pub mod engine;
#[cfg(not(target_arch = "wasm32"))]
pub mod exr_export;
pub mod file_kind;
#[cfg(not(target_arch = "wasm32"))]
pub mod flipbook_export;
pub mod frame_range;
pub mod image_export;
pub mod image_format;
pub mod inputs;
pub mod interrupt;
#[cfg(not(target_arch = "wasm32"))]
pub mod material_export;
pub mod memory_check;
#[cfg(not(target_arch = "wasm32"))]
pub mod options;
#[cfg(not(target_arch = "wasm32"))]
pub mod output;
#[cfg(target_arch = "wasm32")]
pub mod page_renderer;
#[cfg(not(target_arch = "wasm32"))]
pub mod png_stream;
pub mod progress;
pub mod puff_sheet;
pub mod recipe_files;
pub mod smoke_alone;
#[cfg(not(target_arch = "wasm32"))]
pub mod smoke_layers;
pub mod sprite_by_name;
pub mod text_drawing;
