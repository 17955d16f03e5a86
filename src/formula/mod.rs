//! The specification: every formula once, in plain Rust on glam, under the name it has in `shaders/lib/`, one file for each file
//! there. Both renderers, the bakers and the tests go by it.

pub mod blending;
pub mod colour;
pub mod depth;
pub mod diffuse_bake;
pub mod emitter;
pub mod gradient_noise;
pub mod hash;
pub mod lighting;
pub mod noise_volume;
pub mod normal;
pub mod order;
pub mod ramp;
pub mod six_way;
pub mod soft_fade;
pub mod sprite;
pub mod technique;
pub mod texture;
pub mod tonemap;
pub mod uniforms;
pub mod upsample;
pub mod view;

/// Clamps to 0..=1; NaN gives 0, as WGSL's `saturate` may.
pub fn saturate(x: f32) -> f32 {
    if x > 0.0 { x.min(1.0) } else { 0.0 }
}
