//! The library against a real adapter. One binary, so that all tests share one device.

mod common;
mod formulas;
#[cfg(feature = "app")]
mod presets;
mod properties;
mod shader_layout;
mod stage;
