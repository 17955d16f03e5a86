//! Tests of the library on a real GPU adapter. They form one binary so that all tests share one device.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::redundant_closure_for_method_calls, reason = "some wgpu types cannot be named in a path")]
#![allow(clippy::float_cmp, reason = "bit-identical results are compared exactly")]

mod adaptive_scale;
mod anchors;
mod assets;
mod backdrop;
mod bloom;
mod budget;
mod camera_passes;
mod column_error;
mod corpus;
mod effects;
mod every_setting;
mod fields;
mod fire;
mod formulas;
mod goldens;
mod gpu;
mod hosts;
mod import_graph;
mod lighting;
mod motion;
mod moving_sprites;
mod mutants;
mod outlines;
mod overdraw;
mod particles;
mod presets;
mod probe;
mod properties;
mod psnr;
mod random_presets;
mod resource_counter;
mod shader_layout;
mod shaders;
mod shadow;
mod six_way;
mod soak;
mod techniques;
mod test_host;
mod test_scene;
mod tiled;
mod timing;
mod tonemap_pass;
mod upsampling;
mod view_setup;
