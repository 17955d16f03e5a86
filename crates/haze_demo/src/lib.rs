//! Scene for the smoke, lit by the preset's lights: boxes with procedural materials, or an artist's own from a file. A GPU and
//! a CPU renderer draw the same image.

mod adapter_choice;
mod address_space;
pub mod antialiasing;
pub mod bloom;
pub mod bloom_pass;
mod boxes;
mod camera_passes;
mod camera_rays;
pub mod capture;
mod cpu_render;
pub mod headless;
pub mod heat_haze;
pub mod image_metrics;
pub mod image_pass;
mod layer_shots;
mod layout;
mod mesh_caster;
mod mesh_renderer;
mod occluders;
mod offscreen_context;
pub mod offscreen_renderer;
mod outline;
mod outline_pass;
pub mod particle_scalar;
pub mod puff_cloud;
mod ray_caster;
mod scene;
mod scene_pipeline;
mod scene_renderer;
mod shading;
mod shadow_views;
pub mod shot;
mod texture_readback;
pub mod tonemap_pass;
mod uploaded_backdrop;

pub use layout::LAMP_HEAD;
