//! The demo scene that smoke is shown in: boxes with procedural materials, lit by the preset's lights, drawn on the GPU and
//! on the CPU alike.

pub mod apart;
mod arriving;
mod boxes;
pub mod capture;
mod cpu;
pub mod develop;
pub mod headless;
mod layout;
mod occluders;
mod render;
mod scene;
mod scene_renderer;
mod shading;
pub mod shot;
pub mod stage;
