//! The library against a real adapter. One binary, so that all tests share one device.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::redundant_closure_for_method_calls, reason = "not every type of wgpu can be named")]
#![allow(clippy::float_cmp, reason = "what must be equal to the bit is compared so")]

mod anchors;
mod assets;
mod budget;
mod column_truth;
mod common;
mod corpus;
mod creations;
mod develop;
mod effects;
mod every_setting;
mod fields;
mod formulas;
mod goldens;
mod host;
mod hosts;
mod in_view;
mod layers;
mod lighting;
mod overdraw;
mod particles;
mod presets;
mod probe;
mod properties;
mod shader_layout;
mod shaders;
mod six_way;
mod soak;
mod stage;
mod techniques;
mod tiled;
mod timing;
mod upsampling;
