//! The specification: every formula once, in plain Rust, under the name it has in `shaders/`, and a complete renderer on
//! top of them. It is the oracle of the tests, and what draws on a machine without a GPU driver.

pub mod blending;
pub mod depth;
pub mod diffuse_bake;
pub mod lighting;
pub mod noise_volume;
pub mod normal;
mod pass;
pub mod picture;
pub mod ramp;
pub mod renderer;
pub mod soft_fade;
pub mod sprite;
mod sprite_fragment;
pub mod technique;
pub mod upsample;
pub mod view;

/// Clamps to 0..=1; NaN gives 0, as WGSL's `saturate` may.
pub fn saturate(x: f32) -> f32 {
    if x > 0.0 { x.min(1.0) } else { 0.0 }
}
