//! Executable specification: every formula once, in plain Rust on glam, under the same name and in a file of the same
//! name as in `shaders/lib/`. Both renderers, the bakers and the tests use it.

pub mod ambient;
pub mod blending;
pub mod color;
pub mod curve;
pub mod density_grid;
pub mod depth;
pub mod depth_moments;
pub mod diffuse_bake;
pub mod emitter;
pub mod fire;
pub mod flight;
pub mod flow;
pub mod gradient_noise;
pub mod grain;
pub mod hash;
pub mod lighting;
pub mod noise_volume;
pub mod normal;
pub mod order;
pub mod ramp;
pub mod response;
pub mod scene_shadow;
pub mod screen_shadow;
pub mod shadow;
pub mod shadow_map;
pub mod six_way;
pub mod smoke_extent;
pub mod smoke_tiles;
pub mod soft_fade;
pub mod sprite;
pub mod stretch;
pub mod swirl_noise;
pub mod technique;
pub mod texture;
pub mod tile_sprite;
pub mod tiles;
pub mod tonemap;
pub mod uniforms;
pub mod upsample;
pub mod view;

/// Clamps to 0..=1. Returns 0 for NaN, as WGSL's `saturate` may.
pub fn saturate(x: f32) -> f32 {
    if x > 0.0 { x.min(1.0) } else { 0.0 }
}
