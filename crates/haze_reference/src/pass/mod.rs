//! Passes of the CPU renderer, each named like its shader.

mod accumulate;
mod depth_downsample;
mod diffuse_bake;
mod forward;
mod light_target;
mod specular_scatter;
pub mod transfer;
