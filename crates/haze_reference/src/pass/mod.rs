//! Passes of the CPU renderer, each named like its shader.

mod accumulate;
mod depth_downsample;
mod depth_slopes;
mod diffuse_bake;
mod forward;
mod light_target;
pub mod screen_shadow;
pub mod shadow_march;
mod shadow_views;
pub mod shadow_visibility;
mod specular_scatter;
pub mod transfer;
