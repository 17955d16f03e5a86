//! The library against a real adapter. One binary, so that all tests share one device.

mod common;
mod shader_layout;
